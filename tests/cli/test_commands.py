"""Every command is one module of one shape, and none of them computes."""

import argparse
import ast
from pathlib import Path
from types import ModuleType

import pytest

from derive.cli import (
    build,
    check,
    completion,
    convert,
    export,
    handout,
    import_,
    list,
    move,
    new,
    plot,
    schema,
    show,
    style,
    verify,
)
from derive.cli.data import excite, identify, map, sample
from derive.cli.main import COMMANDS

OF_FILES = (
    build, check, convert, excite, export, handout, identify, import_, map, move, new, plot, sample, show, style,
    verify,
)  # fmt: skip
MODULES = {module.__name__.rpartition(".")[2].rstrip("_"): module for module in (*OF_FILES, completion, list, schema)}


def imported(module: ModuleType) -> set[str]:
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    found = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    return found | {str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}


def test_every_command_has_its_module() -> None:
    assert sorted(COMMANDS) == sorted(MODULES)


@pytest.mark.parametrize("module", MODULES.values(), ids=MODULES)
def test_a_command_says_what_it_is_and_reads_its_arguments(module: ModuleType) -> None:
    assert module.DESCRIPTION[0].isupper()
    parser = argparse.ArgumentParser(exit_on_error=False)
    module.configure(parser)
    name = module.__name__.rpartition(".")[2].rstrip("_")
    assert len(COMMANDS[name]) < 80
    more = {"plot": ["-o", "arm.svg"], "identify": ["log.csv"], "export": ["--format", "urdf"], "sample": ["tau"]}
    more = more.get(name, ["-o", "reach.zarr"] if name == "map" else [])
    needed = [] if name in ("list", "build", "schema") else ["bash"] if name == "completion" else ["arm", *more]
    assert parser.parse_args(needed) is not None


@pytest.mark.parametrize("module", MODULES.values(), ids=MODULES)
def test_a_command_holds_no_mathematics(module: ModuleType) -> None:
    ours = ("derive.algebra", "derive.mechanics", "derive.programs", "derive.lecture.form")
    assert not [name for name in imported(module) if name.startswith(("sympy", "numpy", "math", *ours))]

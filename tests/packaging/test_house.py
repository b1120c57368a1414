"""The house in order: tests beside what they test, no circle of imports, and public names that say what they take."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from tests.places import ROOT

PACKAGE = ROOT / "derive"
ENTRANCES = ("__init__.py", "__main__.py")
SAYS = re.compile(r"^\s*(Args|Returns|Yields):", re.MULTILINE)


@cache
def tree(path: Path) -> ast.Module:
    """The syntax tree of a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def modules() -> dict[str, Path]:
    """The modules and packages of derive by their dotted names."""
    return {dotted(path): path for path in sorted(PACKAGE.rglob("*.py"))}


def dotted(path: Path) -> str:
    """The name under which a file is imported."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def imports(path: Path) -> frozenset[str]:
    """Modules of derive that a file imports, wherever in the file and for whatever reason."""
    found: set[str] = set()
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            found.update(name if name in modules() else node.module for name in names)
        elif isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
    return frozenset(found & set(modules()))


def test_no_import_leads_back_to_where_it_started() -> None:
    """Lazy imports and those for type checkers counted; raises `graphlib.CycleError` with the circle."""
    graph = {name: imports(path) - {name} for name, path in modules().items()}
    assert set(TopologicalSorter(graph).static_order()) == set(graph)


@pytest.mark.parametrize("name", [name for name, path in modules().items() if path.name not in ENTRANCES])
def test_every_module_is_imported_by_a_test_of_its_own_folder(name: str) -> None:
    """``derive.model.equality`` by a file under ``tests/model``; what lies in ``derive`` itself by any test."""
    folder = ROOT / "tests" / Path(*name.split(".")[1:-1][:1])
    assert any(name in imports(path) for path in sorted(folder.rglob("*.py"))), f"no file under {folder} imports {name}"


def test_folders_of_tests_are_those_of_derive_or_run_across() -> None:
    """A test is found where the code is; what runs across has a folder that says so."""
    across = {
        "bench", "docs", "examples", "generated", "inverse", "journeys", "lectures", "packaging", "physics",
        "textbooks",
    }  # fmt: skip
    folders = {path.parent.name for path in (ROOT / "tests").glob("*/*.py")}
    assert folders - across <= {path.name for path in PACKAGE.iterdir() if path.is_dir()}


def public_functions(node: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """Functions and methods without an underscore, nested ones too."""
    for child in ast.walk(node):
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef) and not child.name.startswith("_"):
            yield child


def is_silent(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Whether a function takes something and does not say what, nor what it gives."""
    arguments = [a for a in (*function.args.args, *function.args.kwonlyargs) if a.arg not in ("self", "cls")]
    return bool(arguments) and not SAYS.search(ast.get_docstring(function) or "")


@pytest.mark.parametrize("path", modules().values(), ids=modules().keys())
def test_public_functions_say_what_they_take_and_give(path: Path) -> None:
    silent = [f"{path.name}:{f.lineno}: {f.name}" for f in public_functions(tree(path)) if is_silent(f)]
    assert not silent, "no Args: or Returns: in the docstring"

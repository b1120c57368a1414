"""The house in order: tests lie beside what they test, and no import leads in a circle."""

from __future__ import annotations

import ast
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

from tests.places import ROOT

PACKAGE = ROOT / "derive"


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


def test_folders_of_tests_are_those_of_derive_or_run_across() -> None:
    """A test is found where the code is; what runs across has a folder that says so."""
    across = {
        "bench", "docs", "examples", "generated", "lectures", "packaging", "physics",
    }  # fmt: skip
    folders = {path.parent.name for path in (ROOT / "tests").glob("*/*.py")}
    assert folders - across <= {path.name for path in PACKAGE.iterdir() if path.is_dir()}

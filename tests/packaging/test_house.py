"""The house in order: tests beside what they test, no circle of imports, a public interface that says what it takes."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

from derive import _HOMES
from tests.places import ROOT

PACKAGE = ROOT / "derive"
ENTRANCES = ("__init__.py", "__main__.py")
INTERFACE_CLASSES = (
    "derive.api.robots", "derive.model.dynamic_model", "derive.model.kinematic_model", "derive.model.model",
    "derive.motion.motion", "derive.notebook", "derive.robot.robot",
)  # fmt: skip
SAYS = re.compile(r"^\s*(Args|Returns|Yields):", re.MULTILINE)


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def modules() -> dict[str, Path]:
    return {dotted(path): path for path in sorted(PACKAGE.rglob("*.py"))}


def dotted(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def imports(path: Path) -> frozenset[str]:
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


def test_every_module_is_imported_by_a_test_of_its_own_folder() -> None:
    """``derive.model.equality`` by a file under ``tests/model``; what lies in ``derive`` itself by any test."""
    named = {name: name.split(".")[1:-1][:1] for name, path in modules().items() if path.name not in ENTRANCES}
    assert [name for name, folder in named.items() if name not in imported_under(*folder)] == []


@cache
def imported_under(*folder: str) -> frozenset[str]:
    return frozenset().union(*(imports(path) for path in ROOT.joinpath("tests", *folder).rglob("*.py")))


def test_folders_of_tests_are_those_of_derive_or_run_across() -> None:
    across = {
        "bench", "docs", "examples", "generated", "inverse", "journeys", "lectures", "packaging", "physics",
        "textbooks",
    }  # fmt: skip
    folders = {path.parent.name for path in (ROOT / "tests").glob("*/*.py")}
    assert folders - across <= {path.name for path in PACKAGE.iterdir() if path.is_dir()}


def public_interface() -> Iterator[tuple[Path, ast.FunctionDef]]:
    for name, path in modules().items():
        exported = (
            {"Model", "KinematicModel", "DynamicModel", "Robot", "Motion"} if name in INTERFACE_CLASSES else set()
        )
        for node in tree(path).body:
            if isinstance(node, ast.FunctionDef) and name.startswith("derive.api."):
                yield path, node
            elif isinstance(node, ast.ClassDef) and node.name in exported:
                yield from ((path, method) for method in node.body if isinstance(method, ast.FunctionDef))


def is_silent(function: ast.FunctionDef) -> bool:
    arguments = [a for a in (*function.args.args, *function.args.kwonlyargs) if a.arg not in ("self", "cls")]
    public = not function.name.startswith("_")
    return public and bool(arguments) and not SAYS.search(ast.get_docstring(function) or "")


def test_the_public_interface_says_what_it_takes_and_gives() -> None:
    """Elsewhere a docstring is one line, and more only where it tells a unit, a shape, a frame, a bound or a source."""
    functions = list(public_interface())
    assert {"build", "from_urdf", "equal"} <= {function.name for _, function in functions}
    silent = [f"{path.name}:{f.lineno}: {f.name}" for path, f in functions if is_silent(f)]
    assert not silent, "no Args: or Returns: in the docstring"


def test_the_page_of_the_interface_documents_every_public_name() -> None:
    """With its module, or as a class of its own."""
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    assert set(re.findall(r"automodule:: (\S+)", page)) <= set(modules())
    documented = re.findall(r"^\.\. auto(?:module|class):: (\S+)$", page, re.MULTILINE)
    assert [name for name, home in _HOMES.items() if not {home, f"derive.{name}"} & {*documented}] == []

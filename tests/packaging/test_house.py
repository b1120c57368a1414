"""The house in order: layers, readable files, tests beside what they test, an interface that says what it takes."""

import ast
import re
import subprocess
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Any

from derive import _HOMES
from tests.places import ROOT

PACKAGE = ROOT / "derive"
ENTRANCES = ("__init__.py", "__main__.py")
INTERFACE_CLASSES = (
    "derive.api.robots", "derive.model.dynamic_model", "derive.model.kinematic_model", "derive.model.model",
    "derive.motion.motion", "derive.notebook", "derive.robot.robot",
)  # fmt: skip
SAYS = re.compile(r"^\s*(Args|Returns|Yields):", re.MULTILINE)
MAX_FILE = 450
MAX_FUNCTION = 50

# Put together here, so that this file does not hold what it forbids.
FORBIDDEN = [
    "/".join(("", "work", "")),
    "/".join(("", "root", "")),
    "/".join(("..", "shared")),
    ".".join(("pypi", "org")),
    ".".join(("files", "pythonhosted", "org")),
    ".".join(("registry", "npmjs", "org")),
    ".".join(("deb", "debian", "org")),
]
EVALUATORS = {"eval", "exec", "compile", "sympify", "parse_expr", "S", "simplify", "trigsimp", "__import__"}
FULL_LOADERS = {"load", "load_all", "full_load", "unsafe_load", "Loader", "FullLoader", "UnsafeLoader"}


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


def tracked() -> list[Path]:
    """The files under version control; in an unpacked source archive all files."""
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True)
    if done.returncode == 0:
        return [path for name in done.stdout.split("\0") if name and (path := ROOT / name).is_file()]
    found = (path for path in ROOT.rglob("*") if path.is_file())
    return [path for path in found if not re.search(r"(^|/)(\.|__pycache__)", name(path))]


def name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def test_no_file_names_this_machine_or_a_registry() -> None:
    found = []
    for path in tracked():
        text = path.read_bytes().decode("utf-8", errors="ignore")
        found += [f"{name(path)}: {word}" for word in FORBIDDEN if word in text]
    assert not found


def nodes(kind: Any) -> Iterator[tuple[Path, Any]]:
    for path in modules().values():
        yield from ((path, node) for node in ast.walk(tree(path)) if isinstance(node, kind))


def test_nothing_evaluates_text_or_simplifies() -> None:
    """Methods of ``re`` and Jinja's environment are left out by their dots, what reads no text by its ``strict``."""
    found = []
    for path, call in nodes(ast.Call):
        strict = [k.value for k in call.keywords if k.arg == "strict"]  # sympify(x, strict=True) refuses text unread
        called = getattr(call.func, "id", "") or getattr(call.func, "attr", "").replace("compile", "")
        if called in EVALUATORS and not any(isinstance(v, ast.Constant) and v.value is True for v in strict):
            found.append(f"{name(path)}:{call.lineno}: {called}")
    assert found == []


def test_no_full_yaml_loader() -> None:
    found = [(name(path), n.attr) for path, n in nodes(ast.Attribute) if getattr(n.value, "id", "") == "yaml"]
    assert [(file, loader) for file, loader in found if loader in FULL_LOADERS] == []


def test_files_and_functions_stay_readable() -> None:
    long = [name(path) for path in modules().values() if path.read_text(encoding="utf-8").count("\n") > MAX_FILE]
    for path, function in nodes(ast.FunctionDef | ast.AsyncFunctionDef):
        body = function.body[1:] if ast.get_docstring(function) is not None else function.body
        lines = (function.end_lineno or 0) - body[0].lineno + 1 if body else 0
        long += [f"{name(path)}:{function.name}: {lines} lines"] if lines > MAX_FUNCTION else []
    assert long == []

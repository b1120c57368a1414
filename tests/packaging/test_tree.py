"""Rules for the whole tree: layers, no machine's paths, no evaluation of users' text, readable files and functions."""

import ast
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.places import ROOT

SOURCES = sorted((ROOT / "derive").rglob("*.py"))
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


def tracked() -> list[Path]:
    """The files under version control; in an unpacked source archive all files."""
    done = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True)
    if done.returncode == 0:
        return [path for name in done.stdout.split("\0") if name and (path := ROOT / name).is_file()]
    found = (path for path in ROOT.rglob("*") if path.is_file())
    return [path for path in found if not any(part.startswith((".", "__pycache__")) for part in relative(path).parts)]


def relative(path: Path) -> Path:
    return path.relative_to(ROOT)


def name(path: Path) -> str:
    return relative(path).as_posix()


def test_no_file_names_this_machine_or_a_registry() -> None:
    found = []
    for path in tracked():
        text = path.read_bytes().decode("utf-8", errors="ignore")
        found += [f"{name(path)}: {word}" for word in FORBIDDEN if word in text]
    assert not found


@pytest.mark.parametrize("path", SOURCES, ids=name)
def test_nothing_evaluates_text_or_simplifies(path: Path) -> None:
    assert not [f"{name(path)}:{line}: {call}" for call, line in calls(path) if call in EVALUATORS]


@pytest.mark.parametrize("path", SOURCES, ids=name)
def test_no_full_yaml_loader(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    attributes = [node for node in ast.walk(tree) if isinstance(node, ast.Attribute)]
    found = [node.attr for node in attributes if isinstance(node.value, ast.Name) and node.value.id == "yaml"]
    assert not FULL_LOADERS.intersection(found)


@pytest.mark.parametrize("path", SOURCES, ids=name)
def test_files_and_functions_stay_readable(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.count("\n") <= MAX_FILE
    functions = (n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef))
    assert not [f"{f.name}: {length(f)} lines" for f in functions if length(f) > MAX_FUNCTION]


def calls(path: Path) -> Iterator[tuple[str, int]]:
    """Names of what a file calls, methods of ``re`` and Jinja's environment left out by their dots."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Call) or takes_no_text(node):
            continue
        if isinstance(node.func, ast.Name):
            yield node.func.id, node.lineno
        if isinstance(node.func, ast.Attribute) and node.func.attr != "compile":
            yield node.func.attr, node.lineno


def takes_no_text(call: ast.Call) -> bool:
    """``sympify(x, strict=True)`` refuses text before reading it."""
    return any(k.arg == "strict" and isinstance(k.value, ast.Constant) and k.value.value is True for k in call.keywords)


def length(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    body = function.body[1:] if ast.get_docstring(function) is not None else function.body
    return (function.end_lineno or 0) - body[0].lineno + 1 if body else 0

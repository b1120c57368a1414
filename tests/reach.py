"""Which tests a change can reach: ``python -m tests.reach [REVISION]`` prints the files whose sweeps are run.

A test is reached if it changed since REVISION or imports, over however many others, a Python file that did; imports
inside functions and for type checkers count. Pages of text reach none. Whatever else changed (a template, a robot file,
the set-up) reaches all. Without a revision nothing is printed, and pytest takes all.
"""

import ast
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from tests.places import ROOT

FOLDERS = ("derive/", "bench/", "tests/")
SET_UP = ("conftest.py", "__init__.py")
NO_SWEEP = "tests/packaging/test_reach.py"
"""Stands for none: a pytest that is given no file takes them all."""


def file_of(module: str, folder: Path) -> str | None:
    """The file of a module, from the root."""
    stem = module.replace(".", "/")
    return next((file for file in (f"{stem}.py", f"{stem}/__init__.py") if (folder / file).is_file()), None)


def imported(path: Path, folder: Path) -> Iterator[str]:
    """Files that a file imports or runs; packages on the way are empty but for their docstrings."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            files = [file_of(f"{node.module}.{a.name}", folder) or file_of(node.module, folder) for a in node.names]
        elif isinstance(node, ast.Import):
            files = [file_of(alias.name, folder) for alias in node.names]
        elif isinstance(node, ast.List) and {"-m", "derive"} <= {getattr(entry, "value", None) for entry in node.elts}:
            files = ["derive/__main__.py"]  # in another process
        elif isinstance(node, ast.Constant) and node.value == "derive.cli":
            files = [file.relative_to(folder).as_posix() for file in (folder / "derive/cli").rglob("*.py")]  # by name
        else:
            continue
        yield from filter(None, files)


def importers(folder: Path = ROOT) -> dict[str, set[str]]:
    """Of each Python file those that import it."""
    paths = [path for name in FOLDERS for path in (folder / name).rglob("*.py")]
    found: dict[str, set[str]] = {path.relative_to(folder).as_posix(): set() for path in paths}
    for path in paths:
        for other in imported(path, folder):
            found.setdefault(other, set()).add(path.relative_to(folder).as_posix())
    return found


def reached(changed: Iterable[str], graph: Mapping[str, set[str]]) -> list[str] | None:
    """The files of tests that a change of these files reaches; None stands for all of them."""
    waiting, found = [name for name in changed if not name.endswith(".md")], set[str]()
    if any(not name.startswith(FOLDERS) or not name.endswith(".py") or name.endswith(SET_UP) for name in waiting):
        return None  # imports do not tell
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += graph.get(name, ())  # who imported a file that is gone has changed as well
    return sorted(name for name in found & set(graph) if Path(name).name.startswith("test_"))


def changed_since(revision: str) -> list[str]:
    """Files that differ from a revision, new ones among them; raises `CalledProcessError` if there is no such one."""
    differing = ["diff", "--name-only", "--no-renames", "-z", revision, "--"]
    texts = (
        subprocess.run(["git", *arguments], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
        for arguments in (differing, ["ls-files", "--others", "--exclude-standard", "-z"])
    )
    return [name for text in texts for name in text.split("\0") if name]


if __name__ == "__main__" and sys.argv[1:]:
    files = reached(changed_since(sys.argv[1]), importers())
    print(*([] if files is None else files or [NO_SWEEP]))

"""Do the tests still see a fault? Functions with one operation changed, against the tests of their folder.

`python -m bench.mutation BEFORE AFTER` takes two revisions, changes 60 functions that both have in the same words, one
at a time, and prints which of the changes the tests of each revision notice. Functions are chosen by a digest of their
names, so the sample is the same whoever asks.
"""

from __future__ import annotations

import argparse
import ast
import copy
import hashlib
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import Queue

ROOT = Path(__file__).resolve().parent.parent
# A subject's folders of code; its tests stand in the folder of the same name, wherever a revision has it.
SUBJECTS = {
    "mechanics": ("mechanics",),
    "lecture": ("lecture",),
    "programs": ("programs",),
    "inverse": ("inverse", "model/inverse"),
    "exchange": ("exchange",),
}
PER_SUBJECT = 12
LIMIT = 600  # seconds; a change that makes the tests endless is noticed, too
BESIDE = ("sweep", "release", "pages", "robots", "toolbox")  # marks of tests that `make test` leaves out
SWAPPED: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Add,
    ast.Div: ast.Mult,
    ast.USub: ast.UAdd,
    ast.And: ast.Or,
    ast.Or: ast.And,
    ast.Lt: ast.GtE,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}

Function = tuple[Path, ast.FunctionDef]


def functions(tree: Path, subject: str) -> dict[str, Function]:
    """The functions of a subject by name; names that occur twice are left out."""
    found: dict[str, Function] = {}
    seen: set[str] = set()
    for folder in SUBJECTS[subject]:
        for path in sorted((tree / "derive" / folder).rglob("*.py")):
            for name, node in _named(ast.parse(path.read_text()), ""):
                found[name] = path, node
                if name in seen:
                    del found[name]
                seen.add(name)
    return found


def _named(node: ast.AST, prefix: str) -> Iterator[tuple[str, ast.FunctionDef]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef):
            yield prefix + child.name, child
        elif isinstance(child, ast.ClassDef):
            yield from _named(child, f"{prefix}{child.name}.")


def bare(node: ast.FunctionDef) -> ast.FunctionDef:
    """The function without its docstring."""
    node = copy.deepcopy(node)
    if ast.get_docstring(node) is not None:
        node.body = node.body[1:] or [ast.Pass()]
    return node


def changes(node: ast.FunctionDef) -> list[ast.FunctionDef]:
    """The function with one operation changed, in every way."""
    return [changed for k in range(sum(1 for _ in ast.walk(node))) if (changed := _changed(node, k)) is not None]


def _changed(node: ast.FunctionDef, k: int) -> ast.FunctionDef | None:
    """The function with its k-th node changed; None where that is nothing to change."""
    node = copy.deepcopy(node)
    place = list(ast.walk(node))[k]
    if isinstance(place, ast.BinOp | ast.BoolOp | ast.UnaryOp) and type(place.op) in SWAPPED:
        place.op = SWAPPED[type(place.op)]()  # type: ignore[assignment]
    elif isinstance(place, ast.Compare) and type(place.ops[0]) in SWAPPED:
        place.ops[0] = SWAPPED[type(place.ops[0])]()  # type: ignore[call-overload]
    elif isinstance(place, ast.Constant) and type(place.value) is int:
        place.value += 1
    elif isinstance(place, ast.If | ast.IfExp):
        place.test = ast.UnaryOp(ast.Not(), place.test)
    else:
        return None
    return node


def digest(text: str) -> int:
    """A number that depends on a name alone."""
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8])


def sample(before: Path, after: Path) -> list[tuple[str, str]]:
    """Subject and name of the functions to change."""
    chosen = []
    for subject in SUBJECTS:
        old, new = functions(before, subject), functions(after, subject)
        same = [n for n in old.keys() & new.keys() if ast.dump(bare(old[n][1])) == ast.dump(bare(new[n][1]))]
        same = [name for name in sorted(same, key=digest) if changes(bare(new[name][1]))]
        chosen += [(subject, name) for name in same[:PER_SUBJECT]]
    return chosen


def is_noticed(tree: Path, subject: str, name: str) -> bool:
    """Whether a test of the subject's folder fails when the function is changed."""
    path, node = functions(tree, subject)[name]
    body = bare(node)
    ways = changes(body)
    text = path.read_text()
    lines = text.splitlines(keepends=True)
    start = min([node.lineno, *(d.lineno for d in node.decorator_list)]) - 1
    changed = ast.unparse(ways[digest(name) % len(ways)]).splitlines(keepends=True)
    indent = " " * node.col_offset
    path.write_text("".join([*lines[:start], *(indent + line for line in changed), "\n", *lines[node.end_lineno :]]))
    tests = [f"tests/{folder}" for folder in SUBJECTS[subject] if (tree / "tests" / folder).is_dir()]
    known = (tree / "pyproject.toml").read_text()  # pytest ends with an error where a mark is unknown
    marks = " and ".join(f"not {mark}" for mark in BESIDE if f'"{mark}:' in known)
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-n0", "-p", "no:cacheprovider", "-m", marks, *tests]
    environment = {**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        ended = subprocess.run(command, cwd=tree, env=environment, capture_output=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return True
    finally:
        path.write_text(text)
    assert ended.returncode in (0, 1, 2), ended.stdout.decode()  # passed, failed, or modules that cannot be imported
    return ended.returncode != 0


def scores(revision: str, chosen: list[tuple[str, str]], jobs: int, folder: Path) -> dict[str, bool]:
    """Whether each change is noticed at a revision; every job has a copy of the tree to itself."""
    copies: Queue[Path] = Queue()
    for k in range(jobs):
        copy_ = folder / f"{revision}-{k}"
        subprocess.run(["git", "worktree", "add", "-q", "--detach", copy_, revision], cwd=ROOT, check=True)
        copies.put(copy_)

    def score(item: tuple[str, str]) -> bool:
        tree = copies.get()
        try:
            return is_noticed(tree, *item)
        finally:
            copies.put(tree)

    with ThreadPoolExecutor(jobs) as pool:
        return {name: found for (_, name), found in zip(chosen, pool.map(score, chosen), strict=True)}


def main() -> None:
    """Print the changes that one revision's tests notice and the other's do not, and both scores."""
    parser = argparse.ArgumentParser(prog="python -m bench.mutation", description=__doc__.splitlines()[0])
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--known", type=Path, help="JSON file that keeps what was found")
    arguments = parser.parse_args()
    known = json.loads(arguments.known.read_text()) if arguments.known and arguments.known.exists() else {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        trees = []
        for revision in (arguments.before, arguments.after):
            trees.append(folder / f"read-{revision}")
            subprocess.run(["git", "worktree", "add", "-q", "--detach", trees[-1], revision], cwd=ROOT, check=True)
        chosen = sample(*trees)
        found = {}
        for revision in (arguments.before, arguments.after):
            asked = [item for item in chosen if item[1] not in known.get(revision, {})]
            known.setdefault(revision, {}).update(scores(revision, asked, arguments.jobs, folder))
            found[revision] = known[revision]
            if arguments.known:
                arguments.known.write_text(json.dumps(known, indent=1))
    subprocess.run(["git", "worktree", "prune"], cwd=ROOT, check=True)
    before, after = found[arguments.before], found[arguments.after]
    for subject, name in chosen:
        print(f"{subject:10} {name:50} {before[name]!s:5} {after[name]!s:5}")
    print(f"noticed: {sum(before[n] for _, n in chosen)} and {sum(after[n] for _, n in chosen)} of {len(chosen)}")


if __name__ == "__main__":
    main()

"""Digests of everything derive writes: one line per robot and kind of output.

`make golden` prints them; `make golden BASE=REVISION` runs the same commands with the package of another revision
and prints the lines that differ. Nothing is committed, since the last digits of floats are the machine's.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INDICES = {"": "", "[i]": "[1]", "[i,...]": "[1,2]", "[i,j,k]": "[1,1,2]"}
FORMATS = ("urdf", "mjcf", "rtb", "corke", "rigidbodytree", "csv")
OPTIONS_OF_MOVE = ("", "--joints", "--show", "--hand", "--json", "--increments 50", "--simulate")
FILES_OF_MOVE = {"--csv": "/a.csv", "--html": "/a.html", "--plot": "/a.svg", "--part": "/a.tex", "--out": ""}
LONG = ("human-body",)  # its 21 joints have closed forms of minutes: generated files and handout alone

Job = tuple[str, str, tuple[str, ...]]
"""Robot or document, kind of output, and the command; ``{out}`` in it is an empty folder whose files count."""


def robots() -> list[str]:
    """The built-in robots."""
    return [line.split()[0] for line in _said(("list",)).splitlines()[1:]]


def documents() -> list[Path]:
    """Printed formulas with their robots."""
    folders = ROOT / "tests" / "lectures" / "corpus", ROOT / "tests" / "textbooks"
    return [path for folder in folders for path in sorted(folder.glob("*.yaml"))]


def plans() -> list[str]:
    """The built-in motion plans."""
    return [line.split()[0] for line in _said(("list", "--plans")).splitlines()[1:]]


def jobs() -> Iterator[Job]:
    """Every command, long ones first."""
    for robot in robots():
        yield robot, "build", ("build", robot, "--target", "all", "--out", "{out}", "--quiet")
        for option in ("--lang en", "--lang it", "--derivation steps"):
            asked = *option.split(), "--tex", "--html", "--out", "{out}", "--quiet"
            yield robot, f"handout {option}", ("handout", robot, *asked)
        if robot in LONG:
            continue
        for name in json.loads(_said(("show", robot, "--json")))["quantities"]:
            quantity = name.split("[")[0] + INDICES[name[len(name.split("[")[0]) :]]
            for form in ("text", "latex"):
                yield robot, f"show {quantity} {form}", ("show", robot, quantity, "--format", form)
        for form in FORMATS:
            yield robot, f"export {form}", ("export", robot, "--format", form, "--inertia", "possible")
        yield robot, "convert", ("convert", robot)
    for document in documents():
        yield document.stem, "check", ("check", document.name)
        yield document.stem, "check json", ("check", document.name, "--json")
    for plan in plans():
        for options in OPTIONS_OF_MOVE:
            yield plan, f"move {options}", ("move", plan, *options.split())
        for option, file in FILES_OF_MOVE.items():
            yield plan, f"move {option}", ("move", plan, option, f"{{out}}{file}", "--quiet")
    yield "schema", "robot", ("schema",)
    yield "schema", "plan", ("schema", "--plan")
    for command in re.findall(r"^    (\w+) ", _said(("--help",)), re.MULTILINE):
        yield command, "help", (command, "--help")


def _said(command: tuple[str, ...]) -> str:
    """What a command prints, with its exit status."""
    from derive.cli.main import main

    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as error:
        try:
            status = main(list(command))
        except SystemExit as end:
            status = end.code
    return out.getvalue() + (f"{error.getvalue()}status {status}\n" if status or error.getvalue() else "")


def digest(job: Job) -> tuple[str, str]:
    """What a job is called, and the digest of what it prints and writes, but of binaries."""
    name, kind, command = job
    found = hashlib.sha256()
    with tempfile.TemporaryDirectory() as folder:
        said = _said(tuple(part.replace("{out}", folder) for part in command))
        found.update(said.replace(folder, "").encode())
        for file in sorted(Path(folder).rglob("*")):
            if file.is_file() and file.suffix not in (".so", ".pyc"):
                found.update(str(file.relative_to(folder)).encode() + file.read_bytes())
        if KEPT is not None:
            _keep(KEPT / re.sub(r"\W+", "-", f"{name} {kind}"), said, Path(folder))
    return f"{name}: {kind}", found.hexdigest()[:16]


KEPT = Path(os.environ["GOLDEN_KEEP"]) if "GOLDEN_KEEP" in os.environ else None


def _keep(place: Path, said: str, folder: Path) -> None:
    """The texts themselves, for who wants to see what differs."""
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(folder, place)
    (place / "said.txt").write_text(said.replace(str(folder), ""))


def digests(workers: int) -> dict[str, str]:
    """All of them, by name."""
    inputs = tempfile.mkdtemp()
    try:
        for document in documents():
            shutil.copy(document, inputs)
        os.chdir(inputs)
        with ProcessPoolExecutor(workers, mp_context=get_context("fork")) as pool:
            return dict(pool.map(digest, jobs()))
    finally:
        os.chdir(ROOT)
        shutil.rmtree(inputs)


def of_revision(revision: str, workers: int) -> dict[str, str]:
    """Those of the package of another revision, by this same file."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["git", "-C", str(ROOT), "worktree", "add", "--detach", folder, revision], check=True)
        try:
            command = [sys.executable, __file__, "--jobs", str(workers)]
            keep = {"GOLDEN_KEEP": f"{KEPT}-base"} if KEPT else {}
            environment = {**os.environ, "PYTHONPATH": folder, **keep}
            said = subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout
        finally:
            subprocess.run(["git", "-C", str(ROOT), "worktree", "remove", "--force", folder], check=True)
    return dict(reversed(line.split("  ", 1)) for line in said.splitlines())


def main() -> int:
    """Prints the digests, or what differs from another revision; exit status 1 where something does."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", default="", help="revision to compare with")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    given = parser.parse_args()
    found = digests(given.jobs)
    if not given.base:
        print("\n".join(f"{value}  {name}" for name, value in found.items()))
        return 0
    before = of_revision(given.base, given.jobs)
    differ = [name for name in {**before, **found} if before.get(name) != found.get(name)]
    print("\n".join([*(f"differs: {name}" for name in differ), f"{len(differ)} of {len(found)} outputs differ"]))
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())

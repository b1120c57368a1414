"""Reads the console blocks of a Markdown page and runs them as a reader would: in order, in one empty folder.

``python -m tests.docs.console README.md docs/*.md`` writes what commands print now into the pages. Only what no longer
agrees is rewritten, so ``...`` stays where a page has it on purpose.
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.cli.command import derive_on_terminal
from tests.places import ROOT

_FENCE = re.compile(r"^```(?P<info>[^\n`]*)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL)
_ROUNDING_ERROR = re.compile(r"\b\d\.\de-1\d\b")
_ANY_ROUNDING_ERROR = r"(?:0\.0|0|\d\.\de-1\d)"
_SHELL = re.compile(r"[|&;<>$`*?()#!]")
"""What may mean something to a shell outside of single quotes."""

_QUOTED = re.compile("'[^']*'")
_STATUS = re.compile(r"\[exit status (\d+)\]")


@dataclass(frozen=True)
class Block:
    language: str
    file: str
    body: str
    line: int


@dataclass(frozen=True)
class Command:
    text: str
    output: tuple[str, ...]
    status: int


def blocks(page: Path) -> Iterator[Block]:
    """The fenced blocks of a page; an info string such as ``yaml file=arm.yaml`` names a file."""
    text = page.read_text(encoding="utf-8")
    for match in _FENCE.finditer(text):
        language, _, rest = match["info"].strip().partition(" ")
        file = rest.removeprefix("file=") if rest.startswith("file=") else ""
        yield Block(language, file, match["body"], text.count("\n", 0, match.start()) + 1)


def commands(block: Block) -> Iterator[Command]:
    """The commands of a console block: ``$ command``, its output, and ``[exit status 2]`` where it is not 0."""
    text, output, status = "", [], 0
    for line in [*block.body.splitlines(), "$ "]:
        if line.startswith("$ "):
            if text:
                yield Command(text, tuple(output), status)
            text, output, status = line[2:], [], 0
        elif match := _STATUS.fullmatch(line):
            status = int(match[1])
        else:
            output.append(line)


def environment(folder: Path) -> dict[str, str]:
    bin_folder = folder / "bin"
    bin_folder.mkdir(parents=True, exist_ok=True)
    for name, arguments in (("derive", " -m derive"), ("python", "")):
        script = bin_folder / name
        script.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)}{arguments} "$@"\n')
        script.chmod(0o755)
    path = os.pathsep.join((str(bin_folder), os.environ.get("PATH", "")))
    python_path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH", ""))))
    reader = {"COLUMNS": "120", "NO_COLOR": "1", "LC_ALL": "C.UTF-8"}  # `ls` sorts by the locale
    return {**os.environ, **reader, "PATH": path, "PYTHONPATH": python_path}


def run(command: Command, folder: Path, variables: dict[str, str]) -> tuple[list[str], int]:
    """Output (both streams, as a terminal shows them) and exit status.

    A shell runs what needs one; a single ``derive`` is run in this process, which has imported it once.
    """
    if command.text.startswith("derive ") and not _SHELL.search(_QUOTED.sub("", command.text)):
        status, text = derive_on_terminal(*shlex.split(command.text)[1:], folder=folder, **variables)
        return text.splitlines(), status
    done = subprocess.run(
        ["bash", "-c", command.text],
        cwd=folder,
        env=variables,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        timeout=600,
    )
    return done.stdout.splitlines(), done.returncode


def agrees(shown: tuple[str, ...], printed: list[str]) -> bool:
    """Whether the output is what the page shows.

    ``...`` stands for any text, on a line of its own for any lines; a rounding error for any other that verification
    lets pass (below 1e-9), since processors round differently.
    """
    pattern = ""
    for line in shown:
        if line.strip() == "...":
            pattern += r"(?:.*\n)*?"
        else:
            parts = (map(re.escape, _ROUNDING_ERROR.split(part.rstrip())) for part in line.split("..."))
            pattern += ".*?".join(map(_ANY_ROUNDING_ERROR.join, parts)) + r"[ ]*\n"
    return re.fullmatch(pattern, "".join(f"{line}\n" for line in printed)) is not None


def _shown(command: Command, printed: list[str], status: int) -> str:
    output = command.output if agrees(command.output, printed) else [line.rstrip() for line in printed]
    note = [f"[exit status {status}]"] if status else []
    return "".join(f"{line}\n" for line in (f"$ {command.text}", *output, *note))


def refresh(page: Path) -> None:
    """Run the blocks of one page in order, in an empty folder."""
    text = page.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        variables = environment(folder / "path")
        (folder / "work").mkdir()
        for block in blocks(page):
            if block.file:
                (folder / "work" / block.file).write_text(block.body, encoding="utf-8")
            if block.language == "console":
                shown = (_shown(command, *run(command, folder / "work", variables)) for command in commands(block))
                text = text.replace(block.body, "".join(shown), 1)
    page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    for argument in sys.argv[1:]:
        refresh(Path(argument))

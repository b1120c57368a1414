"""Options that several commands have, one name and one meaning each; and the names that options had before."""

import argparse
from pathlib import Path
from typing import Any

STDOUT = Path("-")  # instead of a file: what is written is printed


def file_or_stdout(text: str) -> Path | None:
    """The path of a file; None for ``-``, standard output."""
    return None if text == str(STDOUT) else Path(text)


_OUT = ("-o", "--out")
_FLAG = {"action": "store_true"}
_BODIES: dict[str, Any] = {"choices": ("given", "possible"), "default": "given"}

# Names and settings by what `add_shared` calls them.
SHARED: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "robot": (("robot",), {"metavar": "ROBOT", "help": "robot file or built-in robot"}),
    "out": (_OUT, {"metavar": "FILE", "type": file_or_stdout, "help": "file to write (default: standard output)"}),
    "folder": (_OUT, {"metavar": "DIR", "type": Path}),
    "at": (("--at",), {"metavar": "V1,V2,...", "action": "append", "default": []}),
    "format": (("--format",), {"metavar": "FORMAT"}),
    "style": (("--style",), {"metavar": "STYLE"}),
    "task": (("--task",), {"metavar": "ROWS"}),
    "inertia": (
        ("--inertia",),
        _BODIES | {"help": "keep inertias, or replace inconsistent ones by the closest valid ones"},
    ),
    "lang": (("--lang",), {"metavar": "CODE", "help": "language: en, it, pt or another that has a message catalogue"}),
    "force": (("--force",), _FLAG | {"help": "overwrite files that exist"}),
    "strict": (("--strict",), _FLAG | {"help": "treat warnings about the robot file as errors"}),
    "quiet": (("--quiet",), _FLAG | {"help": "print no progress and no report"}),
    "json": (("--json",), _FLAG | {"help": "print JSON, errors included"}),
}
_POINT = {"-q": "--at"}
# Of each command the names that options had; they are understood and not shown.
OLD = {"check": {"--report": "--out"}, "export": {"--to": "--format"}, "handout": _POINT, "plot": _POINT}


def add_shared(parser: argparse._ActionsContainer, *names: str, **settings: Any) -> None:
    """Add options that several commands have, with what a command says otherwise about them."""
    for name in names:
        flags, usual = SHARED[name]
        parser.add_argument(*flags, **usual | settings)


def keywords(arguments: argparse.Namespace, *names: str) -> dict[str, Any]:
    """Options that the Python API knows by the same names, as keywords of its functions."""
    return {name: getattr(arguments, name) for name in names}

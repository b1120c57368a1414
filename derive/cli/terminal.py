"""How commands speak and listen: messages of one line, columns, JSON, progress, exit statuses, shared options.

Results go to standard output, messages and progress to standard error. A wrong argument is refused with what was found
and what is allowed. Options that several commands have keep one name and one meaning; the names that options had before
are understood.
"""

import argparse
import json
import os
import shutil
import signal
import sys
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any, TextIO

from derive.errors import DeriveError, RobotFileWarning, quoted

FAILED = 1
WRONG_INPUT = 2
INTERNAL_FAULT = 70
INTERRUPTED = 130
BROKEN_PIPE = 141

BOLD, RED, YELLOW = 1, 31, 33  # numbers of colours in terminals (ECMA-48)


def one_line(text: str) -> str:
    """A text on one line, with control characters escaped: it may quote a stranger's file."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def print_columns(rows: Sequence[Sequence[str]], header: Sequence[str] = ()) -> None:
    """Print rows with their columns aligned, and nothing after the last column."""
    lines = [header, *rows] if header else rows
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for place, line in enumerate(lines):
        text = "  ".join(map(str.ljust, line, widths)).rstrip()
        print(coloured(text, BOLD, sys.stdout) if header and place == 0 else text)


def print_json(value: Any) -> None:
    """Print plain data as JSON, indented, keys in the order given."""
    print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def print_written(arguments: argparse.Namespace, text: str, report: dict[str, Any], lines: Iterable[str]) -> None:
    """Print what was written to the file of ``-o``: as data, or lines about it; without a file the text itself."""
    if arguments.json:
        print_json(({"file": str(arguments.out)} if arguments.out else {"text": text}) | report)
    elif arguments.out is None:
        print(text, end="")
    elif not arguments.quiet:
        print(*map(one_line, lines), sep="\n")


def explain(error: BaseException) -> tuple[str, int]:
    """What to say about an error."""
    if isinstance(error, DeriveError):
        return str(error), error.exit_status
    if isinstance(error, RobotFileWarning):
        return f"{error} (an error because of --strict)", WRONG_INPUT
    if isinstance(error, KeyboardInterrupt):
        return "interrupted", INTERRUPTED
    if isinstance(error, OSError):
        reason = error.strerror or str(error)
        return (f"{error.filename}: {reason}" if error.filename else reason), WRONG_INPUT
    if os.environ.get("DERIVE_TRACEBACK"):
        traceback.print_exception(error)
    fault = f"internal fault, {type(error).__name__}: {error}"
    return f"{fault}; please report it with what DERIVE_TRACEBACK=1 prints", INTERNAL_FAULT


def print_error(reason: object) -> None:
    """Print a message on standard error: one line, whatever it quotes."""
    print(f"derive: {coloured('error:', RED, sys.stderr)} {one_line(str(reason))}", file=sys.stderr)


def error_dict(error: BaseException, message: str, status: int) -> dict[str, Any]:
    """An error as plain data: message, exit status and kind; place, and the parts of the message, where it has them."""
    parts = ("found", "allowed", "remedy")
    found: dict[str, Any] = {"message": message, "status": status, "kind": type(error).__name__}
    found |= {name: getattr(error, name) for name in parts if getattr(error, name, "")}
    if (place := getattr(error, "location", None)) is not None:
        found |= {"file": place.source, "line": place.line, "column": place.column}
    return found


def coloured(text: str, colour: int, stream: TextIO) -> str:
    """A text in a colour of the terminal; plain in pipes and where nobody wants colours (no-color.org)."""
    wanted = (stream.isatty() and os.environ.get("TERM") != "dumb") or os.environ.get("FORCE_COLOR")
    return f"\x1b[{colour}m{text}\x1b[0m" if wanted and not os.environ.get("NO_COLOR") else text


@contextmanager
def remarks_told(*, strict: bool) -> Iterator[None]:
    """Print remarks on robot files on standard error, each once, while a command runs."""
    told: set[str] = set()
    usual = warnings.showwarning

    def _tell(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
        if not issubclass(category, RobotFileWarning):
            usual(message, category, *place, **more)
        elif str(message) not in told:
            told.add(str(message))
            print(f"derive: {coloured('warning:', YELLOW, sys.stderr)} {one_line(str(message))}", file=sys.stderr)

    with warnings.catch_warnings():
        warnings.simplefilter("error" if strict else "always", RobotFileWarning)
        warnings.showwarning = _tell
        yield


Tell = Callable[[str, str], None]  # called with the name of a robot and the stage that it has reached


@contextmanager
def progress(total: int, *, quiet: bool) -> Iterator[Tell | None]:
    """A line on standard error with the robot, its stage and the time it has taken; it is gone at the end.

    An alarm of the system moves the clock on: a thread would keep builds from using a second process. It gives the
    function to tell a robot's stage, or None where nobody watches.
    """
    if quiet or not sys.stderr.isatty():
        yield None
        return
    terminal, done, shown, since = sys.stderr.fileno(), 0, "", time.monotonic()

    def _draw(*_alarm: object) -> None:
        width = shutil.get_terminal_size().columns - 1
        count = f"[{done}/{total}] " if total > 1 else ""
        text = one_line(f"{count}{shown}  {time.monotonic() - since:.0f} s")[:width] if shown else ""
        with suppress(OSError):  # the terminal has gone
            os.write(terminal, f"\r\x1b[K{text}".encode(errors="replace"))

    def _tell(robot: str, stage: str) -> None:
        nonlocal done, shown, since
        if robot != shown.partition(": ")[0]:
            since = time.monotonic()
        done, shown = done + (stage in ("done", "failed")), f"{robot}: {stage}"
        _draw()

    ticks = hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGALRM, _draw) if ticks else None
    try:
        if ticks:
            signal.setitimer(signal.ITIMER_REAL, 1.0, 1.0)
        yield _tell
    finally:
        if ticks:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)
        shown = ""
        _draw()


def line_range(text: str) -> tuple[int, int]:
    """The lines of ``20-80``."""
    first, dash, last = text.partition("-")
    if not (first.strip().isdigit() and (last.strip().isdigit() or not dash)) or int(first) > int(last or first):
        raise argparse.ArgumentTypeError(f"{quoted(text)} is not a range of lines such as 20-80")
    return int(first), int(last or first)


def _number(text: str, least: float, most: float, kind: type[int] | type[float] = int) -> float:
    with suppress(ValueError):
        is_plain = kind is float or (text.isascii() and text.isdecimal() and len(text) <= len(str(most)))
        if is_plain and least <= kind(text) <= most:
            return kind(text)
    what = "a whole number" if kind is int else "a number"
    raise argparse.ArgumentTypeError(f"{text!r} is not {what} from {least} to {most}")


def numbers(text: str, wanted: str) -> list[float]:
    """Numbers with commas between; ``wanted`` is what a refusal says that it is not."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is not {wanted}") from None


def named_values(texts: Sequence[str], option: str, allowed: str) -> Iterator[tuple[str, str]]:
    """What an option that may be repeated says, ``NAME=VALUE,...``."""
    for text in ",".join(texts).split(",") if texts else ():
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise DeriveError(f"{quoted(text)} in {option}", allowed=allowed)
        yield name, value


positive = partial(_number, least=1, most=99999999)  # a whole number from 1 on
digit_count = partial(_number, least=1, most=30)  # a number of significant digits
magnification = partial(_number, least=0.1, most=10, kind=float)


# -- options that several commands have

STDOUT = Path("-")  # instead of a file: what is written is printed


def file_or_stdout(text: str) -> Path | None:
    """The path of a file; None for ``-``, standard output."""
    return None if text == str(STDOUT) else Path(text)


_OUT = ("-o", "--out")
_FLAG = {"action": "store_true"}
_INERTIA = "keep inertias, or replace inconsistent ones by the closest valid ones"
_BODIES: dict[str, Any] = {"choices": ("given", "possible"), "default": "given", "help": _INERTIA}

# Names and settings by what `add_shared` calls them.
SHARED: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "robot": (("robot",), {"metavar": "ROBOT", "help": "robot file or built-in robot"}),
    "out": (_OUT, {"metavar": "FILE", "type": file_or_stdout, "help": "file to write (default: standard output)"}),
    "folder": (_OUT, {"metavar": "DIR", "type": Path}),
    "at": (("--at",), {"metavar": "V1,V2,...", "action": "append", "default": []}),
    "format": (("--format",), {"metavar": "FORMAT"}),
    "style": (("--style",), {"metavar": "STYLE"}),
    "task": (("--task",), {"metavar": "ROWS"}),
    "inertia": (("--inertia",), _BODIES),
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

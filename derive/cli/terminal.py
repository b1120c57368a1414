"""Plain text for terminals and pipes: one-line messages, aligned columns, JSON; exit statuses.

Progress on standard error, when it is a terminal and nobody asked for quiet.

Types of command-line arguments; a wrong value is refused with what was found and what is allowed.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from derive.errors import DeriveError

DONE = 0
FAILED = 1
WRONG_INPUT = 2
INTERNAL_FAULT = 70
INTERRUPTED = 130
BROKEN_PIPE = 141


def one_line(text: str) -> str:
    """``text`` on one line, with control characters escaped: it may quote a stranger's file."""
    return "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode() for character in text
    )


def print_columns(rows: Sequence[Sequence[str]], header: Sequence[str] = ()) -> None:
    """Print ``rows`` with their columns aligned, and nothing after the last column."""
    lines = [list(header), *map(list, rows)] if header else [list(row) for row in rows]
    if not lines:
        return
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    for line in lines:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip())


def print_json(value: Any) -> None:
    """Print ``value`` as JSON, indented, keys in the order given."""
    json.dump(value, sys.stdout, indent=2, ensure_ascii=False, allow_nan=False)
    print()


def explain(error: BaseException) -> tuple[str, int]:
    """The message for an error, and the exit status that it means."""
    if isinstance(error, DeriveError):
        return str(error), error.exit_status
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
    print(f"derive: error: {one_line(str(reason))}", file=sys.stderr)


Tell = Callable[[str, str], None]

_ENDS = ("done", "failed")


@contextmanager
def progress(total: int, *, quiet: bool) -> Iterator[Tell | None]:
    """A bar over ``total`` robots; yields the function to tell a robot's stage, or None where nobody watches."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn

    columns = (SpinnerColumn(), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}", markup=False))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=total)

        def tell(robot: str, stage: str) -> None:
            bar.update(task, description=f"{robot}: {stage}", advance=1 if stage in _ENDS else 0)

        yield tell


def positive(text: str) -> int:
    """A whole number from 1 on."""
    if not (text.isascii() and text.isdecimal()) or len(text) > 8 or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 1 to 99999999")
    return int(text)


def natural(text: str) -> int:
    """A whole number from 0 on."""
    if not (text.isascii() and text.isdecimal()) or len(text) > 8:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0 to 99999999")
    return int(text)


def magnification(text: str) -> float:
    """A number from 0.1 to 10."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.1 <= value <= 10.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0.1 to 10")
    return value


def sample_count(text: str) -> int:
    """A whole number from 10 to a million."""
    if not (text.isascii() and text.isdecimal()) or len(text) > 7 or not 10 <= int(text) <= 1000000:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 10 to 1000000")
    return int(text)

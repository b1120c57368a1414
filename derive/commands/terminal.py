"""Plain text for terminals and pipes: one-line messages, aligned columns, JSON; exit statuses."""

from __future__ import annotations

import json
import os
import sys
import traceback
from collections.abc import Sequence
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

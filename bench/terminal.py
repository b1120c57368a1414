"""Progress, on the error stream."""

from __future__ import annotations

import sys


def say(line: str) -> None:
    """One line."""
    print(line, file=sys.stderr, flush=True)

"""How long the fewest operations are looked for.

Work that makes millions of small objects and hardly a cycle: no garbage collection meanwhile.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum

from derive.errors import DeriveError

VARIABLE = "DERIVE_EFFORT"


class Effort(StrEnum):
    """The values are equal either way; so is what they are computed from."""

    FULL = "full"
    """Formulations, the free choices in them and shared parts are searched."""

    QUICK = "quick"
    """The formulation that is cheapest as traced is emitted: searched for in no time, up to a third more operations."""


def effort_named(name: str | None = None) -> Effort:
    """An effort by name; for None that of the environment variable ``DERIVE_EFFORT``, and without one the full.

    Raises:
        DeriveError: An unknown name.
    """
    wanted = os.environ.get(VARIABLE, Effort.FULL) if name is None else name
    try:
        return Effort(wanted)
    except ValueError:
        raise DeriveError(
            f"unknown effort {wanted!r}", allowed=f"one of {', '.join(Effort)}", remedy=f"--effort or {VARIABLE}"
        ) from None


@contextmanager
def uncollected() -> Iterator[None]:
    """Collect no cycles of references inside; what is not in a cycle is freed as ever."""
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()

"""How long the fewest operations are looked for."""

from __future__ import annotations

import os
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

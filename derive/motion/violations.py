"""Where a motion exceeds what robot and plan allow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from derive.motion.hermite import Array

ROUNDING = 1e-9
"""What exceeds a limit by less, relative to it, does not exceed it."""

Bounds = Mapping[str, tuple[Array, Array]]
"""By `position`, `speed`, `acceleration`, `torque` the lowest and highest values, (n,) each, or infinite."""


@dataclass(frozen=True, slots=True)
class Violation:
    """A limit of the robot or the plan that a motion exceeds.

    Attributes:
        joint: Index of the joint.
        what: ``position``, ``speed``, ``acceleration`` or ``torque``.
        time: When it is exceeded most, at the samples [s].
        value: What it is then [rad or m, per s, per s^2, N m or N].
        limit: What is allowed.
    """

    joint: int
    what: str
    time: float
    value: float
    limit: float

    @property
    def excess(self) -> float:
        """By how much [of the same unit]."""
        return abs(self.value - self.limit)


def exceeded(times: Array, values: Mapping[str, Array], bounds: Bounds) -> tuple[Violation, ...]:
    """Each limit that is exceeded, where it is so most, joint by joint.

    Args:
        times: Of the rows [s], (rows,).
        values: What is compared, by the names of the bounds, (rows, n) each.
        bounds: What is allowed.
    """
    found = []
    for j in range(next(iter(bounds.values()))[0].size):
        for what, rows in values.items():
            low, high = (float(bound[j]) for bound in bounds[what])
            excess = np.maximum(rows[:, j] - high, low - rows[:, j])
            at = int(excess.argmax())
            value = float(rows[at, j])
            limit = high if value > high else low
            if excess[at] > ROUNDING * abs(limit):
                found.append(Violation(j, what, float(times[at]), value, limit))
    return tuple(found)

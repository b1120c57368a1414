"""The quantities of the tables by hand, but C, which needs derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from bench.byhand import recursions
from bench.byhand.axis_arm import AxisArm
from bench.byhand.symbols import Arithmetic

Rows = list[list[Any]]


def by_symbol(arm: AxisArm, system: Arithmetic, motion: Sequence[Sequence[Any]]) -> dict[str, Callable[[], Rows]]:
    """How to compute each of them, as rows.

    Args:
        arm: The robot.
        system: The arithmetic.
        motion: q, qd and qdd as scalars.
    """
    q, qd, qdd = motion
    zero = system.number(0.0)
    steps = recursions.steps_of(arm, q, system)
    found = recursions.poses(arm, steps, system)
    return {
        "tau": lambda: [[v] for v in recursions.newton_euler(arm, steps, qd, qdd, zero)],
        "B": lambda: recursions.inertia_matrix(arm, steps, zero),
        "g": lambda: [[v] for v in recursions.gravity_torques(arm, steps)],
        "T": lambda: recursions.transform(found, system),
        "J": lambda: recursions.jacobian(arm, found, zero),
    }

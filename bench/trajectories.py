"""Profiles beside those of roboticstoolbox: `python -m bench.trajectories`; exit status 1 above 1e-12.

The toolbox is asked with times in seconds, as `jtraj(q0, q1, t)`: with a number of points, `jtraj(q0, q1, 301)`, its
velocities are by unit time, and its blends lie elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from sympy import Expr, Float, Integer, Rational

from derive.arrays import Array
from derive.motion.curves.trajectory import Segment, Trajectory
from derive.plans.profile import ZERO, AnyPiece, Piece, Profile, rest_to_rest, trapezoid

MOST = 1e-12
"""Largest difference, relative to the largest value of a position, velocity or acceleration."""

START = np.array([0.3, -1.2, 2.0, 0.0])
END = np.array([1.5, 0.7, -0.4, 0.25])
START_RATES = np.array([0.1, -0.2, 0.0, 0.5])
END_RATES = np.array([-0.3, 0.4, 0.2, 0.0])

DURATION = Rational(5, 2)
POINTS = 301


def _ours(piece: Callable[[int], tuple[AnyPiece, ...]], times: Array) -> Array:
    """Position, velocity and acceleration of four joints, (3, times, 4)."""
    joints = tuple(piece(j) for j in range(START.size))
    return np.array(Trajectory((Segment("", ZERO, DURATION, joints),))(times))


def _ends(j: int) -> tuple[Expr, Expr]:
    return Float(START[j]), Float(END[j])


def _with_rates(j: int) -> tuple[AnyPiece, ...]:
    values = [(Float(q), Float(v), ZERO) for q, v in ((START[j], START_RATES[j]), (END[j], END_RATES[j]))]
    return (Piece(ZERO, DURATION, (values[0], values[1])),)


def differences(toolbox: Any) -> Mapping[str, float]:
    """How far our profiles are from those of the toolbox.

    Args:
        toolbox: The module `roboticstoolbox.tools.trajectory`, or what has its functions.

    Returns:
        The largest difference, relative, of position, velocity and acceleration, by the name of the function.
    """
    times = np.linspace(0, float(DURATION), POINTS)
    quintic = _ours(lambda j: rest_to_rest(Profile.QUINTIC, ZERO, DURATION, *_ends(j)), times)
    blended = _ours(
        lambda j: trapezoid(ZERO, DURATION, *_ends(j), Rational(3, 2) * abs(_ends(j)[1] - _ends(j)[0]) / DURATION),
        times,
    )
    corners = [float(DURATION * Integer(k) / 3) for k in (1, 2)]
    smooth = np.array([min(abs(t - corner) for corner in corners) > 1e-9 for t in times])  # accelerations jump there
    every = np.full(POINTS, True)
    scalars = [(START[j], END[j], times) for j in range(START.size)]
    made = {
        "jtraj": (toolbox.jtraj(START, END, times), quintic, every),
        "jtraj with velocities": (
            toolbox.jtraj(START, END, times, qd0=START_RATES, qd1=END_RATES),
            _ours(_with_rates, times),
            every,
        ),
        "mtraj of quintic": (toolbox.mtraj(toolbox.quintic, START, END, times), quintic, every),
        "mtraj of trapezoidal": (toolbox.mtraj(toolbox.trapezoidal, START, END, times), blended, smooth),
    }
    found = {name: _difference(np.array([t.q, t.qd, t.qdd]), ours, kept) for name, (t, ours, kept) in made.items()}
    for name, ours, kept in (("quintic", quintic, every), ("trapezoidal", blended, smooth)):
        alone = [getattr(toolbox, name)(*scalar) for scalar in scalars]
        theirs = np.array([[getattr(t, order).ravel() for t in alone] for order in ("q", "qd", "qdd")]).swapaxes(1, 2)
        found[name] = _difference(theirs, ours, kept)
    return found


def _difference(theirs: Array, ours: Array, kept: Array) -> float:
    return max(
        float(np.abs(a - b)[kept if order == 2 else slice(None)].max() / np.abs(a).max())
        for order, (a, b) in enumerate(zip(theirs, ours, strict=True))
    )


def main() -> int:
    """Print all differences.

    Returns:
        1 where one is too large; 0 also where the toolbox is not installed.
    """
    try:
        from roboticstoolbox.tools import trajectory
    except ImportError:
        print("roboticstoolbox is not installed: pip install -c constraints.txt '.[bench]'")
        return 0
    found = differences(trajectory)
    for name, difference in found.items():
        print(f"{name}: {difference:.1e}")
    return int(max(found.values()) > MOST)


if __name__ == "__main__":
    raise SystemExit(main())

"""Paths of the joints, q(s) from s = 0 to 1, and motions along them by their values at many times."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from sympy import Expr, Float

from derive.arrays import Array
from derive.motion.curves.trajectory import ONE, Corner, Trajectory
from derive.plans.hermite import MOST_PRINTED, Piece, joined, sampled, symbolic
from derive.plans.profile import ZERO
from derive.plans.segments import Joints, Segment

INTERVALS = 192  # of each segment
NOISE = 1e-9  # slope of a joint, relative to the largest of all, below which it does not move
HALVINGS = 50  # of an interval in which a joint turns back
VALUES = 3  # position, velocity and acceleration stand at both ends of each piece


def one_second(joints: Joints) -> Trajectory:
    """A path of pieces from s = 0 to 1."""
    return Trajectory((Segment("", ZERO, ONE, joints),))


UNIFORM = one_second(((Piece(ZERO, ONE, ((ZERO, ONE), (ONE, ONE))),),))  # s itself


def smooth_path(knots: Array, corners: Array) -> Trajectory:
    """The natural cubic spline through points at s from 0 to 1, (points,); between two points a straight line."""
    from scipy.interpolate import CubicSpline

    slopes = CubicSpline(knots, corners, bc_type="natural")(knots, 1)
    places = [Float(s) for s in knots]
    columns = [
        [tuple(map(Float, end)) for end in zip(*column, strict=True)]
        for column in zip(corners.T, slopes.T, strict=True)
    ]
    return one_second(tuple(joined(column, places) for column in columns))


@dataclass(frozen=True, slots=True)
class Nodes:
    """A motion by polynomials of degree five between times."""

    times: Array  # ascending from 0 [s], (nodes,)
    ends: Array  # position, velocity and acceleration at both ends of each interval, (intervals, 2, 3, n)

    def slower(self, factor: float) -> Nodes:
        """The same in more time."""
        return Nodes(self.times * factor, self.ends / factor ** np.arange(VALUES)[:, None])

    def inside(self, u: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration at the same places of each interval."""
        count, n = self.ends.shape[0], self.ends.shape[-1]
        lengths = np.repeat(np.diff(self.times), u.size)
        places = np.tile(u, count)
        found = np.empty((VALUES, count * u.size, n))
        for j in range(n):
            numbers = np.repeat(self.ends[..., j].reshape(count, 2 * VALUES), u.size, axis=0)
            for order in range(VALUES):
                found[order, :, j] = sampled(numbers, VALUES, places, lengths, order)
        q, qd, qdd = found.reshape(VALUES, count, u.size, n)
        return q, qd, qdd

    def pieces(self, first: int, last: int, exact: Mapping[int, Corner]) -> Joints:
        """The pieces of each joint between two nodes; of one that stands a single one."""
        number: Callable[[float], Expr] = Float if last - first <= MOST_PRINTED else float
        zero = number(0) if number is float else ZERO
        times = [number(t) if t else zero for t in self.times[first : last + 1]]

        def _end(node: int, end: int, j: int) -> tuple[Expr, ...]:
            q, *rates = self.ends[node - end, end, :, j]
            return (exact[node][j] if node in exact else number(q), *(number(rate) if rate else zero for rate in rates))

        def _track(j: int) -> tuple[Piece, ...]:
            if not self.ends[first:last, :, 1:, j].any():
                stands = (*map(symbolic, _end(first, 0, j)),)
                return (Piece(symbolic(times[0]), symbolic(times[-1] - times[0]), (stands, stands)),)
            pairs = ((i, i + 1) for i in range(first, last))
            values = ((_end(i, 0, j), _end(k, 1, j)) for i, k in pairs)
            return tuple(Piece(a, b - a, ends) for (a, b), ends in zip(pairwise(times), values, strict=True))

        return tuple(_track(j) for j in range(self.ends.shape[-1]))


def grid_of(path: Trajectory, knots: Array) -> Array:
    """Values of s at which a motion is computed: closer at both ends, where it is slow."""
    grid: Array = (1 - np.cos(np.linspace(0, np.pi, INTERVALS * (len(knots) - 1) + 1))) / 2
    slopes = path(grid)[1]
    slopes[:, np.abs(slopes).max(axis=0) < NOISE * np.abs(slopes).max()] = 0
    fixed = list(knots[1:-1])
    for i, j in np.argwhere(slopes[:-1] * slopes[1:] < 0):
        low, high = float(grid[i]), float(grid[i + 1])
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if path(middle)[1][j] * slopes[i, j] > 0 else (low, middle)
        if not fixed or np.abs(np.array(fixed) - low).min() > NOISE:
            fixed.append(low)
    inner = grid[1:-1]
    nearest = {int(np.abs(inner - place).argmin()) for place in fixed}
    kept = np.delete(inner, sorted(nearest))
    return np.concatenate([[0.0], np.sort(np.concatenate([kept, fixed])), [1.0]])

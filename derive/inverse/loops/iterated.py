"""Loops that no elementary equations solve: closed together, by Newton's method from the last configuration.

With phi by how much the joined frames miss each other and J_p its derivatives, x_p <- x_p - s J_p^-1 phi, where s <= 1
keeps the largest change of a step small, so that the assembly stays the one of the start. An assembly is found once, by
steps of least squares from many random configurations; others are reached from it along a straight way of variables.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from derive.inverse.loops.closing import OPEN, Array, Closing, openings, reach, refused
from derive.mechanics.floats import ArrayDomain
from derive.robot import tree
from derive.robot.description import Loop
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.names import free_symbols, limit_symbols, robot_symbols
from derive.robot.robot import Robot

STEP = 0.5  # most that a joint moves in a step [rad, or of all lengths together]
STEPS = 8  # of generated code
_STARTS = 96  # random configurations from which an assembly is looked for
_SEARCH, _FOLLOW, _LEGS = 60, 6, 16  # steps of a search, and of each leg of the way to a configuration
_DIFFERENCE = 1e-30  # of complex numbers, whose imaginary parts are derivatives
_SMALL, _SETTLED = 1e-14, 1e-8  # damping of J^T J, which must have an inverse, and the last step that matters
_RANK = 1e-7  # singular values below this part of the largest are rounding
# Positions of all joints where the loops before are closed, by those of the variables and numbers of symbols.
Before = Callable[[Sequence[Array], Mapping[str, float]], list[Array]]
# Variables, passive joints, what is missing, and singular values of J_p.
Found = tuple[Array, Array, Array, Array]


@dataclass(frozen=True, eq=False, kw_only=True)
class IteratedLoops(Closing):
    """Loops whose passive joints have no formulas."""

    robot: Robot  # its table alone
    before: Before

    def positions(self, q: Sequence[Array], values: Mapping[str, Any]) -> tuple[list[Array], Array]:
        """Of their passive joints along the way from where they are assembled, and what is missing there."""
        numbers = {name: float(x) for name, x in values.items()}
        start = self._home(numbers)
        if start is None:
            return [np.full(np.shape(q[0]), np.nan)] * len(self.passive), np.full(np.shape(q[0]), np.inf)
        ends = np.stack([np.ravel(x) for x in np.broadcast_arrays(*q)])
        at = np.broadcast_to(start[1][:, None], (len(self.passive), ends.shape[1]))
        for leg in range(1, _LEGS + 1):
            full = self.before(list(start[0][:, None] + (ends - start[0][:, None]) * (leg / _LEGS)), numbers)
            at = self._closed(full, at, numbers, _FOLLOW)
        missing = self._missing(full, at, numbers)
        return [x.reshape(np.shape(q[0])) for x in at], missing.reshape(np.shape(q[0]))

    def searched(self, numbers: Mapping[str, float]) -> Found:
        """Configurations that random ones lead to."""
        own = {*robot_symbols(self.robot), *limit_symbols(self.robot)}
        known = tuple(sorted((name, x) for name, x in numbers.items() if name in own))
        return _searched(self.robot, self.loops, self.passive, self.before, known)

    def search(self, numbers: Mapping[str, float]) -> Found:
        """The same, looked for."""
        source, way = np.random.default_rng(11), reach(self.robot, numbers)

        def _drawn(joint: Any) -> Array:
            most = math.pi if joint.is_revolute else way
            low, high = (to_float(x, numbers) for x in joint.limits) if joint.limits else (-most, most)
            return source.uniform(low, high, _STARTS)

        q = np.stack([_drawn(variable) for variable in self.robot.variables])
        at = np.stack([_drawn(self.robot.joints[k]) for k in self.passive])
        full = self.before(list(q), numbers)
        at = self._closed(full, at, numbers, _SEARCH)
        _, matrix = self._linear(full, at, numbers)
        return q, at, self._missing(full, at, numbers), np.linalg.svd(np.nan_to_num(matrix), compute_uv=False)

    def _home(self, numbers: Mapping[str, float]) -> tuple[Array, Array] | None:
        """Variables and passive joints of an assembly far from dead points, within their limits if there is one."""
        q, at, missing, singular = self.searched(numbers)
        inside, at = np.ones(len(missing), dtype=bool), at.copy()
        for k, x in zip(self.passive, at, strict=True):
            joint = self.robot.joints[k]
            if joint.is_revolute:
                x[:] = np.arctan2(np.sin(x), np.cos(x))
            if joint.limits:
                low, high = (to_float(limit, numbers) for limit in joint.limits)
                inside &= (low <= x) & (x <= high)
        far = np.where(missing < OPEN, singular[:, -1] + inside * singular.max(), -1.0)
        best = int(np.argmax(far))
        return (q[:, best], at[:, best]) if far[best] > 0 else None

    def _closed(self, full: list[Array], at: Array, numbers: Mapping[str, float], steps: int) -> Array:
        """Positions of the passive joints after some damped steps of least squares."""
        unit = np.array([1.0 if self.robot.joints[k].is_revolute else reach(self.robot, numbers) for k in self.passive])
        at, left = at.copy(), np.arange(at.shape[1])
        for _ in range(steps):
            values, matrix = self._linear([x[left] for x in full], at[:, left], numbers)
            matrix = np.nan_to_num(matrix * unit)
            square = np.swapaxes(matrix, -1, -2) @ matrix
            square += _SMALL * (1.0 + np.trace(square, axis1=-2, axis2=-1))[:, None, None] * np.eye(len(unit))
            right = np.swapaxes(matrix, -1, -2) @ np.nan_to_num(values)[..., None]
            change = np.linalg.solve(square, right)[..., 0]
            most = np.abs(change).max(axis=-1)
            at[:, left] -= (change / np.maximum(most / STEP, 1.0)[:, None] * unit).T
            left = left[most > _SETTLED]  # the next step is shorter than rounding
            if not left.size:
                break
        return at

    def _linear(self, full: list[Array], at: Array, numbers: Mapping[str, float]) -> tuple[Array, Array]:
        """phi, (configurations, rows), and J_p, (configurations, rows, passive)."""
        moved = at[:, None, :] + 1j * _DIFFERENCE * np.eye(len(at))[:, :, None]
        rows, _ = openings(self.robot, self, ArrayDomain(self.robot, self._placed(full, moved), numbers))
        found = np.stack([np.broadcast_to(row, moved.shape[1:]).astype(complex) for row in rows], axis=-1)
        return found[0].real, np.moveaxis(found.imag, 0, -1) / _DIFFERENCE

    def _missing(self, full: list[Array], at: Array, numbers: Mapping[str, float]) -> Array:
        _, misses = openings(self.robot, self, ArrayDomain(self.robot, self._placed(full, at), numbers))
        found = np.max([np.broadcast_to(np.abs(miss), at.shape[1]) for miss in misses], axis=0)
        return np.asarray(np.nan_to_num(found, nan=np.inf))

    def _placed(self, full: list[Array], at: Sequence[Array] | Array) -> list[Array]:
        known = dict(zip(self.passive, at, strict=True))
        return [known.get(k, x) for k, x in enumerate(full)]


@lru_cache(64)
def _searched(
    robot: Robot,
    loops: tuple[Loop, ...],
    passive: tuple[int, ...],
    before: Before,
    numbers: tuple[tuple[str, float], ...],
) -> Found:
    return IteratedLoops(loops=loops, passive=passive, robot=robot, before=before).search(dict(numbers))


def iterated(robot: Robot, loops: Sequence[Loop], known: Sequence[int], before: Before) -> IteratedLoops | None:
    """Loops that determine their passive joints together, besides those that are known; None where they do not."""
    around = {k for loop in loops for way in tree.around(robot, loop) for k in way if robot.joints[k].follows}
    passive = tuple(sorted(around - {*known}))
    one = IteratedLoops(loops=tuple(loops), passive=passive, robot=robot, before=before)
    source = np.random.default_rng(5)
    numbers = parameter_values(robot, {name: source.uniform(0.2, 1.0) for name in free_symbols(robot)})
    _, _, missing, singular = one.searched({name: float(x) for name, x in numbers.items()})
    near = missing <= max(OPEN, float(missing.min()))
    rank = (singular[near] > _RANK * singular[near].max(axis=-1, keepdims=True)).sum(axis=-1)
    if np.median(rank) < len(passive):
        return None
    for loop in loops:
        if loop.branch:
            found, remedy = f"branch of loops that are solved numerically: {loop.branch}", "leave branch out"
            raise refused(robot, loop, found, "allowed: none", f"{remedy}, and give passive joints limits")
    return one

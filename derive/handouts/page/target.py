"""The target of the page's figure: a place for the end effector that the reader drags, and the arm follows.

What is dragged is chosen so that the arm can follow: the position with the orientation kept, where that moves in space
or, of a planar arm, in its plane; else the position alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import mpmath
import numpy as np
import sympy

from derive.arrays import Array
from derive.inverse.numeric.in_numbers import ArrayDomain, Numbers
from derive.mechanics.chain import build_chain
from derive.mechanics.forward_kinematics import jacobian
from derive.robot.options.inverse import POSE, InverseOptions
from derive.robot.robot import Robot

_SMALL = 1e-7  # singular values below it, of a matrix whose largest one is 1, are zero


@dataclass(frozen=True, slots=True)
class Dragging:
    """What of an arm's end effector is dragged."""

    task: InverseOptions  # what the inverse kinematics is asked for
    # The direction in which the target cannot go; None where it goes anywhere in space.
    normal: tuple[float, float, float] | None


def dragging(robot: Robot, numbers: Mapping[str, float]) -> Dragging | None:
    """How an end effector can be dragged; None where it moves neither in a plane nor in space. Numbers in m and rad."""
    # The Jacobian at five generic configurations: ranks that all of them agree on are those of the arm.
    columns = [_jacobian(robot, numbers, q) for q in np.random.default_rng(7).uniform(0.2, 1.3, (robot.n, 5)).T]
    linear = np.hstack([own[:3] for own in columns])
    kept = min(_rank(own) - _rank(own[3:]) for own in columns)  # directions with the orientation kept
    directions = _rank(linear)
    if directions < 2:
        return None
    normal = None if directions == 3 else _normal(linear)
    if robot.inverse != InverseOptions():
        axes = [axis for axis in "xyz" if axis in robot.inverse.task]
        if len(axes) < 2:
            return None
        missing = next((k for k, axis in enumerate("xyz") if axis not in axes), None)
        x, y, z = (float(k == missing) for k in range(3))
        return Dragging(robot.inverse, normal if missing is None else (x, y, z))
    if kept == directions:
        return Dragging(InverseOptions(POSE), normal)
    if min(_rank(own[:3]) for own in columns) < directions:
        return None
    if normal is None:
        return Dragging(InverseOptions(("x", "y", "z")), None)
    left_out = int(np.argmax(np.abs(normal)))
    return Dragging(InverseOptions(tuple(axis for k, axis in enumerate("xyz") if k != left_out)), normal)


def _jacobian(robot: Robot, numbers: Mapping[str, float], q: Array) -> Array:
    """(6, n), lengths in parts of the largest one."""
    bare = replace(robot, links=(), gravity=None)
    known: Numbers = {sympy.Symbol(name): mpmath.mpf(value) for name, value in numbers.items()}
    rows = np.array(jacobian(build_chain(bare, ArrayDomain(bare, list(q), known))), dtype=float)
    rows[:3] /= float(np.abs(rows[:3]).max()) or 1.0
    return rows


def _rank(matrix: Array) -> int:
    return int(np.linalg.matrix_rank(matrix, tol=_SMALL * max(1.0, float(np.abs(matrix).max(initial=0.0)))))


def _normal(columns: Array) -> tuple[float, float, float]:
    """What is normal to all columns, which lie in a plane; its largest component is positive."""
    normal = np.linalg.svd(columns)[0][:, 2]
    sign = 1.0 if max(normal, key=abs) > 0 else -1.0
    x, y, z = (0.0 if abs(part) < _SMALL else float(sign * part) for part in normal)  # without what rounding left
    return x, y, z

"""Where the frames of a robot are, in numbers, for figures: symbols without a number get a length or an angle to draw.

The chain is that of the mechanics over floats, or over NumPy arrays for many configurations at once.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from derive.errors import DeriveError, ExpressionError
from derive.handout.context import Pose
from derive.mechanics.chain import Chain, ChainJoint, build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.joint_motion import advance
from derive.mechanics.vectors import Frame
from derive.robot.description import Joint
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import Call, Expression, children, names
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

ASSUMED_ANGLE = math.pi / 6
"""Drawn for an angle without a number [rad]."""

PATTERNS = ((1.0, 0.8, 0.6, 0.9, 0.7, 0.5), (1.0, 0.5, 1.3, 0.3, 1.6, 0.2), (0.9, 0.4, 0.5, 0.2, 0.15, 0.1))
"""Lengths for symbols without a number, in units of the longest known one; the next row if a cell has no value."""

_TRIGONOMETRIC = frozenset({"sin", "cos", "tan"})


class RobotPoses:
    """Frames of a robot at any configuration.

    Args:
        robot: The robot; its dynamics is not looked at.

    Raises:
        DeriveError: No numbers were found for which every cell of the table has a value.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = replace(robot, links=(), gravity=None)
        self._assumed, self._values = _choose(self.robot, robot.figure.values)

    @property
    def zero(self) -> tuple[float, ...]:
        """The zero configuration [rad or m]."""
        return (0.0,) * self.robot.n

    @property
    def configuration(self) -> tuple[float, ...] | None:
        """The configuration that the robot file asks to draw [rad or m]."""
        q = self.robot.figure.q
        return None if q is None else self.numbers(q)

    def numbers(self, cells: Sequence[Expression]) -> tuple[float, ...]:
        """The values of cells with the numbers of the drawing.

        Raises:
            ExpressionError: A value does not exist.
        """
        return tuple(to_float(cell, self._values) for cell in cells)

    @property
    def assumed(self) -> tuple[tuple[str, float, str], ...]:
        """Symbols drawn with a number that no file gives: name, value and unit (``m`` or ``rad``)."""
        angles = _angle_names(self.robot)
        return tuple((name, value, "rad" if name in angles else "m") for name, value in self._assumed)

    @property
    def limits(self) -> tuple[tuple[float, float] | None, ...]:
        """Lower and upper limit of every joint [rad or m], None where the file gives none."""
        return tuple(self._bounds(joint) for joint in self.robot.joints)

    def _bounds(self, joint: Joint) -> tuple[float, float] | None:
        if joint.limits is None:
            return None
        values = {**self._values, **{name: 1.0 for cell in joint.limits for name in names(cell)}, **self._values}
        lower, upper = (to_float(cell, values) for cell in joint.limits)
        return lower, upper

    def frames(self, q: Sequence[float]) -> tuple[Pose, ...]:
        """Base frame 0, frames 1 to n and the end effector in the world: n + 2 transforms 4x4 [m].

        Args:
            q: Joint positions [rad or m].
        """
        return tuple(_pose(frame) for frame in self._frames(self._joints(q, math.cos, math.sin)))

    def positions(self, q: Any) -> Any:
        """Positions of the end effector in the world: (3, samples) for joint positions (n, samples), [m]."""
        import numpy as np

        *_, end = self._frames(self._joints(q, np.cos, np.sin))
        return np.stack([np.broadcast_to(value, q.shape[1:]) for value in end.position])

    @property
    def first_axis(self) -> tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]:
        """Rotation and origin in the world of the frame in which joint 1 moves about (along) z."""
        frame = self._chain.base @ self._chain.joints[0].fixed
        return frame.rotation, frame.position

    @property
    def longest(self) -> float:
        """The longest length of the table [m], 1 m if there is none."""
        return _longest(self.robot, self._values)

    def _joints(self, q: Any, cosine: Any, sine: Any) -> Iterator[ChainJoint[Any]]:
        for value, row, joint in zip(q, self._chain.joints, self.robot.joints, strict=True):
            if joint.is_revolute:
                angle = joint.sign * value + to_float(joint.theta, self._values)
                yield replace(row, cosine=cosine(angle), sine=sine(angle))
            else:
                yield replace(row, offset=joint.sign * value + to_float(joint.d, self._values))

    def _frames(self, joints: Iterable[ChainJoint[Any]]) -> Iterator[Frame[Any]]:
        chain = self._chain
        yield chain.base
        frame = chain.base
        for joint, end in zip(joints, chain.ends, strict=True):
            frame = advance(frame, joint)
            yield frame @ end
        yield frame @ chain.tool

    @cached_property
    def _chain(self) -> Chain[Any]:
        return _chain(self.robot, self._values)


def _chain(robot: Robot, values: Mapping[str, Fraction | float]) -> Chain[Any]:
    domain = FloatDomain(robot, (0.0,) * robot.n)
    domain.values = dict(values)
    return build_chain(robot, domain)


def _pose(frame: Frame[float]) -> Pose:
    rows = (tuple(map(float, (*row, x))) for row, x in zip(frame.rotation, frame.position, strict=True))
    return (*rows, (0.0, 0.0, 0.0, 1.0))


def _choose(
    robot: Robot, chosen: Sequence[tuple[str, Expression]]
) -> tuple[tuple[tuple[str, float], ...], Mapping[str, Fraction | float]]:
    """The numbers assumed, and the numbers of all symbols."""
    known = parameter_values(robot)
    known |= {name: to_float(value, known) for name, value in chosen}
    missing = [name for name in robot_symbols(robot) if name not in known]
    for pattern in PATTERNS:
        assumed = tuple(_assume(robot, missing, known, pattern))
        values = {**known, **dict(assumed)}
        try:
            _chain(robot, values)
        except (ExpressionError, ArithmeticError):
            continue
        return assumed, values
    raise DeriveError(
        f"no lengths were found with which {robot.name} can be drawn",
        remedy="give its symbols numbers, under parameters: or figure: values:",
    )


def _assume(
    robot: Robot, missing: Sequence[str], known: Mapping[str, Fraction | float], pattern: Sequence[float]
) -> Iterator[tuple[str, float]]:
    angles = _angle_names(robot)
    unit = _longest(robot, known)
    lengths = 0
    for name in missing:
        if name in angles:
            yield name, ASSUMED_ANGLE
        else:
            yield name, float(f"{unit * pattern[lengths % len(pattern)]:.1g}")
            lengths += 1


def _longest(robot: Robot, known: Mapping[str, Fraction | float]) -> float:
    """The longest length in the table that has a number; 1 m without any."""
    found = [0.0]
    for joint in robot.joints:
        for cell in (joint.d, joint.a):
            if all(name in known for name in names(cell)):
                found.append(abs(to_float(cell, known)))
    return max(found) or 1.0


def _angle_names(robot: Robot) -> set[str]:
    cells = [cell for joint in robot.joints for cell in (joint.theta, joint.alpha)]
    found = {name for cell in cells for name in names(cell)}
    pending = [
        *(cell for matrix in (robot.base, robot.tool) for row in matrix for cell in row),
        *(cell for joint in robot.joints for cell in (joint.d, joint.a)),
    ]
    while pending:
        node = pending.pop()
        if isinstance(node, Call) and node.function in _TRIGONOMETRIC:
            found |= set(names(node))
        pending += children(node)
    return found

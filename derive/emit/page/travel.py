"""Numbers that the figure needs: where each joint can go and starts, where the base stands, and where up is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, names
from derive.robot.names import number_of
from derive.robot.robot import Joint, Robot

_FALLBACK = 1.0
"""Drawn for a symbol of which nothing is known."""


@dataclass(frozen=True, slots=True)
class Travel:
    """The way of a joint.

    Attributes:
        revolute: Whether it turns.
        lower: Lowest value [rad or m].
        upper: Highest value [rad or m].
        start: Value at first [rad or m].
    """

    revolute: bool
    lower: float
    upper: float
    start: float

    def shown(self, value: float) -> float:
        """A value in the unit of the slider: degrees or metres."""
        return math.degrees(value) if self.revolute else value


def symbol_values(robot: Robot, parameters: Sequence[str], values: Mapping[str, float]) -> dict[str, float]:
    """A number for every symbol: the caller's, else the robot file's, else 1."""
    known = {name: evaluate(number, {}) for name, number in number_of(robot).items()}
    return dict.fromkeys((*_kinematic_names(robot), *parameters), _FALLBACK) | known | dict(values)


def travels(robot: Robot, numbers: Mapping[str, float], start: Sequence[float] | None) -> tuple[Travel, ...]:
    """The way of every joint: its limits where they are numbers in order, else a turn, or the longest link."""
    ranges = [_range(robot, joint, numbers) for joint in robot.joints]
    if start is None and robot.figure.q is not None:
        start = [evaluate(value, numbers) for value in robot.figure.q]
    return tuple(
        Travel(joint.is_revolute, low, high, _start(joint, low, high, None if start is None else start[i]))
        for i, (joint, (low, high)) in enumerate(zip(robot.joints, ranges, strict=True))
    )


def base_pose(robot: Robot, numbers: Mapping[str, float]) -> list[list[float]]:
    """The base frame in the world."""
    return [[evaluate(entry, numbers) for entry in row] for row in robot.base]


def upwards(robot: Robot, numbers: Mapping[str, float]) -> list[float]:
    """Against gravity; along z of the world where there is none."""
    pull = [evaluate(entry, numbers) for entry in robot.gravity or ()]
    size = math.hypot(*pull)
    return [-entry / size for entry in pull] if size > 0 else [0.0, 0.0, 1.0]


def _kinematic_names(robot: Robot) -> list[str]:
    cells = [cell for joint in robot.joints for cell in (joint.theta, joint.d, joint.a, joint.alpha)]
    cells += [cell for matrix in (robot.base, robot.tool) for row in matrix for cell in row]
    cells += [*(robot.gravity or ()), *(limit for joint in robot.joints for limit in joint.limits or ())]
    return [name for cell in cells for name in names(cell)]


def _range(robot: Robot, joint: Joint, numbers: Mapping[str, float]) -> tuple[float, float]:
    limits = joint.limits and _numbers(joint.limits, numbers)
    if limits and limits[0] < limits[1]:
        return limits
    return (-math.pi, math.pi) if joint.is_revolute else (0.0, _longest(robot, numbers))


def _numbers(limits: tuple[Expression, Expression], numbers: Mapping[str, float]) -> tuple[float, float] | None:
    try:
        return evaluate(limits[0], numbers), evaluate(limits[1], numbers)
    except ArithmeticError:
        return None


def _longest(robot: Robot, numbers: Mapping[str, float]) -> float:
    """The longest offset or link of the table [m]; 1 m if all are zero."""
    lengths = [abs(evaluate(cell, numbers)) for joint in robot.joints for cell in (joint.a, joint.d)]
    return float(f"{max(lengths) or 1.0:.2g}")


def _start(joint: Joint, low: float, high: float, wanted: float | None) -> float:
    if wanted is None:
        wanted = 0.0 if joint.is_revolute else (low + high) / 2
    return min(max(wanted, low), high)

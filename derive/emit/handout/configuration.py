"""The configuration of the example: that of the figure, or a generic one within the limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, Number, Pi, Product
from derive.robot.names import robot_symbols
from derive.robot.robot import Joint, Robot

ANGLES = (1, 2, -1, 3, -2, 4)
"""Joint angles in sixths of pi, and again from the first: generic, so that few entries vanish."""

OFFSET = Number(Fraction(1, 10))
"""Displacement of prismatic joints [m]."""


@dataclass(frozen=True, slots=True)
class Configuration:
    """Values of the joint variables.

    Attributes:
        cells: Exact.
        q: In floats [rad or m].
        stated: Whether the robot file gives them.
    """

    cells: tuple[Expression, ...]
    q: tuple[float, ...]
    stated: bool


def numbers_of(robot: Robot) -> dict[str, float]:
    """Every symbol that has a number, from the parameters or for the figure."""
    found: dict[str, float] = {}
    for name, value in (*robot.parameters, *robot.figure.values):
        if name not in found:
            found[name] = evaluate(value, found)
    return found


def unnumbered(robot: Robot) -> tuple[str, ...]:
    """Symbols of a robot without any number."""
    known = {name for name, _ in (*robot.parameters, *robot.figure.values)}
    return tuple(name for name in robot_symbols(robot) if name not in known)


def configuration(robot: Robot) -> Configuration:
    """Where the example is evaluated."""
    values = numbers_of(robot)
    if robot.figure.q is not None:
        cells = robot.figure.q
    else:
        cells = tuple(_within(joint, _generic(joint, i), values) for i, joint in enumerate(robot.joints))
    q = tuple(evaluate(cell, values) for cell in cells)
    return Configuration(cells, q, robot.figure.q is not None)


def _generic(joint: Joint, index: int) -> Expression:
    if not joint.is_revolute:
        return OFFSET
    return Product((Number(Fraction(ANGLES[index % len(ANGLES)], 6)), Pi()))


def _within(joint: Joint, cell: Expression, values: Mapping[str, float]) -> Expression:
    """The value, or the limit that it exceeds; limits in symbols without numbers do not count."""
    if joint.limits is None:
        return cell
    try:
        lower, upper = (evaluate(limit, values) for limit in joint.limits)
    except (ArithmeticError, KeyError):
        return cell
    value = evaluate(cell, values)
    if value < lower and not math.isclose(value, lower):
        return joint.limits[0]
    if value > upper and not math.isclose(value, upper):
        return joint.limits[1]
    return cell

"""Names of velocities and accelerations, labels of joints, and the symbols of a robot."""

from __future__ import annotations

import re
from collections.abc import Iterator

from derive.robot.description import Description, Joint, Link, Matrix
from derive.robot.expression import Expression, names

_STEM_AND_DIGITS = re.compile(r"(.*?)([0-9]*)")


def velocity_name(variable: str) -> str:
    """Name of the velocity of a joint variable: ``q1`` -> ``qd1``, ``theta`` -> ``thetad``."""
    return _with_dots(variable, 1)


def acceleration_name(variable: str) -> str:
    """Name of the acceleration of a joint variable: ``q1`` -> ``qdd1``, ``d3`` -> ``ddd3``."""
    return _with_dots(variable, 2)


def joint_label(variable: str) -> str:
    """The digits at the end of a joint variable's name, empty if there are none: ``q12`` -> ``12``."""
    return _split(variable)[1]


def robot_symbols(robot: Description) -> tuple[str, ...]:
    """Parameters of kinematics and dynamics, in order of first appearance.

    The order is base, joint rows (theta, d, a, alpha), tool, gravity, links. Joint variables are not parameters, and
    limits enter no quantity.
    """
    variables = {joint.variable for joint in robot.joints}
    found = dict.fromkeys(name for expression in expressions(robot) for name in names(expression))
    return tuple(name for name in found if name not in variables)


def limit_symbols(robot: Description) -> tuple[str, ...]:
    """Symbols in the limits of joints, in order of first appearance."""
    limits = [limit for joint in robot.joints for limit in joint.limits or ()]
    return tuple(dict.fromkeys(name for limit in limits for name in names(limit)))


def number_of(robot: Description) -> dict[str, Expression]:
    """The exact numbers that the file gives to symbols."""
    return dict(robot.parameters)


def free_symbols(robot: Description) -> tuple[str, ...]:
    """Symbols that stay arguments of generated code: without a number, or named in ``runtime``."""
    baked = number_of(robot).keys() - set(robot.runtime)
    return tuple(name for name in robot_symbols(robot) if name not in baked)


def expressions(robot: Description) -> Iterator[Expression]:
    """Every expression that enters a quantity, in the order of `robot_symbols`."""
    yield from _entries(robot.base)
    for joint in robot.joints:
        yield from _cells(joint)
    yield from _entries(robot.tool)
    yield from robot.gravity or ()
    for link in robot.links:
        yield from _inertial(link)


def _with_dots(variable: str, order: int) -> str:
    stem, digits = _split(variable)
    return stem + "d" * order + digits


def _split(variable: str) -> tuple[str, str]:
    match = _STEM_AND_DIGITS.fullmatch(variable)
    return (match.group(1), match.group(2)) if match else (variable, "")


def _entries(matrix: Matrix) -> Iterator[Expression]:
    for row in matrix:
        yield from row


def _cells(joint: Joint) -> Iterator[Expression]:
    yield from (joint.theta, joint.d, joint.a, joint.alpha)


def _inertial(link: Link) -> Iterator[Expression]:
    inertia = link.inertia
    yield link.mass
    yield from link.com
    yield from (inertia.xx, inertia.yy, inertia.zz, inertia.xy, inertia.xz, inertia.yz)
    if link.motor is not None:
        yield from (link.motor.mass, link.motor.inertia, link.motor.ratio)
    yield from (link.armature, link.viscous, link.coulomb)

"""What the generators of a robot's ring stand for, and which expressions of a robot they must be able to hold."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from derive.robot.expression import Expression, Number, Product
from derive.robot.robot import Robot


class Kind(Enum):
    """What a generator stands for."""

    INVERSE = "inverse"
    ROOT = "root"
    PRIME_ROOT = "prime root"
    SINE = "sine of a joint angle"
    COSINE = "cosine of a joint angle"
    CONSTANT_SINE = "sine of a constant angle"
    CONSTANT_COSINE = "cosine of a constant angle"
    VARIABLE = "prismatic variable"
    ACCELERATION = "acceleration"
    RATE = "rate"
    PARAMETER = "parameter"
    PI = "pi"


@dataclass(frozen=True, slots=True)
class Generator:
    """One generator of the ring.

    Attributes:
        kind: What it stands for.
        name: Unique name in the ring.
        argument: The expression that it is a function of (the symbol itself for names).
        joint: Index of the joint it belongs to, or -1.
    """

    kind: Kind
    name: str
    argument: Expression
    joint: int = -1


def robot_values(robot: Robot) -> Iterator[Expression]:
    """Every cell of the robot that is not an angle."""
    for joint in robot.joints:
        yield joint.a
        yield joint.d
    for matrix in (robot.base, robot.tool):
        yield from (cell for row in matrix for cell in row)
    yield from robot.gravity or ()
    for link in robot.links:
        tensor = link.inertia
        yield from (link.mass, *link.com, link.armature, link.viscous, link.coulomb)
        yield from (tensor.xx, tensor.yy, tensor.zz, tensor.xy, tensor.xz, tensor.yz)
        if link.motor is not None:
            yield from (link.motor.mass, link.motor.inertia, link.motor.ratio)


def robot_angles(robot: Robot) -> Iterator[Expression]:
    """Every constant angle of the table."""
    for joint in robot.joints:
        yield joint.theta
        yield joint.alpha


def scaled(unit: Expression, k: Fraction) -> Expression:
    """k * unit, in the form in which it names a generator."""
    return unit if k == 1 else Product((Number(k), unit))

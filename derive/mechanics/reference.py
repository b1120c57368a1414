"""The Jacobian for another point of the last link, and in the axes of another frame.

Moving the point adds multiples of the angular rows to the linear ones, and turning the axes turns both: neither
changes the rank of J, nor the determinant of all six rows. In the middle of the arm the entries are shortest
(Siciliano et al., Robotics, sec. 3.3).
"""

from __future__ import annotations

from dataclasses import dataclass

from derive.algebra.ring import Polynomial
from derive.mechanics.kinematics import Kinematics, PolynomialFrame, PolynomialVector
from derive.mechanics.vectors import add, column, cross, multiply, scale, subtract
from derive.robot.robot import Convention

Column = tuple[Polynomial, ...]
"""Linear velocity, then angular velocity, per unit of one rate."""


@dataclass(frozen=True, slots=True)
class Reference:
    """Where a Jacobian is taken.

    Attributes:
        frame: DH frame in whose axes it is, None for the world.
        point: DH frame whose origin is the point of the last link, None for the end effector.
    """

    frame: int | None = None
    point: int | None = None


def jacobian_columns(kinematics: Kinematics, reference: Reference) -> list[Column]:
    """The six entries of every column of J."""
    robot = kinematics.robot
    point = _point(kinematics, reference)
    still = (kinematics.chain.zero,) * 3
    columns: list[Column] = []
    for index, joint in enumerate(robot.joints):
        at = _frame(kinematics, reference.frame, index + (robot.convention is Convention.MODIFIED))
        axis: PolynomialVector = scale(joint.sign, column(at.rotation, 2))
        linear = cross(axis, subtract(point, at.position)) if joint.is_revolute else axis
        columns.append((*linear, *(axis if joint.is_revolute else still)))
    return columns


def _frame(kinematics: Kinematics, seen_from: int | None, i: int) -> PolynomialFrame:
    return kinematics.frame(i) if seen_from is None else kinematics.transform(seen_from, i)


def _point(kinematics: Kinematics, reference: Reference) -> PolynomialVector:
    if reference.point is not None:
        return _frame(kinematics, reference.frame, reference.point).position
    if reference.frame is None:
        return kinematics.end.position
    last = kinematics.transform(reference.frame, kinematics.robot.n)
    tool = kinematics.robot.tool
    return add(last.position, multiply(last.rotation, kinematics.vector((tool[0][3], tool[1][3], tool[2][3]))))

"""A robot at a configuration in floats, as scalars of the mechanics."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

from derive.robot.description import Joint
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import Expression
from derive.robot.robot import Robot


class FloatDomain:
    """Cells of a robot whose parameters all have numbers, at joint positions.

    Args:
        robot: The robot.
        q: Joint variables [rad or m], n entries.
    """

    def __init__(self, robot: Robot, q: Sequence[float]) -> None:
        self.q = q
        self.values = parameter_values(robot)

    def number(self, value: int | Fraction) -> float:
        """A rational as a float.

        Args:
            value: The number.
        """
        return float(value)

    def constant(self, expression: Expression) -> float:
        """The value of a cell.

        Args:
            expression: The cell.

        Raises:
            ExpressionError: A symbol has no number, or the value is not finite.
        """
        return to_float(expression, self.values)

    def cosine_sine(self, angle: Expression) -> tuple[float, float]:
        """Cosine and sine of a constant angle.

        Args:
            angle: The angle [rad].
        """
        value = self.constant(angle)
        return math.cos(value), math.sin(value)

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[float, float]:
        """Cosine and sine of the angle of a revolute joint.

        Args:
            index: Number of the joint, from 0.
            joint: Its row of the table.
        """
        value = joint.sign * self.q[index] + self.constant(joint.theta)
        return math.cos(value), math.sin(value)

    def joint_offset(self, index: int, joint: Joint) -> float:
        """Displacement of a prismatic joint along its axis [m].

        Args:
            index: Number of the joint, from 0.
            joint: Its row of the table.
        """
        return joint.sign * self.q[index] + self.constant(joint.d)

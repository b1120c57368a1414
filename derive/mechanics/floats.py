"""A robot at a configuration in floats, as scalars of the mechanics."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from derive.mechanics.chain import build_chain
from derive.mechanics.energy import gravity_vector, inertia_matrix
from derive.mechanics.forward_kinematics import forward_kinematics, jacobian
from derive.robot.description import Joint
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import Expression
from derive.robot.robot import Robot


class FloatDomain:
    """Cells at joint positions q [rad or m], n entries, by numbers of parameters, None for the robot file's."""

    functions: tuple[Any, Any, Any] = (math.cos, math.sin, float)  # the last one makes numbers

    def __init__(self, robot: Robot, q: Sequence[Any], values: Mapping[str, Fraction | float] | None = None) -> None:
        self.q = q
        self.values = parameter_values(robot) if values is None else dict(values)

    def number(self, value: int | Fraction) -> float:
        """A rational as a float."""
        return float(value)

    def constant(self, expression: Expression) -> float:
        """The value of a cell."""
        return to_float(expression, self.values)

    def cosine_sine(self, angle: Expression) -> tuple[float, float]:
        """Cosine and sine of a constant angle."""
        value = self.constant(angle)
        return math.cos(value), math.sin(value)

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[Any, Any]:
        """Cosine and sine of the angle of a revolute joint."""
        cosine, sine, _ = self.functions
        value = joint.sign * self.q[index] + self.constant(joint.theta)
        return cosine(value), sine(value)

    def joint_offset(self, index: int, joint: Joint) -> float:
        """Displacement of a prismatic joint along its axis [m]."""
        offset: float = joint.sign * self.q[index] + self.constant(joint.d)
        return offset


class ArrayDomain(FloatDomain):
    """The same at many configurations at once: for each joint an array of its variables [rad or m]."""

    functions = (np.cos, np.sin, float)


def value_at(robot: Robot, name: Literal["T", "J", "B", "g"], q: Sequence[float]) -> Sequence[Sequence[float]]:
    """T, J, B or g at a configuration q [rad or m], n entries, by the recursions of the generated functions."""
    known = {symbol for symbol, _ in robot.parameters}
    further = tuple((symbol, value) for symbol, value in robot.figure.values if symbol not in known)
    robot = replace(robot, parameters=robot.parameters + further)
    if name in ("T", "J"):
        robot = replace(robot, links=(), gravity=None)
    chain = build_chain(robot, FloatDomain(robot, q))
    match name:
        case "T":
            return forward_kinematics(chain).rows(chain.zero, chain.one)
        case "J":
            return jacobian(chain)
        case "B":
            return inertia_matrix(chain)
        case "g":
            return [[torque] for torque in gravity_vector(chain)]

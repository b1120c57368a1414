"""A robot as plain numbers: the DH table, the frames around it and the inertial parameters as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from derive.robot.description import Convention, Link, Motor
from derive.robot.evaluate import Values, parameter_values, to_float
from derive.robot.expression import ZERO, Expression
from derive.robot.robot import Robot

Array = npt.NDArray[Any]


@dataclass(frozen=True, slots=True, eq=False)
class Arm:
    """The numbers of one arm with n joints.

    Attributes:
        standard: Whether the table follows the standard convention, not the modified one.
        revolute: (n,) whether joint i turns.
        sign: (n,) factor of the variable in its cell, +1 or -1.
        theta: (n,) constant part of the angle [rad].
        d: (n,) constant part of the offset along z [m].
        a: (n,) link length [m].
        alpha: (n,) link twist [rad].
        base: (4, 4) world to frame 0.
        tool: (4, 4) frame n to the end effector.
        gravity: (3,) acceleration of gravity in the world frame [m/s^2].
        mass: (n,) link masses [kg].
        com: (n, 3) centres of mass in the links' DH frames [m].
        inertia: (n, 3, 3) tensors about the centres of mass, axes of the links' DH frames [kg m^2].
        rotor_mass: (n,) rotor masses [kg].
        rotor_inertia: (n,) rotor inertias about the spin axes [kg m^2].
        ratio: (n,) gear ratios.
        armature: (n,) reflected inertias, on the diagonal of B only.
        viscous: (n,) joint-side viscous friction.
        coulomb: (n,) joint-side Coulomb friction.
    """

    standard: bool
    revolute: Array
    sign: Array
    theta: Array
    d: Array
    a: Array
    alpha: Array
    base: Array
    tool: Array
    gravity: Array
    mass: Array
    com: Array
    inertia: Array
    rotor_mass: Array
    rotor_inertia: Array
    ratio: Array
    armature: Array
    viscous: Array
    coulomb: Array

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.sign)

    @property
    def gravity_in_frame_0(self) -> Array:
        """Acceleration of gravity in the axes of frame 0, R_base^T g [m/s^2]."""
        gravity: Array = self.base[:3, :3].T @ self.gravity
        return gravity


def numeric_arm(robot: Robot, chosen: Mapping[str, float] | None = None) -> Arm:
    """The numbers of a robot.

    Args:
        robot: The robot.
        chosen: A number for every symbol that has none in the file; it may override those of the file.

    Returns:
        The arm.

    Raises:
        ExpressionError: A symbol has no number, or a cell has no finite value.
    """
    values = parameter_values(robot, chosen)
    joints, links = robot.joints, robot.links or (Link(),) * robot.n
    motors = [link.motor or Motor() for link in links]
    tensors = [link.inertia for link in links]
    return Arm(
        standard=robot.convention is Convention.STANDARD,
        revolute=np.array([joint.is_revolute for joint in joints]),
        sign=np.array([float(joint.sign) for joint in joints]),
        theta=_numbers([joint.theta for joint in joints], values),
        d=_numbers([joint.d for joint in joints], values),
        a=_numbers([joint.a for joint in joints], values),
        alpha=_numbers([joint.alpha for joint in joints], values),
        base=np.array([_numbers(row, values) for row in robot.base]),
        tool=np.array([_numbers(row, values) for row in robot.tool]),
        gravity=_numbers(robot.gravity or (ZERO, ZERO, ZERO), values),
        mass=_numbers([link.mass for link in links], values),
        com=np.array([_numbers(link.com, values) for link in links]),
        inertia=np.array(
            [
                [_numbers(row, values) for row in ((t.xx, t.xy, t.xz), (t.xy, t.yy, t.yz), (t.xz, t.yz, t.zz))]
                for t in tensors
            ]
        ),
        rotor_mass=_numbers([motor.mass for motor in motors], values),
        rotor_inertia=_numbers([motor.inertia for motor in motors], values),
        ratio=_numbers([motor.ratio for motor in motors], values),
        armature=_numbers([link.armature for link in links], values),
        viscous=_numbers([link.viscous for link in links], values),
        coulomb=_numbers([link.coulomb for link in links], values),
    )


def _numbers(cells: Sequence[Expression], values: Values) -> Array:
    return np.array([to_float(cell, values) for cell in cells])

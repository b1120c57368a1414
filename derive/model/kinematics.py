"""Closed-form kinematics: frames and the Jacobians of end effector, links and rotors, as exact polynomials.

The Jacobian for another point of the last link, and in the axes of another frame.

Moving the point adds multiples of the angular rows to the linear ones, and turning the axes turns both: neither
changes the rank of J, nor the determinant of all six rows. In the middle of the arm the entries are shortest
(Siciliano et al., Robotics, sec. 3.3).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.vectors import Frame, Vector, add, column, cross, multiply, scale, subtract, transpose
from derive.robot.description import Convention, Motor
from derive.robot.expression import Expression
from derive.robot.robot import Robot

PolynomialFrame = Frame[Polynomial]
PolynomialVector = Vector[Polynomial]


class Kinematics:
    """Frames and Jacobians of one robot.

    Args:
        robot: The robot.
        domain: The ring to work in.
    """

    def __init__(self, robot: Robot, domain: PolynomialDomain) -> None:
        self.robot = robot
        self.domain = domain
        self.chain: Chain[Polynomial] = build_chain(robot, domain)
        self._frames: dict[tuple[int, int], PolynomialFrame] = {}
        self._joint_frames: list[PolynomialFrame] = []

    # -- frames

    def row(self, i: int) -> PolynomialFrame:
        """A_i, the transform of row i (from 1)."""
        joint = self.chain.joints[i - 1]
        motion = joint.motion(self.chain.zero, self.chain.one)
        if self.robot.convention is Convention.STANDARD:
            return motion @ self.chain.ends[i - 1]
        return joint.fixed @ motion

    def transform(self, i: int, j: int) -> PolynomialFrame:
        """DH frame j in DH frame i, without base and tool."""
        if (i, j) not in self._frames:
            self._frames[i, j] = self._transform(i, j)
        return self._frames[i, j]

    def _transform(self, i: int, j: int) -> PolynomialFrame:
        if i == j:
            return self._identity
        if i > j:
            return inverse(self.transform(j, i))
        return self.transform(i, j - 1) @ self.row(j)

    def frame(self, i: int) -> PolynomialFrame:
        """DH frame i in the world: base A_1 ... A_i."""
        return self.chain.base @ self.transform(0, i)

    @cached_property
    def end(self) -> PolynomialFrame:
        """The end effector in the world: base A_1 ... A_n tool."""
        return self.joint_frame(self.robot.n) @ self.chain.tool

    def joint_frame(self, i: int) -> PolynomialFrame:
        """Joint frame i (from 1) in the world; its z axis is the axis of joint i. Joint frame 0 is the base."""
        if not self._joint_frames:
            self._joint_frames.append(self.chain.base)
        while len(self._joint_frames) <= i:
            joint = self.chain.joints[len(self._joint_frames) - 1]
            step = joint.fixed @ joint.motion(self.chain.zero, self.chain.one)
            self._joint_frames.append(self._joint_frames[-1] @ step)
        return self._joint_frames[i]

    @cached_property
    def _identity(self) -> PolynomialFrame:
        o, z = self.chain.one, self.chain.zero
        return Frame(((o, z, z), (z, o, z), (z, z, o)), (z, z, z))

    # -- Jacobians, as lists of columns

    def axis(self, i: int) -> PolynomialVector:
        """Axis of joint i (from 1) in the world, in the sense of a positive rate of its variable."""
        z = column(self.joint_frame(i).rotation, 2)
        return z if self.robot.joints[i - 1].sign > 0 else scale(-1, z)

    def linear_columns(self, point: PolynomialVector) -> list[PolynomialVector]:
        """The derivatives of a point in the world with respect to every variable."""
        d = self.domain.derivative
        return [(d(point[0], k), d(point[1], k), d(point[2], k)) for k in range(self.robot.n)]

    def angular_columns(self, last: int) -> list[PolynomialVector]:
        """Angular velocity of link ``last`` (from 1; 0 is the base) per unit of every rate."""
        still = (self.chain.zero,) * 3
        return [
            self.axis(k) if k <= last and self.robot.joints[k - 1].is_revolute else still
            for k in range(1, self.robot.n + 1)
        ]

    def com(self, i: int) -> PolynomialVector:
        """Centre of mass of link i in the world."""
        frame = self.frame(i)
        return add(frame.position, multiply(frame.rotation, self.vector(self.robot.links[i - 1].com)))

    def motor_place(self, i: int) -> PolynomialVector:
        """Where the rotor of joint i sits, in the world."""
        carrier = self.joint_frame(i - 1) @ self.chain.joints[i - 1].fixed
        if self.robot.convention is Convention.STANDARD:
            return carrier.position
        along = self.domain.constant(self.robot.joints[i - 1].d)
        return add(carrier.position, scale(along, column(carrier.rotation, 2)))

    def motor_angular_columns(self, i: int) -> list[PolynomialVector]:
        """Angular velocity of rotor i per unit of every rate: that of link i-1, and ratio*z for joint i."""
        columns = self.angular_columns(i - 1)
        motor = self.robot.links[i - 1].motor or Motor()
        z = column((self.joint_frame(i - 1) @ self.chain.joints[i - 1].fixed).rotation, 2)
        columns[i - 1] = scale(self.domain.constant(motor.ratio), z)
        return columns

    # -- potential energy

    @cached_property
    def potential(self) -> Polynomial:
        """U = -sum m g0.p over links and rotors, g0 in the world."""
        robot, constant = self.robot, self.domain.constant
        if robot.gravity is None:
            return self.chain.zero
        g = self.vector(robot.gravity)
        total = self.chain.zero
        for i, link in enumerate(robot.links, start=1):
            total = total - constant(link.mass) * _dot(g, self.com(i))
            if link.motor is not None:
                total = total - constant(link.motor.mass) * _dot(g, self.motor_place(i))
        return total

    @cached_property
    def gravity_vector(self) -> list[Polynomial]:
        """g = dU/dq."""
        return [self.domain.derivative(self.potential, k) for k in range(self.robot.n)]

    def vector(self, cells: tuple[Expression, Expression, Expression]) -> PolynomialVector:
        """Three cells as polynomials."""
        constant = self.domain.constant
        return (constant(cells[0]), constant(cells[1]), constant(cells[2]))


def _dot(a: PolynomialVector, b: PolynomialVector) -> Polynomial:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def inverse(frame: PolynomialFrame) -> PolynomialFrame:
    """The inverse of a rigid transform: (R^T, -R^T p)."""
    turned = transpose(frame.rotation)
    return Frame(turned, scale(-1, multiply(turned, frame.position)))


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

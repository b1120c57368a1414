"""Closed-form kinematics: frames and the Jacobians of end effector, links and rotors, as exact polynomials."""

from dataclasses import dataclass
from functools import cache, cached_property

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.mechanics.chain import Chain, build_chain, constant_vector, way_frame
from derive.mechanics.energy import potential_energy
from derive.mechanics.vectors import Frame, Vector, add, column, cross, multiply, scale, subtract
from derive.robot import tree
from derive.robot.coupling import projected
from derive.robot.description import Convention, Motor
from derive.robot.robot import Robot

PolynomialFrame = Frame[Polynomial]
PolynomialVector = Vector[Polynomial]
JacobianColumn = tuple[Polynomial, ...]  # linear velocity, then angular velocity, per unit of one rate


class Kinematics:
    """Frames and Jacobians of one robot."""

    def __init__(self, robot: Robot, domain: PolynomialDomain) -> None:
        self.robot = robot
        self.domain = domain
        self.chain: Chain[Polynomial] = build_chain(robot, domain)
        self.transform, self.joint_frame = cache(self._transform), cache(self._joint_frame)

    def _transform(self, i: int, j: int) -> PolynomialFrame:
        """DH frame j in DH frame i, without base and tool."""
        if i >= j:
            return self.transform(j, i).inverse if i > j else self.chain.unit
        before = self.chain.joints[j - 1].parent + 1
        return self.transform(i, before) @ self.chain.row(j, self.robot.convention)

    def row(self, i: int) -> PolynomialFrame:
        """A_i, from the frame that row i follows."""
        return self.transform(self.chain.joints[i - 1].parent + 1, i)

    def between(self, one: str, other: str) -> PolynomialFrame:
        """The frame of a row of a tree in that of another one, both by their labels."""
        (i, start), (j, end) = (way_frame(self.robot, label, self.domain) for label in (one, other))
        frame = self.transform(i + 1, j + 1)
        return (frame if start is None else start.inverse @ frame) @ (self.chain.unit if end is None else end)

    def placed(self, label: str) -> PolynomialFrame:
        """The frame of a row of a tree in the world."""
        return self.chain.base @ self.between("", label)

    def frame(self, i: int) -> PolynomialFrame:
        """DH frame i in the world: base A_1 ... A_i."""
        return self.chain.base @ self.transform(0, i)

    @cached_property
    def end(self) -> PolynomialFrame:
        """The end effector in the world: base A_1 ... A_n tool."""
        return self.joint_frame(self.robot.n) @ self.chain.tool

    def _joint_frame(self, i: int) -> PolynomialFrame:
        """Joint frame i in the world; its z axis is the axis of joint i."""
        if i == 0:
            return self.chain.base
        joint = self.chain.joints[i - 1]
        return self.joint_frame(joint.parent + 1) @ (joint.fixed @ joint.motion(self.chain.zero, self.chain.one))

    def axis(self, i: int) -> PolynomialVector:
        """Axis of joint i in the world, in the sense of a positive rate of its variable."""
        z = column(self.joint_frame(i).rotation, 2)
        return z if self.robot.joints[i - 1].sign > 0 else scale(-1, z)

    def linear_columns(self, point: PolynomialVector) -> list[PolynomialVector]:
        """The derivatives of a point with respect to every joint variable: n columns of J_v."""
        d = self.domain.derivative
        return [(d(point[0], k), d(point[1], k), d(point[2], k)) for k in range(self.robot.dof)]

    def angular_columns(self, last: int) -> list[PolynomialVector]:
        """Angular velocity of a link per unit of every rate, in the world: n columns of J_w."""
        return self._by_variables(self._spins(last))

    def _spins(self, last: int) -> list[PolynomialVector]:
        """The same per unit of every joint's rate."""
        movers, joints = tree.path(self.robot, last - 1), enumerate(self.robot.joints)
        return [self.axis(k + 1) if k in movers and joint.is_revolute else self.chain.null for k, joint in joints]

    def _by_variables(self, columns: list[PolynomialVector]) -> list[PolynomialVector]:
        """Columns for the variables from those for the joints."""
        if not self.robot.coupled:
            return columns
        matrix, zero = self.domain.coupling, self.chain.zero
        rows = (projected(entries, matrix, zero) for entries in zip(*columns, strict=True))
        return [(x, y, z) for x, y, z in zip(*rows, strict=True)]

    def com(self, i: int) -> PolynomialVector:
        """Centre of mass of link i in the world; bodies of rows without motion count behind link n."""
        frame = self.frame(i) if i <= self.robot.n else self.chain.base @ self.between("", tree.labels(self.robot)[i])
        com = tree.bodies(self.robot)[i - 1].com
        return add(frame.position, multiply(frame.rotation, constant_vector(com, self.domain)))

    def motor_place(self, i: int) -> PolynomialVector:
        """Where the rotor of joint i sits, in the world."""
        joint = self.chain.joints[i - 1]
        carrier = self.joint_frame(joint.parent + 1)
        return add(carrier.position, multiply(carrier.rotation, joint.rotor))

    def motor_angular_columns(self, i: int) -> list[PolynomialVector]:
        """Angular velocity of rotor i per unit of every rate: that of link i-1, and ratio*z for joint i."""
        joint = self.chain.joints[i - 1]
        columns = self._spins(joint.parent + 1)
        motor = self.robot.links[i - 1].motor or Motor()
        z = column((self.joint_frame(joint.parent + 1) @ joint.fixed).rotation, 2)
        columns[i - 1] = scale(self.domain.constant(motor.ratio), z)
        return self._by_variables(columns)

    @cached_property
    def potential(self) -> Polynomial:
        """U = -sum m g0.p over links and rotors, g0 in the world."""
        return potential_energy(self.chain) if self.chain.bodies else self.chain.zero

    @cached_property
    def gravity_vector(self) -> list[Polynomial]:
        """g = dU/dq, n entries."""
        return [self.domain.derivative(self.potential, k) for k in range(self.robot.dof)]


@dataclass(frozen=True, slots=True)
class Reference:
    """Where a Jacobian is taken.

    Moving the point adds multiples of the angular rows to the linear ones, and turning the axes turns both: neither
    changes the rank of J, nor the determinant of all six rows. In the middle of the arm the entries are shortest
    (Siciliano et al., Robotics, sec. 3.3).
    """

    frame: int | None = None  # DH frame in whose axes it is, None for the world
    point: int | None = None  # DH frame whose origin is the point of the last link, None for the end effector


def jacobian_columns(kinematics: Kinematics, reference: Reference) -> list[JacobianColumn]:
    """The columns of the Jacobian of another point of the last link, in the axes of another frame."""
    robot, seen_from = kinematics.robot, reference.frame

    def _frame(i: int) -> PolynomialFrame:
        return kinematics.frame(i) if seen_from is None else kinematics.transform(seen_from, i)

    if reference.point is not None:
        point = _frame(reference.point).position
    elif seen_from is None:
        point = kinematics.end.position
    else:
        last = _frame(robot.n)
        point = add(last.position, multiply(last.rotation, kinematics.chain.tip.position))
    columns: list[JacobianColumn] = []
    for index, joint in enumerate(robot.joints):
        moved = kinematics.chain.joints[index]
        at = _frame(index + 1 if robot.convention is Convention.MODIFIED else moved.parent + 1)
        if robot.convention is Convention.STANDARD and moved.mount is not None:
            at = at @ moved.mount
        axis: PolynomialVector = scale(joint.sign, column(at.rotation, 2))
        linear = cross(axis, subtract(point, at.position)) if joint.is_revolute else axis
        columns.append((*linear, *(axis if joint.is_revolute else kinematics.chain.null)))
    return columns

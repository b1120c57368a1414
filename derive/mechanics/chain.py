"""The arm or tree as every recursion sees it: joint motions about z between constant frames, over any scalar type.

Both conventions are one chain,

    T = base K_0 Z_1 K_1 Z_2 ... Z_n K_n tool,   Z_i = Rot(z, theta_i) Trans(z, d_i),

with K_i = Trans(x, a_i) Rot(x, alpha_i), K_0 = 1 (standard) or K_{i-1} = Rot(x, alpha_{i-1}) Trans(x, a_{i-1}), K_n =
1 (modified). *Joint frame* i stands after Z_i: it moves with link i and its z axis is the axis of joint i. In the
modified convention it is DH frame i; in the standard one DH frame i is joint frame i times K_i. Frames on the joint
axes make every recursion cheaper than frames at the far end of the links (Khalil and Dombre, Modeling, Identification
and Control of Robots, ch. 3 for the frames, ch. 9 for what they save).

In a tree each joint follows another one, or the base, and what is constant between the two is part of K. A chain is a
tree in which each joint follows the one before it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from operator import matmul
from typing import Generic, Protocol, TypeVar

from derive.mechanics import vectors
from derive.mechanics.vectors import Frame, S, Symmetric, Vector, add, conjugate, identity, multiply, scale, steiner
from derive.robot import tree
from derive.robot.description import INERTIA, Convention, FixedRow, Joint, Link, Motor, Stand
from derive.robot.expression import Expression
from derive.robot.robot import Robot

S_co = TypeVar("S_co", covariant=True)


class Domain(Protocol[S_co]):
    """Turns exact expressions into scalars of one kind: floats, polynomials, tape values, SymPy expressions."""

    def number(self, value: int | Fraction) -> S_co:
        """A rational as a scalar."""

    def constant(self, expression: Expression) -> S_co:
        """A cell without joint variables as a scalar."""

    def cosine_sine(self, angle: Expression) -> tuple[S_co, S_co]:
        """Cosine and sine of a constant angle."""

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[S_co, S_co]:
        """Cosine and sine of theta_i = ``sign*q + theta`` of a revolute joint."""

    def joint_offset(self, index: int, joint: Joint) -> S_co:
        """The offset d_i = ``sign*q + d`` of a prismatic joint [m]."""


@dataclass(frozen=True, slots=True)
class Body(Generic[S]):
    """A rigid body by its ten linear parameters, in a frame that moves with it."""

    mass: S  # m
    first_moment: Vector[S]  # m r, with r the centre of mass
    inertia: Symmetric[S]  # tensor about the frame's origin

    def __add__(self, other: Body[S]) -> Body[S]:
        return Body(self.mass + other.mass, add(self.first_moment, other.first_moment), self.inertia + other.inertia)


@dataclass(frozen=True, slots=True)
class ChainJoint(Generic[S]):
    """One joint, with rates counted positive about (along) +z: rate = sign * qd."""

    revolute: bool  # whether the joint turns
    sign: int  # +1 or -1
    parent: int  # index of the joint that it follows, from 0 and below its own; -1 on the base
    # From the DH frame that it follows to that in which its row begins; None where there is nothing between.
    mount: Frame[S] | None
    fixed: Frame[S]  # K, from the joint frame that it follows to the axis of the joint
    rotor: Vector[S]  # where its rotor sits, in the joint frame that it follows
    cosine: S  # cos(theta_i)
    sine: S  # sin(theta_i)
    offset: S  # d_i, with the variable of a prismatic joint in it
    coupling: S  # sign * ratio * rotor inertia: the rotor's momentum about z per unit of rate
    armature: S  # what resists the joint's own acceleration: ratio^2 * rotor inertia + armature of the file
    viscous: S  # b of b*qd
    coulomb: S  # f of f*sign(qd), of friction by direction half the sum of both magnitudes
    coulomb_even: S  # and half their difference, of sign(qd)^2

    def motion(self, zero: S, one: S) -> Frame[S]:
        """Z_i = Rot(z, theta_i) Trans(z, d_i)."""
        c, s = self.cosine, self.sine
        return Frame(((c, -s, zero), (s, c, zero), (zero, zero, one)), (zero, zero, self.offset))


@dataclass(frozen=True, slots=True)
class Chain(Generic[S]):
    """The whole arm or tree; kinematics of an end effector take that of the arm which leads there."""

    zero: S  # the scalar 0
    one: S  # the scalar 1
    base: Frame[S]  # world to frame 0
    joints: tuple[ChainJoint[S], ...]  # the joints from the base outwards
    tip: Frame[S]  # DH frame n to the end effector: the tool, behind rows without motion
    tool: Frame[S]  # K_n times that: joint frame n to the end effector
    # K_i of the standard convention (identity in the modified one): joint frame i to DH frame i.
    ends: tuple[Frame[S], ...]
    bodies: tuple[Body[S], ...]  # link i with the rotors that it carries, in joint frame i; empty without dynamics
    gravity: Vector[S]  # acceleration of gravity in frame 0 (the base transform taken off)
    # Gravity times the way from the world's origin to frame 0: what a unit mass there loses of its potential energy.
    drop: S
    # What no joint moves and yet has a potential energy, in frame 0: the rotor of joint 1, and what regrouping moves
    # to the base.
    ground: Body[S]
    # Masses at the joint frames that resist acceleration along z alone; none unless regrouping makes them.
    axial: tuple[S, ...] = ()

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joints)

    @property
    def null(self) -> Vector[S]:
        """The vector 0."""
        return (self.zero, self.zero, self.zero)

    @property
    def unit(self) -> Frame[S]:
        """The frame of no motion."""
        return Frame(identity(self.zero, self.one), self.null)

    @property
    def is_serial(self) -> bool:
        """Whether each joint follows the one before."""
        return all(joint.parent == i - 1 for i, joint in enumerate(self.joints))

    def followers(self, i: int) -> tuple[int, ...]:
        """The joints that follow joint i, of a chain one or none."""
        return tuple(k for k, joint in enumerate(self.joints) if joint.parent == i)

    def inward(self, j: int) -> Iterator[tuple[int, ChainJoint[S]]]:
        """From joint j to the base each joint further in, by its index, with the joint that follows it on the way."""
        outer = self.joints[j]
        while outer.parent >= 0:
            yield outer.parent, outer
            outer = self.joints[outer.parent]

    @property
    def inverted(self) -> Chain[S]:
        """The arm seen from its end: T^-1 = tool^-1 Z_n^-1 K_{n-1}^-1 ... K_0^-1 base^-1; kinematics alone."""
        joints = self.joints[::-1]
        fixed = [self.unit, *(joint.fixed.inverse for joint in joints)]
        return replace(
            self,
            base=self.tool.inverse,
            joints=tuple(
                replace(joint, sign=-joint.sign, parent=i - 1, fixed=before, sine=-joint.sine, offset=-joint.offset)
                for i, (joint, before) in enumerate(zip(joints, fixed[:-1], strict=True))
            ),
            tool=fixed[-1] @ self.base.inverse,
            ends=(self.unit,) * self.n,
            bodies=(),
            axial=(),
        )

    def row(self, i: int, convention: Convention) -> Frame[S]:
        """A_i, the DH transform of row i: DH frame i in the DH frame that it follows."""
        joint = self.joints[i - 1]
        motion = joint.motion(self.zero, self.one)
        if convention is not Convention.STANDARD:
            return joint.fixed @ motion
        row = motion @ self.ends[i - 1]
        return row if joint.mount is None else joint.mount @ row


def build_chain(robot: Robot, domain: Domain[S]) -> Chain[S]:
    """The arm or tree as joint motions between constant frames; of several ends none is the end effector."""
    zero, one = domain.number(0), domain.number(1)
    base = constant_frame(robot.base, domain)
    rows = [link_factor(joint.a, joint.alpha, domain) for joint in robot.joints]
    unit = Frame(identity(zero, one), (zero, zero, zero))
    standard = robot.convention is Convention.STANDARD
    ends = rows if standard else [unit] * len(rows)
    joints = []
    for i, way in enumerate(tree.ways(robot)):
        mount, stand = None, robot.joints[i].stand
        if stand is not None:  # from the DH frame of the joint that the row follows to where the row begins
            mount = stand_frame(stand, domain)
            for row in reversed(way.rows):
                mount = _fixed_frame(robot, row, domain) @ mount
        # K is that of the row before and the mount (standard), or the mount and that of the row itself (modified).
        factors = (rows[way.joint] if way.joint >= 0 else None, mount) if standard else (mount, rows[i])
        found = [factor for factor in factors if factor is not None]
        joints.append(_chain_joint(robot, i, (way.joint, mount, reduce(matmul, found or [unit])), domain))
    last, *others = tree.ends(robot)
    tip = constant_frame(last.tool, domain) if not others else unit
    for row in reversed(tree.way_to(robot, last.after).rows if not others else ()):
        tip = _fixed_frame(robot, row, domain) @ tip
    tool = ends[-1] @ tip
    ground, *bodies = _bodies(robot, joints, ends, domain)
    gravity, drop = (zero, zero, zero), zero
    if robot.gravity is not None:
        in_world = constant_vector(robot.gravity, domain)
        gravity, drop = multiply(vectors.transpose(base.rotation), in_world), vectors.dot(in_world, base.position)
    return Chain(zero, one, base, tuple(joints), tip, tool, tuple(ends), tuple(bodies), gravity, drop, ground)


def way_frame(robot: Robot, label: str, domain: Domain[S]) -> tuple[int, Frame[S] | None]:
    """The joint that carries a row, -1 for the base, and the row's frame in its DH frame; None where they are one."""
    way = tree.way_to(robot, label)
    return way.joint, reduce(matmul, [_fixed_frame(robot, row, domain) for row in way.rows]) if way.rows else None


def stand_frame(stand: Stand, domain: Domain[S]) -> Frame[S]:
    """Mount Rot(z, gamma) Trans(z, b)."""
    return constant_frame(stand.mount, domain) @ about_z(stand.gamma, stand.b, domain)


def _fixed_frame(robot: Robot, row: FixedRow, domain: Domain[S]) -> Frame[S]:
    """The frame of a row without motion in the DH frame that it follows."""
    own, link = about_z(row.theta, row.d, domain), link_factor(row.a, row.alpha, domain)
    return stand_frame(row.stand, domain) @ (own @ link if robot.convention is Convention.STANDARD else link @ own)


def about_z(angle: Expression, offset: Expression, domain: Domain[S]) -> Frame[S]:
    """Rot(z, angle) Trans(z, offset) of constants."""
    zero, one, (c, s) = domain.number(0), domain.number(1), domain.cosine_sine(angle)
    return Frame(((c, -s, zero), (s, c, zero), (zero, zero, one)), (zero, zero, domain.constant(offset)))


def link_factor(a: Expression, alpha: Expression, domain: Domain[S]) -> Frame[S]:
    """K = Trans(x, a) Rot(x, alpha); the two commute, so it serves both conventions."""
    zero, one = domain.number(0), domain.number(1)
    c, s = domain.cosine_sine(alpha)
    return Frame(((one, zero, zero), (zero, c, -s), (zero, s, c)), (domain.constant(a), zero, zero))


def constant_vector(cells: tuple[Expression, Expression, Expression], domain: Domain[S]) -> Vector[S]:
    """Three cells as a vector."""
    return (domain.constant(cells[0]), domain.constant(cells[1]), domain.constant(cells[2]))


def central_inertia(link: Link, domain: Domain[S]) -> Symmetric[S]:
    """The inertia tensor of a link as the file gives it: about its centre of mass, in the axes of its DH frame."""
    return Symmetric(*(domain.constant(getattr(link.inertia, key)) for key in INERTIA))


def constant_frame(matrix: tuple[tuple[Expression, ...], ...], domain: Domain[S]) -> Frame[S]:
    """A constant transform."""
    rows = [[domain.constant(cell) for cell in row] for row in matrix[:3]]
    rotation = tuple((row[0], row[1], row[2]) for row in rows)
    return Frame((rotation[0], rotation[1], rotation[2]), (rows[0][3], rows[1][3], rows[2][3]))


def _chain_joint(
    robot: Robot, index: int, place: tuple[int, Frame[S] | None, Frame[S]], domain: Domain[S]
) -> ChainJoint[S]:
    joint, link = robot.joints[index], robot.links[index] if robot.links else Link()
    if joint.is_revolute:
        cosine, sine = domain.joint_cosine_sine(index, joint)
        offset = domain.constant(joint.d)
    else:
        cosine, sine = domain.cosine_sine(joint.theta)
        offset = domain.joint_offset(index, joint)
    *_, fixed = place
    rotor = fixed.position
    if robot.convention is Convention.MODIFIED:
        rotor = add(rotor, scale(domain.constant(joint.d), vectors.column(fixed.rotation, 2)))
    motor = link.motor or Motor()
    ratio = domain.constant(motor.ratio)
    spin = ratio * domain.constant(motor.inertia)
    coupling, armature = spin if joint.sign > 0 else -spin, ratio * spin + domain.constant(link.armature)
    friction = [domain.constant(cell) for cell in (link.viscous, *link.signed)]
    return ChainJoint(joint.is_revolute, joint.sign, *place, rotor, cosine, sine, offset, coupling, armature, *friction)


def fixed_bodies(robot: Robot, domain: Domain[S]) -> Iterator[tuple[int, Frame[S], Link]]:
    """The bodies of rows without motion: the joint that carries each, or -1, and its frame in the DH frame there."""
    for row in robot.fixed if robot.links else ():  # without the links of joints these have none either
        joint, frame = way_frame(robot, row.name, domain)
        if row.link is not None and frame is not None:
            yield joint, frame, row.link


def _bodies(
    robot: Robot, joints: Sequence[ChainJoint[S]], ends: Sequence[Frame[S]], domain: Domain[S]
) -> list[Body[S]]:
    """Base and links about the origins of their joint frames, each with the rotors of the next joints as parts of it.

    ``ends`` lead from joint frames to DH frames. A rotor's own spin is in `ChainJoint`; it sits at o_{i-1} in the
    standard convention, at o_i, d_i further on the axis, in the modified one.
    """
    null = domain.number(0)
    bodies = [Body(null, (null, null, null), Symmetric(null, null, null, null, null, null))]
    bodies += [body_in(end, link, domain) for link, end in zip(robot.links, ends[: len(robot.links)], strict=True)]
    for i, link in enumerate(robot.links):
        if (motor := link.motor) is None:
            continue
        carrier, place, u = joints[i].parent + 1, joints[i].rotor, vectors.column(joints[i].fixed.rotation, 2)
        mass, inertia = domain.constant(motor.mass), domain.constant(motor.inertia)
        rotor = Body(mass, scale(mass, place), vectors.axial_tensor(inertia, u) + steiner(mass, place))
        bodies[carrier] = bodies[carrier] + rotor
    for i, frame, link in fixed_bodies(robot, domain) if robot.links else ():
        bodies[i + 1] = bodies[i + 1] + body_in(ends[i] @ frame if i >= 0 else frame, link, domain)
    return bodies


def body_in(frame: Frame[S], link: Link, domain: Domain[S]) -> Body[S]:
    """A link by its parameters in the frame in which its own DH frame stands."""
    mass = domain.constant(link.mass)
    r = add(frame.position, multiply(frame.rotation, constant_vector(link.com, domain)))
    turned = conjugate(frame.rotation, central_inertia(link, domain).matrix)
    return Body(mass, scale(mass, r), vectors.from_matrix(turned) + steiner(mass, r))

"""The arm as every recursion sees it: joint motions about z between constant frames, over any scalar type.

Both conventions are one chain,

    T = base K_0 Z_1 K_1 Z_2 ... Z_n K_n tool,   Z_i = Rot(z, theta_i) Trans(z, d_i),

with K_i = Trans(x, a_i) Rot(x, alpha_i), K_0 = 1 (standard) or K_{i-1} = Rot(x, alpha_{i-1}) Trans(x, a_{i-1}), K_n =
1 (modified). *Joint frame* i stands after Z_i: it moves with link i and its z axis is the axis of joint i. In the
modified convention it is DH frame i; in the standard one DH frame i is joint frame i times K_i. Frames on the joint
axes make every recursion cheaper than frames at the far end of the links (Khalil and Dombre, Modeling, Identification
and Control of Robots, ch. 3).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Generic, Protocol, TypeVar

from derive.mechanics.vectors import (
    Frame,
    S,
    Symmetric,
    Vector,
    add,
    column,
    from_matrix,
    matmul,
    multiply,
    scale,
    steiner,
    transpose,
)
from derive.robot.description import Convention, Joint, Link, Motor
from derive.robot.expression import Expression
from derive.robot.robot import Robot

S_co = TypeVar("S_co", covariant=True)


class Domain(Protocol[S_co]):
    """Turns exact expressions into scalars of one kind."""

    def number(self, value: int | Fraction) -> S_co:
        """A rational."""

    def constant(self, expression: Expression) -> S_co:
        """A cell without joint variables."""

    def cosine_sine(self, angle: Expression) -> tuple[S_co, S_co]:
        """Cosine and sine of a constant angle [rad]."""

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[S_co, S_co]:
        """Cosine and sine of ``sign*q + theta`` of revolute joint ``index`` (from 0)."""

    def joint_offset(self, index: int, joint: Joint) -> S_co:
        """``sign*q + d`` of prismatic joint ``index`` (from 0)."""


@dataclass(frozen=True, slots=True)
class Body(Generic[S]):
    """A rigid body by its ten linear parameters, in a frame that moves with it.

    Attributes:
        mass: m.
        first_moment: m r, with r the centre of mass.
        inertia: Tensor about the frame's origin.
    """

    mass: S
    first_moment: Vector[S]
    inertia: Symmetric[S]

    def __add__(self, other: Body[S]) -> Body[S]:
        return Body(
            self.mass + other.mass,
            add(self.first_moment, other.first_moment),
            self.inertia + other.inertia,
        )


@dataclass(frozen=True, slots=True)
class ChainJoint(Generic[S]):
    """One joint, with rates counted positive about (along) +z: rate = sign * qd.

    Attributes:
        revolute: Whether the joint turns.
        sign: +1 or -1.
        fixed: K_{i-1}, from joint frame i-1 to the axis of joint i.
        cosine: cos(theta_i).
        sine: sin(theta_i).
        offset: d_i, with the variable of a prismatic joint in it.
        coupling: sign * ratio * rotor inertia: the rotor's momentum about z per unit of rate.
        reflected: ratio^2 * rotor inertia + armature, on the diagonal of B.
        viscous: b of b*qd.
        coulomb: f of f*sign(qd).
    """

    revolute: bool
    sign: int
    fixed: Frame[S]
    cosine: S
    sine: S
    offset: S
    coupling: S
    reflected: S
    viscous: S
    coulomb: S

    def motion(self, zero: S, one: S) -> Frame[S]:
        """Z_i = Rot(z, theta_i) Trans(z, d_i)."""
        c, s = self.cosine, self.sine
        return Frame(((c, -s, zero), (s, c, zero), (zero, zero, one)), (zero, zero, self.offset))


@dataclass(frozen=True, slots=True)
class Chain(Generic[S]):
    """The whole arm.

    Attributes:
        zero: The scalar 0.
        one: The scalar 1.
        base: World to frame 0.
        joints: The joints from the base outwards.
        tool: K_n times the tool: joint frame n to the end effector.
        ends: K_i of the standard convention (identity in the modified one): joint frame i to DH frame i.
        bodies: Link i with the rotors that it carries, in joint frame i; empty without dynamics.
        gravity: Acceleration of gravity in frame 0 (the base transform taken off).
        axial: Masses at the joint frames that resist acceleration along z alone; none unless regrouping makes them.
    """

    zero: S
    one: S
    base: Frame[S]
    joints: tuple[ChainJoint[S], ...]
    tool: Frame[S]
    ends: tuple[Frame[S], ...]
    bodies: tuple[Body[S], ...]
    gravity: Vector[S]
    axial: tuple[S, ...] = ()

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joints)


def build_chain(robot: Robot, domain: Domain[S]) -> Chain[S]:
    """The chain of ``robot`` over the scalars of ``domain``."""
    return _ChainBuilder(robot, domain).build()


class _ChainBuilder(Generic[S]):
    def __init__(self, robot: Robot, domain: Domain[S]) -> None:
        self.robot = robot
        self.domain = domain
        self.zero = domain.number(0)
        self.one = domain.number(1)
        self.standard = robot.convention is Convention.STANDARD

    def build(self) -> Chain[S]:
        base = self.constant_frame(self.robot.base)
        links = [self.link_frame(joint) for joint in self.robot.joints]
        identity = self.identity()
        fixed = [identity, *links[:-1]] if self.standard else links
        ends = links if self.standard else [identity] * len(links)
        joints = tuple(self.joint(i, joint, fixed[i]) for i, joint in enumerate(self.robot.joints))
        return Chain(
            zero=self.zero,
            one=self.one,
            base=base,
            joints=joints,
            tool=ends[-1] @ self.constant_frame(self.robot.tool),
            ends=tuple(ends),
            bodies=self.bodies(ends, fixed),
            gravity=self.gravity(base),
        )

    def identity(self) -> Frame[S]:
        o, z = self.one, self.zero
        return Frame(((o, z, z), (z, o, z), (z, z, o)), (z, z, z))

    def constant_frame(self, matrix: tuple[tuple[Expression, ...], ...]) -> Frame[S]:
        rows = [[self.domain.constant(cell) for cell in row] for row in matrix[:3]]
        rotation = tuple((row[0], row[1], row[2]) for row in rows)
        return Frame((rotation[0], rotation[1], rotation[2]), (rows[0][3], rows[1][3], rows[2][3]))

    def link_frame(self, joint: Joint) -> Frame[S]:
        """Trans(x, a) Rot(x, alpha); the two commute, so it serves both conventions."""
        c, s = self.domain.cosine_sine(joint.alpha)
        o, z = self.one, self.zero
        return Frame(((o, z, z), (z, c, -s), (z, s, c)), (self.domain.constant(joint.a), z, z))

    def joint(self, index: int, joint: Joint, fixed: Frame[S]) -> ChainJoint[S]:
        if joint.is_revolute:
            cosine, sine = self.domain.joint_cosine_sine(index, joint)
            offset = self.domain.constant(joint.d)
        else:
            cosine, sine = self.domain.cosine_sine(joint.theta)
            offset = self.domain.joint_offset(index, joint)
        link = self.link(index)
        motor = link.motor or Motor()
        ratio = self.domain.constant(motor.ratio)
        spin = ratio * self.domain.constant(motor.inertia)
        return ChainJoint(
            revolute=joint.is_revolute,
            sign=joint.sign,
            fixed=fixed,
            cosine=cosine,
            sine=sine,
            offset=offset,
            coupling=spin if joint.sign > 0 else -spin,
            reflected=ratio * spin + self.domain.constant(link.armature),
            viscous=self.domain.constant(link.viscous),
            coulomb=self.domain.constant(link.coulomb),
        )

    def link(self, index: int) -> Link:
        return self.robot.links[index] if self.robot.links else Link()

    def bodies(self, ends: list[Frame[S]], fixed: list[Frame[S]]) -> tuple[Body[S], ...]:
        if not self.robot.links:
            return ()
        bodies = [self.body(link, end) for link, end in zip(self.robot.links, ends, strict=True)]
        for i in range(1, len(bodies)):
            motor = self.robot.links[i].motor
            if motor is not None:
                bodies[i - 1] = bodies[i - 1] + self.rotor(motor, self.robot.joints[i], fixed[i])
        return tuple(bodies)

    def body(self, link: Link, end: Frame[S]) -> Body[S]:
        """Mass, first moment and inertia of one link about the origin of its joint frame."""
        constant = self.domain.constant
        mass = constant(link.mass)
        com = (constant(link.com[0]), constant(link.com[1]), constant(link.com[2]))
        r = add(end.position, multiply(end.rotation, com))
        tensor = Symmetric(*(constant(getattr(link.inertia, k)) for k in ("xx", "yy", "zz", "xy", "xz", "yz")))
        turned = matmul(matmul(end.rotation, tensor.matrix), transpose(end.rotation))
        return Body(mass, scale(mass, r), from_matrix(turned) + steiner(mass, r))

    def rotor(self, motor: Motor, joint: Joint, fixed: Frame[S]) -> Body[S]:
        """The rotor of a joint as a body of the link before it; its own spin is in coupling and reflected."""
        axis = column(fixed.rotation, 2)
        place = fixed.position
        if not self.standard:
            place = add(place, scale(self.domain.constant(joint.d), axis))
        mass, inertia = self.domain.constant(motor.mass), self.domain.constant(motor.inertia)
        u = scale(inertia, axis)
        axial = Symmetric(
            u[0] * axis[0], u[1] * axis[1], u[2] * axis[2], u[0] * axis[1], u[0] * axis[2], u[1] * axis[2]
        )
        return Body(mass, scale(mass, place), axial + steiner(mass, place))

    def gravity(self, base: Frame[S]) -> Vector[S]:
        if self.robot.gravity is None:
            return (self.zero, self.zero, self.zero)
        g = self.robot.gravity
        constant = self.domain.constant
        return multiply(transpose(base.rotation), (constant(g[0]), constant(g[1]), constant(g[2])))

"""The Newton-Euler recursion as lectures print it, with every intermediate vector.

Two equivalent sets of equations for a standard DH table (Luh, Walker and Paul 1980; Fu, Gonzalez and Lee, Robotics,
section 3.3): with all vectors in base coordinates, and with the vectors of link i in frame i. For link i

    omega_i  = omega_{i-1} + z_{i-1} qd_i
    omegad_i = omegad_{i-1} + z_{i-1} qdd_i + omega_{i-1} x z_{i-1} qd_i
    vd_i     = omegad_i x p*_i + omega_i x (omega_i x p*_i) + vd_{i-1}
    a_i      = omegad_i x s_i + omega_i x (omega_i x s_i) + vd_i
    F_i      = m_i a_i,    N_i = I_i omegad_i + omega_i x I_i omega_i
    f_i      = F_i + f_{i+1}
    n_i      = n_{i+1} + p*_i x f_{i+1} + (p*_i + s_i) x F_i + N_i
    tau_i    = n_i . z_{i-1} + b_i qd_i

with p*_i = o_i - o_{i-1}, s_i the centre of mass less o_i, and vd_0 = -g_0. For a prismatic joint omega and omegad
stay, vd_i has z_{i-1} qdd_i + 2 omega_i x z_{i-1} qd_i more, and f_i takes the place of n_i in tau_i. Rotors are no
part of it. Generated code uses the cheaper recursion of `derive.mechanics.newton_euler`; this one is for teaching and
for checking.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Generic

from derive.errors import QuantityError
from derive.mechanics import vectors
from derive.mechanics.chain import Chain, Domain, build_chain, central_inertia, constant_vector
from derive.mechanics.joint_motion import along_axes
from derive.mechanics.vectors import Matrix, S, Vector, add, column, conjugate, cross, dot, multiply, scale, transpose
from derive.robot.description import Convention, Motor
from derive.robot.expression import ZERO
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class FrameMotion(Generic[S]):
    """How a frame moves."""

    w: Vector[S]  # angular velocity
    wd: Vector[S]  # angular acceleration
    v: Vector[S]  # velocity of its origin
    vd: Vector[S]  # acceleration of its origin, less gravity

    def turned(self, rotation: Matrix[S]) -> FrameMotion[S]:
        """The motion in other axes."""
        w, wd, v, vd = (multiply(rotation, u) for u in (self.w, self.wd, self.v, self.vd))
        return FrameMotion(w, wd, v, vd)

    def swept(self, r: Vector[S]) -> Vector[S]:
        """omegad x r + omega x (omega x r)."""
        return add(cross(self.wd, r), cross(self.w, cross(self.w, r)))


@dataclass(frozen=True, slots=True)
class LinkWrench(Generic[S]):
    """What a link receives from the one before it."""

    f: Vector[S]  # force
    n: Vector[S]  # moment about the joint's origin


@dataclass(frozen=True, slots=True)
class LinkData(Generic[S]):
    """What the equations of one link are made of, in the coordinates of the set."""

    revolute: bool  # whether its joint turns
    qd: S  # rate of the joint about (along) +z_{i-1}
    qdd: S  # derivative of the rate
    rotation: Matrix[S]  # R_i, frame i in base coordinates
    before: Matrix[S]  # R_{i-1}^i, which takes vectors of frame i-1 into frame i
    z: Vector[S]  # z_{i-1} in the coordinates of the set (of link i)
    p: Vector[S]  # p*_i, from o_{i-1} to o_i
    s: Vector[S]  # from o_i to the centre of mass
    mass: S  # m_i
    inertia: Matrix[S]  # I_i about the centre of mass
    viscous: S  # b_i

    def next_motion(self, m: FrameMotion[S]) -> FrameMotion[S]:
        """The motion of frame i."""
        rate, acceleration = scale(self.qd, self.z), scale(self.qdd, self.z)
        # omega_i and omegad_i; vd_i of a slide has z qdd + 2 omega x z qd more.
        if self.revolute:
            joined = FrameMotion(add(m.w, rate), add(add(m.wd, acceleration), cross(m.w, rate)), m.v, m.vd)
        else:
            twice = cross(m.w, rate)
            joined = FrameMotion(m.w, m.wd, add(m.v, rate), add(add(m.vd, acceleration), add(twice, twice)))
        # From o_{i-1} over p* to o_i.
        v = add(cross(joined.w, self.p), joined.v)
        return FrameMotion(joined.w, joined.wd, v, add(joined.swept(self.p), joined.vd))

    def step(
        self, previous: FrameMotion[S], motion: FrameMotion[S], following: LinkWrench[S], turn: Matrix[S]
    ) -> LinkStep[S]:
        """Forces and moments of link i."""
        # a_i = omegad x s + omega x (omega x s) + vd_i
        a = add(motion.swept(self.s), motion.vd)
        # F_i = m a_i, N_i = I omegad + omega x I omega
        resultant = scale(self.mass, a)
        spin = add(multiply(self.inertia, motion.wd), cross(motion.w, multiply(self.inertia, motion.w)))
        # f_{i+1}, n_{i+1} in the axes of link i.
        next_f, next_n = multiply(turn, following.f), multiply(turn, following.n)
        # f_i, n_i and their part along z_{i-1} with viscous friction
        f = add(resultant, next_f)
        n = add(add(next_n, cross(self.p, next_f)), add(cross(add(self.p, self.s), resultant), spin))
        tau = dot(n if self.revolute else f, self.z) + self.viscous * self.qd
        return LinkStep(self, previous, motion, a, resultant, spin, following, LinkWrench(f, n), tau)


@dataclass(frozen=True, slots=True)
class LinkStep(Generic[S]):
    """All that the recursion computes for one link, in the coordinates of the set."""

    data: LinkData[S]  # what went in
    previous: FrameMotion[S]  # motion of frame i-1, in its own coordinates
    motion: FrameMotion[S]  # motion of frame i
    a: Vector[S]  # acceleration of the centre of mass
    F: Vector[S]  # resultant force
    N: Vector[S]  # resultant moment about the centre of mass
    following: LinkWrench[S]  # wrench of link i+1, in its own coordinates; the load for the last link
    wrench: LinkWrench[S]  # f_i and n_i
    tau: S  # torque or force about (along) +z_{i-1}, friction b qd included


@dataclass(frozen=True, slots=True)
class PrintedRecursion(Generic[S]):
    """The whole recursion."""

    links: tuple[LinkStep[S], ...]  # the steps of links 1 to n
    torques: tuple[S, ...]  # n entries, in the sense of the joint variables


def without_rotors(robot: Robot) -> Robot:
    """The robot without rotors, armatures and Coulomb friction: what these equations describe."""
    return replace(robot, links=tuple(replace(link, motor=None, armature=ZERO, coulomb=ZERO) for link in robot.links))


def printed_newton_euler(
    robot: Robot, domain: Domain[S], qd: Sequence[S], qdd: Sequence[S], load: LinkWrench[S] | None = None, *, base: bool
) -> PrintedRecursion[S]:
    """The recursion with every vector in base coordinates (axes of frame 0), else those of link i in frame i."""
    if robot.convention is not Convention.STANDARD:
        raise QuantityError("Newton-Euler equations of lectures", allowed="allowed: the standard convention")
    if not robot.has_dynamics:
        raise QuantityError(f"dynamics of {robot.name}", allowed="allowed: robots with `links`")
    for i, link in enumerate(robot.links, 1):
        rotor = link.motor or Motor()
        if any(cell != ZERO for cell in (rotor.mass, rotor.inertia, link.armature, *link.dry)):
            allowed, remedy = "none: these equations know rigid links and viscous friction", "use without_rotors(robot)"
            raise QuantityError(f"rotor, armature or Coulomb friction of link {i}", allowed=allowed, remedy=remedy)
    chain: Chain[S] = build_chain(robot, domain)
    unit = chain.unit.rotation
    rates, accelerations = along_axes(chain, qd), along_axes(chain, qdd)
    # Outward: vd_0 = -g makes the base accelerate against gravity.
    links: list[LinkData[S]] = []
    g = chain.gravity
    motions = [FrameMotion(chain.null, chain.null, chain.null, (-g[0], -g[1], -g[2]))]
    for i in range(chain.n):
        before = links[-1].rotation if links else unit
        links.append(_link_data(robot, domain, chain, i, before, (rates[i], accelerations[i]), base=base))
        motions.append(links[i].next_motion(motions[i] if base else motions[i].turned(links[i].before)))
    # Inward from the load at the end effector.
    wrench = load or LinkWrench(chain.null, chain.null)
    steps: list[LinkStep[S]] = []
    for i in range(chain.n - 1, -1, -1):
        turn = unit if base or i + 1 == chain.n else transpose(links[i + 1].before)
        steps.append(links[i].step(motions[i], motions[i + 1], wrench, turn))
        wrench = steps[-1].wrench
    steps.reverse()
    return PrintedRecursion(tuple(steps), tuple(along_axes(chain, [step.tau for step in steps])))


def _link_data(
    robot: Robot, domain: Domain[S], chain: Chain[S], i: int, before: Matrix[S], rates: tuple[S, S], *, base: bool
) -> LinkData[S]:
    """What is known of link i (from 0): ``before`` is R_{i-1}, ``rates`` those of its joint, +z being positive."""
    joint, link = chain.joints[i], robot.links[i]
    # A_i gives R_i = R_{i-1} R, and p* = o_i - o_{i-1} in the coordinates of the set.
    row = chain.row(i + 1, robot.convention)
    rotation, back = vectors.matmul(before, row.rotation), transpose(row.rotation)
    axes = before if base else back
    s, tensor = constant_vector(link.com, domain), central_inertia(link, domain).matrix
    if base:
        s, tensor = multiply(rotation, s), conjugate(rotation, tensor)
    places = (column(axes, 2), multiply(axes, row.position), s)
    return LinkData(joint.revolute, *rates, rotation, back, *places, domain.constant(link.mass), tensor, joint.viscous)

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
from derive.mechanics.chain import Chain, Domain, build_chain
from derive.mechanics.vectors import (
    Frame,
    Matrix,
    S,
    Symmetric,
    Vector,
    add,
    column,
    cross,
    dot,
    matmul,
    multiply,
    scale,
    transpose,
)
from derive.robot.description import Convention, Motor
from derive.robot.expression import ZERO, Expression
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Motion(Generic[S]):
    """How a frame moves: angular velocity and acceleration, velocity and acceleration of its origin (less gravity)."""

    w: Vector[S]
    wd: Vector[S]
    v: Vector[S]
    vd: Vector[S]


@dataclass(frozen=True, slots=True)
class Wrench(Generic[S]):
    """Force and moment that a link receives from the one before it, the moment about the joint's origin."""

    f: Vector[S]
    n: Vector[S]


@dataclass(frozen=True, slots=True)
class LinkData(Generic[S]):
    """What the equations of one link are made of, in the coordinates of the set.

    Attributes:
        revolute: Whether its joint turns.
        qd: Rate of the joint about (along) +z_{i-1}.
        qdd: Derivative of the rate.
        rotation: R_i, frame i in base coordinates.
        before: R_{i-1}^i, which takes vectors of frame i-1 into frame i.
        z: z_{i-1} in the coordinates of the set (of link i).
        p: p*_i, from o_{i-1} to o_i.
        s: From o_i to the centre of mass.
        mass: m_i.
        inertia: I_i about the centre of mass.
        viscous: b_i.
    """

    revolute: bool
    qd: S
    qdd: S
    rotation: Matrix[S]
    before: Matrix[S]
    z: Vector[S]
    p: Vector[S]
    s: Vector[S]
    mass: S
    inertia: Matrix[S]
    viscous: S


@dataclass(frozen=True, slots=True)
class LinkStep(Generic[S]):
    """All that the recursion computes for one link, in the coordinates of the set.

    Attributes:
        data: What went in.
        previous: Motion of frame i-1, in its own coordinates.
        motion: Motion of frame i.
        a: Acceleration of the centre of mass.
        F: Resultant force.
        N: Resultant moment about the centre of mass.
        following: Wrench of link i+1, in its own coordinates; the load for the last link.
        wrench: f_i and n_i.
        tau: Torque or force about (along) +z_{i-1}, friction b qd included.
    """

    data: LinkData[S]
    previous: Motion[S]
    motion: Motion[S]
    a: Vector[S]
    F: Vector[S]
    N: Vector[S]
    following: Wrench[S]
    wrench: Wrench[S]
    tau: S


@dataclass(frozen=True, slots=True)
class Recursion(Generic[S]):
    """The whole recursion.

    Attributes:
        links: The steps of links 1 to n.
        torques: n entries, in the sense of the joint variables.
    """

    links: tuple[LinkStep[S], ...]
    torques: tuple[S, ...]


def newton_euler_base(
    robot: Robot, domain: Domain[S], velocities: Sequence[S], accelerations: Sequence[S], load: Wrench[S] | None = None
) -> Recursion[S]:
    """The recursion with every vector in base coordinates (axes of frame 0).

    Args:
        robot: Standard convention, with links, without rotors.
        domain: Turns the robot's cells and its configuration into scalars: numbers, polynomials or tape nodes.
        velocities: qd, n entries.
        accelerations: qdd, n entries.
        load: f_{n+1} and n_{n+1} (about o_n), what the last link passes on; zero by default.

    Raises:
        QuantityError: Another convention, no links, or what these equations lack: rotors, armatures, Coulomb friction.
    """
    return _Recursion(robot, domain, base=True).run(velocities, accelerations, load)


def newton_euler_link(
    robot: Robot, domain: Domain[S], velocities: Sequence[S], accelerations: Sequence[S], load: Wrench[S] | None = None
) -> Recursion[S]:
    """The recursion with the vectors of link i in frame i; see `newton_euler_base`, the load in frame n."""
    return _Recursion(robot, domain, base=False).run(velocities, accelerations, load)


def without_rotors(robot: Robot) -> Robot:
    """The robot without rotors, armatures and Coulomb friction: what these equations describe."""
    links = tuple(replace(link, motor=None, armature=ZERO, coulomb=ZERO) for link in robot.links)
    return replace(robot, links=links)


class _Recursion(Generic[S]):
    def __init__(self, robot: Robot, domain: Domain[S], base: bool) -> None:
        _require(robot)
        self.robot = robot
        self.domain = domain
        self.base = base
        self.chain: Chain[S] = build_chain(robot, domain)
        self.null: Vector[S] = (self.chain.zero,) * 3
        self.up: Vector[S] = (self.chain.zero, self.chain.zero, self.chain.one)

    def run(self, velocities: Sequence[S], accelerations: Sequence[S], load: Wrench[S] | None) -> Recursion[S]:
        links = self.data(velocities, accelerations)
        motions = self.outward(links)
        last = load or Wrench(self.null, self.null)
        steps: list[LinkStep[S]] = []
        for i in range(len(links) - 1, -1, -1):
            turn = transpose(links[i + 1].before) if i + 1 < len(links) else self.unit
            steps.append(self.inward(links[i], motions[i], motions[i + 1], last, turn))
            last = steps[-1].wrench
        steps.reverse()
        signs = (joint.sign for joint in self.robot.joints)
        torques = tuple(step.tau if sign > 0 else -step.tau for sign, step in zip(signs, steps, strict=True))
        return Recursion(tuple(steps), torques)

    @property
    def unit(self) -> Matrix[S]:
        z, o = self.chain.zero, self.chain.one
        return ((o, z, z), (z, o, z), (z, z, o))

    # -- data

    def data(self, velocities: Sequence[S], accelerations: Sequence[S]) -> list[LinkData[S]]:
        rotation, links = self.unit, []
        for i in range(self.robot.n):
            links.append(self.link(i, rotation, velocities[i], accelerations[i]))
            rotation = links[-1].rotation
        return links

    def link(self, i: int, before: Matrix[S], velocity: S, acceleration: S) -> LinkData[S]:
        joint, link, constant = self.chain.joints[i], self.robot.links[i], self.domain.constant
        row: Frame[S] = joint.motion(self.chain.zero, self.chain.one) @ self.chain.ends[i]
        rotation = matmul(before, row.rotation)
        com = self.vector(link.com)
        tensor = Symmetric(*(constant(getattr(link.inertia, k)) for k in ("xx", "yy", "zz", "xy", "xz", "yz"))).matrix
        back = transpose(row.rotation)
        return LinkData(
            revolute=joint.revolute,
            qd=velocity if joint.sign > 0 else -velocity,
            qdd=acceleration if joint.sign > 0 else -acceleration,
            rotation=rotation,
            before=back,
            z=column(before, 2) if self.base else multiply(back, self.up),
            p=multiply(before if self.base else back, row.position),
            s=multiply(rotation, com) if self.base else com,
            mass=constant(link.mass),
            inertia=matmul(matmul(rotation, tensor), transpose(rotation)) if self.base else tensor,
            viscous=joint.viscous,
        )

    def vector(self, cells: tuple[Expression, Expression, Expression]) -> Vector[S]:
        constant = self.domain.constant
        return (constant(cells[0]), constant(cells[1]), constant(cells[2]))

    # -- recursions

    def outward(self, links: list[LinkData[S]]) -> list[Motion[S]]:
        """Frames 0 to n."""
        g = self.chain.gravity
        motions = [Motion(self.null, self.null, self.null, (-g[0], -g[1], -g[2]))]
        for link in links:
            motions.append(_moved(link, self.carried(link, motions[-1])))
        return motions

    def carried(self, link: LinkData[S], m: Motion[S]) -> Motion[S]:
        """The motion of frame i-1 in the coordinates of link i."""
        if self.base:
            return m
        turn = link.before
        return Motion(multiply(turn, m.w), multiply(turn, m.wd), multiply(turn, m.v), multiply(turn, m.vd))

    def inward(
        self, link: LinkData[S], previous: Motion[S], motion: Motion[S], after: Wrench[S], turn: Matrix[S]
    ) -> LinkStep[S]:
        a = add(_swept(motion, link.s), motion.vd)
        resultant = scale(link.mass, a)
        spin = add(multiply(link.inertia, motion.wd), cross(motion.w, multiply(link.inertia, motion.w)))
        next_f, next_n = (after.f, after.n) if self.base else (multiply(turn, after.f), multiply(turn, after.n))
        f = add(resultant, next_f)
        n = add(add(next_n, cross(link.p, next_f)), add(cross(add(link.p, link.s), resultant), spin))
        tau = dot(n if link.revolute else f, link.z) + link.viscous * link.qd
        return LinkStep(link, previous, motion, a, resultant, spin, after, Wrench(f, n), tau)


def _moved(link: LinkData[S], m: Motion[S]) -> Motion[S]:
    """The motion of frame i from that of frame i-1, both in the coordinates of link i."""
    rate, growth = scale(link.qd, link.z), scale(link.qdd, link.z)
    if link.revolute:
        w = add(m.w, rate)
        turned = Motion(w, add(add(m.wd, growth), cross(m.w, rate)), m.v, m.vd)
    else:
        twice = cross(m.w, rate)
        turned = Motion(m.w, m.wd, add(m.v, rate), add(add(m.vd, growth), add(twice, twice)))
    v = add(cross(turned.w, link.p), turned.v)
    return Motion(turned.w, turned.wd, v, add(_swept(turned, link.p), turned.vd))


def _swept(motion: Motion[S], r: Vector[S]) -> Vector[S]:
    """omegad x r + omega x (omega x r)."""
    return add(cross(motion.wd, r), cross(motion.w, cross(motion.w, r)))


def _require(robot: Robot) -> None:
    if robot.convention is not Convention.STANDARD:
        raise QuantityError("Newton-Euler equations of lectures", allowed="the standard convention")
    if not robot.has_dynamics:
        raise QuantityError(f"dynamics of {robot.name}", allowed="robots with `links`")
    for i, link in enumerate(robot.links, 1):
        rotor = link.motor or Motor()
        if any(cell != ZERO for cell in (rotor.mass, rotor.inertia, link.armature, link.coulomb)):
            raise QuantityError(
                f"rotor, armature or Coulomb friction of link {i}",
                allowed="none: these equations know rigid links and viscous friction",
                remedy="use without_rotors(robot)",
            )

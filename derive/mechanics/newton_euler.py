"""Newton-Euler in joint frames, rotors included: motion of the links outward, forces and moments inward.

Outward, gravity is taken as an acceleration of the base (Luh, Walker and Paul 1980). A point at r in a link accelerates
with a + U r, where U = alpha^ + omega^ omega^, the angular acceleration tensor, has all that forces and moments need of
omega and alpha (Khalil and Kleinfinger, 1987). The axis k of a joint stands still in both links that it joins, so U k
is the same vector for both: the third column of U of a link is that of the link before, turned. With it

    alpha_x = omega_y omega_z - U_yz,   alpha_y = U_xz - omega_x omega_z,   omega_x^2 + omega_y^2 = -U_zz

come from products that U asks for anyway. Where the twist is a multiple of pi/2 this takes five operations less than
turning alpha; elsewhere turning alpha is cheaper. `FrameChoice` says which way each joint takes, and where its frame
stands: choices that change the cost of a recursion and not what it computes.

Inward, a body is moved by the force m a + U h and the moment sum m r x (U r) + h x a, with h its first moment. The
rotor of joint i adds to link i-1 the moment c (rate_dot u + rate omega x u) and to its own torque c u . omegadot +
ratio^2 I rate_dot, with u its axis and omega of link i-1 (Siciliano et al., Robotics, section 7.5).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Generic

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.energy import Wrench, wrench_to_parent
from derive.mechanics.joint_motion import along_axes, axis, generalized_force, origin, to_child
from derive.mechanics.vectors import Matrix, S, Vector, add, conjugate, cross, dot, matmul, multiply, scale, transpose


class Place(Enum):
    """Where on the joint's axis the origin of its frame stands."""

    AFTER = "after the joint's own offset"
    BEFORE = "before the joint's own offset"
    BEYOND = "after the offset of the next joint too, whose axis is parallel"


@dataclass(frozen=True, slots=True)
class FrameChoice:
    """Choices for one joint and its link; which are cheapest depends on the arm."""

    place: Place = Place.AFTER  # where the origin stands
    # The link's vectors are written in axes that its joint does not turn, and its body is turned instead; for the
    # last link, and before a parallel axis.
    held: bool = False
    # The parameter that vanishes by regrouping is P_zz = (I_xx + I_yy - I_zz)/2, and moments are written in second
    # moments; else it is I_yy.
    second_moments: bool = False
    column: bool = True  # the third column of U comes from the link before (for a slide all of U); else alpha does
    squares: bool = True  # so does omega_x^2 + omega_y^2; else all three squares are made
    # In held axes, where omega gains its z alone, the rest of U is that of the link before with what the joint adds;
    # else it is made from omega and alpha.
    grown: bool = True


PLAIN = FrameChoice()  # DH frames on the joint axes, turning with the links


@dataclass(frozen=True, slots=True)
class LinkMotion(Generic[S]):
    """The motion of one link, in its joint frame."""

    omega: Vector[S]  # angular velocity
    alpha: Vector[S]  # angular acceleration
    tensor: Matrix[S]  # U = alpha^ + omega^ omega^; a point at r accelerates with ``acceleration + U r``
    acceleration: Vector[S]  # acceleration of the origin, less gravity
    # U_zz - U_yy, U_xx - U_zz and U_yy - U_xx, where they came cheaper than as such.
    differences: Vector[S] | None = None


def link_motions(
    chain: Chain[S],
    rates: Sequence[S],
    accelerations: Sequence[S],
    choices: Sequence[FrameChoice] = (),
    base: LinkMotion[S] | None = None,
) -> list[LinkMotion[S]]:
    """Motions of the base, gravity taken as an acceleration of it, and of links 1..n.

    ``base`` is that of frame 0 in its own axes, its acceleration less gravity; None where it stands.
    """
    x, y, z = chain.gravity
    null = chain.null
    motions = [base or LinkMotion(null, null, (null, null, null), (-x, -y, -z), null)]
    for i, joint in enumerate(chain.joints):
        choice = choices[i] if choices else PLAIN
        step = _beyond_revolute if joint.revolute else _beyond_prismatic
        motions.append(step(chain, joint, motions[joint.parent + 1], rates[i], accelerations[i], choice))
    return motions


def angular_acceleration_tensor(
    omega: Vector[S], alpha: Vector[S], third: Vector[S] | None = None
) -> tuple[Matrix[S], Vector[S]]:
    """U = alpha^ + omega^ omega^ from its definition."""
    x, y, z = omega
    xx, yy, zz = x * x, y * y, z * z
    xy, xz, yz = x * y, x * z, y * z
    if third is None:
        third = (xz + alpha[1], yz - alpha[0], -(xx + yy))
    first, second = (-(yy + zz), xy - alpha[2], third[0]), (xy + alpha[2], -(xx + zz), third[1])
    return (first, second, (xz - alpha[1], yz + alpha[0], -(xx + yy))), (zz - yy, xx - zz, yy - xx)


def _beyond_revolute(
    chain: Chain[S], joint: ChainJoint[S], before: LinkMotion[S], rate: S, acceleration: S, choice: FrameChoice
) -> LinkMotion[S]:
    x, y, inner = to_child(joint, before.omega)
    omega = (x, y, inner + rate)
    if not choice.column:
        ax, ay, az = to_child(joint, before.alpha)
        alpha = (ax + rate * y, ay - rate * x, az + acceleration)
        return _from_angular(omega, alpha, _origin_acceleration(joint, before))
    xz, yz = x * omega[2], y * omega[2]
    third = to_child(joint, multiply(before.tensor, axis(joint)))
    alpha = (yz - third[1], third[0] - xz, dot(axis(joint), before.alpha) + acceleration)
    if not choice.squares:
        return _from_angular(omega, alpha, _origin_acceleration(joint, before), third)
    start = _origin_acceleration(joint, before)
    # omega_x^2 + omega_y^2 = -U_zz: two squares in place of three
    yy, zz = y * y, omega[2] * omega[2]
    across = zz - yy
    xx_zz, yy_zz = across - third[2], yy + zz
    xy = x * y
    upper, lower = xy - alpha[2], xy + alpha[2]
    below = (x * omega[2] - alpha[1], y * omega[2] + alpha[0])
    if choice.held and choice.grown:  # the entries off the diagonal from those of the link before
        old = conjugate(transpose(joint.fixed.rotation), before.tensor)
        twice = rate + rate
        upper, lower = old[0][1] - acceleration, old[1][0] + acceleration
        below = (old[2][0] + twice * x, old[2][1] + twice * y)
    tensor = ((-yy_zz, upper, third[0]), (lower, -xx_zz, third[1]), (*below, third[2]))
    return LinkMotion(omega, alpha, tensor, start, (across, -(third[2] + yy_zz), yy_zz - xx_zz))


def _beyond_prismatic(
    chain: Chain[S], joint: ChainJoint[S], before: LinkMotion[S], rate: S, acceleration: S, choice: FrameChoice
) -> LinkMotion[S]:
    """omega, alpha and U are those of the link before, in other axes."""
    omega, alpha = to_child(joint, before.omega), to_child(joint, before.alpha)
    twice = rate + rate
    at_rest = _origin_acceleration(joint, before)
    origin_acceleration = add(at_rest, (twice * omega[1], -(twice * omega[0]), acceleration))
    if not choice.column:
        return _from_angular(omega, alpha, origin_acceleration)
    turn = matmul(joint.fixed.rotation, joint.motion(chain.zero, chain.one).rotation)
    return LinkMotion(omega, alpha, conjugate(transpose(turn), before.tensor), origin_acceleration)


def _origin_acceleration(joint: ChainJoint[S], before: LinkMotion[S]) -> Vector[S]:
    """The acceleration of the joint frame's origin as a point of the link before."""
    return to_child(joint, add(before.acceleration, multiply(before.tensor, origin(joint))))


def _from_angular(
    omega: Vector[S], alpha: Vector[S], acceleration: Vector[S], third: Vector[S] | None = None
) -> LinkMotion[S]:
    tensor, differences = angular_acceleration_tensor(omega, alpha, third)
    return LinkMotion(omega, alpha, tensor, acceleration, differences)


def inverse_dynamics(
    chain: Chain[S],
    qd: Sequence[S],
    qdd: Sequence[S],
    choices: Sequence[FrameChoice] = (),
    base: LinkMotion[S] | None = None,
    tip: Wrench[S] | None = None,
) -> list[S]:
    """B qdd + C qd + g without friction, n entries [N m or N]; ``base`` as `link_motions` takes it.

    ``tip`` is the wrench of the last link on what is beyond it, in its joint frame, about its origin.
    """
    rates, accelerations = along_axes(chain, qd), along_axes(chain, qdd)
    motions = link_motions(chain, rates, accelerations, choices, base)
    torques: list[S] = []
    for i, wrench in carried_wrenches(chain, motions, rates, accelerations, choices, tip):
        if i >= 0:
            joint = chain.joints[i]
            alpha = motions[joint.parent + 1].alpha
            own_rotor = joint.coupling * dot(axis(joint), alpha) + joint.armature * accelerations[i]
            torque = generalized_force(joint, *wrench) + own_rotor
            torques.append(torque if joint.sign > 0 else -torque)
    return torques[::-1]


def carried_wrenches(
    chain: Chain[S],
    motions: Sequence[LinkMotion[S]],
    rates: Sequence[S],
    accelerations: Sequence[S],
    choices: Sequence[FrameChoice],
    tip: Wrench[S] | None = None,
) -> Iterator[tuple[int, Wrench[S]]]:
    """From the tip inward, by joint (from 0) the wrench that moves all that it carries; at -1 that on the base."""
    carried: list[Wrench[S]] = [(chain.null, chain.null)] * (chain.n + 1)  # by the base and each link for those beyond
    carried[-1] = tip or carried[-1]
    for i in range(chain.n - 1, -1, -1):
        joint, motion = chain.joints[i], motions[i + 1]
        own_force, own_moment = body_wrench(chain.bodies[i], motion, (choices[i] if choices else PLAIN).second_moments)
        if chain.axial:
            own_force = (own_force[0], own_force[1], own_force[2] + chain.axial[i] * motion.acceleration[2])
        force, moment = carried[i + 1]
        force, moment = add(force, own_force), add(moment, own_moment)
        yield i, (force, moment)
        force, moment = wrench_to_parent(joint, (force, moment))
        # What the rotor of the joint asks of the link that carries it, beyond a rigid part of that link.
        u, before = axis(joint), joint.parent + 1
        turn = cross(motions[before].omega, u)
        spin = scale(joint.coupling, add(scale(accelerations[i], u), scale(rates[i], turn)))
        others = carried[before]
        carried[before] = add(others[0], force), add(others[1], add(moment, spin))
    yield -1, carried[0]


def body_wrench(body: Body[S], motion: LinkMotion[S], second_moments: bool = False) -> Wrench[S]:
    """Force and moment (at the origin) that move a body."""
    u, a, h = motion.tensor, motion.acceleration, body.first_moment
    force = add(scale(body.mass, a), multiply(u, h))
    i, differences = body.inertia, motion.differences or (u[2][2] - u[1][1], u[0][0] - u[2][2], u[1][1] - u[0][0])
    if second_moments:  # sum m r x (U r) in P, with P_zz = 0: P_xx = I_yy and P_yy = I_xx
        spin = (
            i.xx * u[2][1] + (i.xz * u[1][0] - i.xy * u[2][0]) - i.yz * differences[0],
            (i.xy * u[2][1] - i.yz * u[0][1]) - i.yy * u[2][0] - i.xz * differences[1],
            (i.yy * u[1][0] - i.xx * u[0][1]) + (i.yz * u[0][2] - i.xz * u[1][2]) - i.xy * differences[2],
        )
    else:  # I alpha + omega x (I omega), with the products of omega shared with U
        (x, y, z), (ax, ay, az) = motion.omega, motion.alpha
        spin = (
            (i.xx * ax + (i.zz - i.yy) * (y * z)) + (i.xz * u[1][0] - i.xy * u[2][0]) - i.yz * differences[0],
            (i.yy * ay + (i.xx - i.zz) * (x * z)) + (i.xy * u[2][1] - i.yz * u[0][1]) - i.xz * differences[1],
            (i.zz * az + (i.yy - i.xx) * (x * y)) + (i.yz * u[0][2] - i.xz * u[1][2]) - i.xy * differences[2],
        )
    return force, add(spin, cross(h, a))

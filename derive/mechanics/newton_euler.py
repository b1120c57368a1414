"""Inverse dynamics by the Newton-Euler recursion, in joint frames, rotors included.

Outward, the motion of the links (`derive.mechanics.link_motion`), gravity taken as an acceleration of the base (Luh,
Walker and Paul 1980); inward, forces and moments. A body is moved by the force m a + U h and the moment sum m r x (U r)
+ h x a, with h its first moment and U = alpha^ + omega^ omega^ (Khalil and Kleinfinger, 1987). The rotor of joint i
adds to link i-1 the moment c (rate_dot u + rate omega x u) and to its own torque c u . omegadot + ratio^2 I rate_dot,
with u its axis and omega of link i-1 (Siciliano et al., Robotics, section 7.3).
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import axis, origin, rates, to_parent, work
from derive.mechanics.link_motion import PLAIN, JointForm, LinkMotion, link_motions
from derive.mechanics.vectors import S, Symmetric, Vector, add, cross, dot, multiply, scale

__all__ = ["LinkMotion", "body_wrench", "inverse_dynamics", "link_motions", "rotor_moment", "rotor_torque"]


def inverse_dynamics(
    chain: Chain[S], velocities: Sequence[S], accelerations: Sequence[S], forms: Sequence[JointForm] = ()
) -> list[S]:
    """Torques and forces of the joints, friction left out.

    Args:
        chain: The arm.
        velocities: qd, n entries.
        accelerations: qdd, n entries.
        forms: One for each joint, those by which the chain was arranged; or none.

    Returns:
        B qdd + C qd + g, n entries.
    """
    speed, gain = rates(chain, velocities), rates(chain, accelerations)
    motions = link_motions(chain, speed, gain, forms)
    torques: list[S] = []
    force = moment = _null(chain)
    for i in range(chain.n - 1, -1, -1):
        joint, motion, before = chain.joints[i], motions[i + 1], motions[i]
        own_force, own_moment = body_wrench(chain.bodies[i], motion, (forms[i] if forms else PLAIN).second_moments)
        force, moment = add(force, _with_axial(chain, i, own_force, motion)), add(moment, own_moment)
        torque = work(joint, force, moment) + rotor_torque(joint, before, gain[i])
        torques.append(torque if joint.sign > 0 else -torque)
        force, moment = _inward(joint, force, moment)
        moment = add(moment, rotor_moment(joint, before.omega, speed[i], gain[i]))
    return torques[::-1]


def body_wrench(body: Body[S], motion: LinkMotion[S], second_moments: bool = False) -> tuple[Vector[S], Vector[S]]:
    """Force and moment (at the origin) that move a body.

    Args:
        body: The body.
        motion: Its motion.
        second_moments: P_zz of the body is zero: the moment is written in second moments.
    """
    u, a, h = motion.spread, motion.acceleration, body.first_moment
    force = add(scale(body.mass, a), multiply(u, h))
    spin = _planar_spin if second_moments else _spin
    return force, add(spin(body.inertia, motion), cross(h, a))


def _spin(i: Symmetric[S], motion: LinkMotion[S]) -> Vector[S]:
    """I alpha + omega x (I omega), with the products of omega shared with U."""
    u, steps = motion.spread, motion.diagonal_steps
    (x, y, z), (ax, ay, az) = motion.omega, motion.alpha
    return (
        (i.xx * ax + (i.zz - i.yy) * (y * z)) + (i.xz * u[1][0] - i.xy * u[2][0]) - i.yz * steps[0],
        (i.yy * ay + (i.xx - i.zz) * (x * z)) + (i.xy * u[2][1] - i.yz * u[0][1]) - i.xz * steps[1],
        (i.zz * az + (i.yy - i.xx) * (x * y)) + (i.yz * u[0][2] - i.xz * u[1][2]) - i.xy * steps[2],
    )


def _planar_spin(i: Symmetric[S], motion: LinkMotion[S]) -> Vector[S]:
    """The same in second moments P, sum m r x (U r), where P_zz = 0: P_xx = I_yy, P_yy = I_xx."""
    u, steps = motion.spread, motion.diagonal_steps
    return (
        i.xx * u[2][1] + (i.xz * u[1][0] - i.xy * u[2][0]) - i.yz * steps[0],
        (i.xy * u[2][1] - i.yz * u[0][1]) - i.yy * u[2][0] - i.xz * steps[1],
        (i.yy * u[1][0] - i.xx * u[0][1]) + (i.yz * u[0][2] - i.xz * u[1][2]) - i.xy * steps[2],
    )


def _with_axial(chain: Chain[S], i: int, force: Vector[S], motion: LinkMotion[S]) -> Vector[S]:
    if not chain.axial:
        return force
    return (force[0], force[1], force[2] + chain.axial[i] * motion.acceleration[2])


def rotor_torque(joint: ChainJoint[S], before: LinkMotion[S], growth: S) -> S:
    """What the joint's own rotor asks of it."""
    return joint.coupling * dot(axis(joint), before.alpha) + joint.reflected * growth


def rotor_moment(joint: ChainJoint[S], omega: Vector[S], rate: S, growth: S) -> Vector[S]:
    """What the rotor of a joint asks of the link that carries it, beyond a rigid part of that link."""
    u = axis(joint)
    turn = cross(omega, u)
    return scale(joint.coupling, add(scale(growth, u), scale(rate, turn)))


def _inward(joint: ChainJoint[S], force: Vector[S], moment: Vector[S]) -> tuple[Vector[S], Vector[S]]:
    turned = to_parent(joint, force)
    return turned, add(to_parent(joint, moment), cross(origin(joint), turned))


def _null(chain: Chain[S]) -> Vector[S]:
    return (chain.zero, chain.zero, chain.zero)

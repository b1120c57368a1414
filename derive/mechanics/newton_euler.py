"""Inverse dynamics by the Newton-Euler recursion, in joint frames, rotors included.

Outward, angular velocity, angular acceleration and the acceleration of the origin, gravity taken as an acceleration of
the base (Luh, Walker and Paul 1980); inward, forces and moments. In every link the products of angular velocities
appear once: the acceleration of a point r is a + U r with U = omegadot^ + omega^ omega^, and moments are written in
entries of U (Khalil and Kleinfinger, 1987). The rotor of joint i adds to link i-1 the moment c (rate_dot u + rate
omega x u) and to its own torque c u . omegadot + ratio^2 I rate_dot, with u its axis and omega of link i-1 (Siciliano
et al., Robotics, section 7.3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import axis, origin, rates, to_child, to_parent, work
from derive.mechanics.vectors import Matrix, S, Vector, add, cross, dot, multiply, scale


@dataclass(frozen=True, slots=True)
class LinkMotion(Generic[S]):
    """The motion of one link, in its joint frame.

    Attributes:
        omega: Angular velocity.
        alpha: Angular acceleration.
        spread: U = alpha^ + omega^ omega^; a point at r accelerates with ``acceleration + U r``.
        acceleration: Acceleration of the origin, less gravity.
    """

    omega: Vector[S]
    alpha: Vector[S]
    spread: Matrix[S]
    acceleration: Vector[S]


def inverse_dynamics(chain: Chain[S], velocities: Sequence[S], accelerations: Sequence[S]) -> list[S]:
    """Torques and forces of the joints, friction left out.

    Args:
        chain: The arm.
        velocities: qd, n entries.
        accelerations: qdd, n entries.

    Returns:
        B qdd + C qd + g, n entries.
    """
    speed, gain = rates(chain, velocities), rates(chain, accelerations)
    motions = link_motions(chain, speed, gain)
    torques: list[S] = []
    force = moment = _null(chain)
    for i in range(chain.n - 1, -1, -1):
        joint, motion, before = chain.joints[i], motions[i + 1], motions[i]
        own_force, own_moment = body_wrench(chain.bodies[i], motion)
        force, moment = add(force, own_force), add(moment, own_moment)
        torque = work(joint, force, moment) + rotor_torque(joint, before, gain[i])
        torques.append(torque if joint.sign > 0 else -torque)
        force, moment = _inward(joint, force, moment)
        moment = add(moment, rotor_moment(joint, before.omega, speed[i], gain[i]))
    return torques[::-1]


def link_motions(chain: Chain[S], speed: Sequence[S], gain: Sequence[S]) -> list[LinkMotion[S]]:
    """Base and links 1..n, from rates and their derivatives."""
    rest = _null(chain)
    lift: Vector[S] = (-chain.gravity[0], -chain.gravity[1], -chain.gravity[2])
    motions = [_motion(rest, rest, lift)]
    for joint, rate, growth in zip(chain.joints, speed, gain, strict=True):
        motions.append(_outward(joint, motions[-1], rate, growth))
    return motions


def _outward(joint: ChainJoint[S], before: LinkMotion[S], rate: S, growth: S) -> LinkMotion[S]:
    omega, alpha = to_child(joint, before.omega), to_child(joint, before.alpha)
    moved = add(before.acceleration, multiply(before.spread, origin(joint)))
    acceleration = to_child(joint, moved)
    x, y, z = omega
    if joint.revolute:
        turn = (alpha[0] + rate * y, alpha[1] - rate * x, alpha[2] + growth)
        return _motion((x, y, z + rate), turn, acceleration)
    twice = rate + rate
    slide = (twice * y, -(twice * x), growth)
    return _motion(omega, alpha, add(acceleration, slide))


def _motion(omega: Vector[S], alpha: Vector[S], acceleration: Vector[S]) -> LinkMotion[S]:
    x, y, z = omega
    xx, yy, zz = x * x, y * y, z * z
    xy, xz, yz = x * y, x * z, y * z
    spread = (
        (-(yy + zz), xy - alpha[2], xz + alpha[1]),
        (xy + alpha[2], -(xx + zz), yz - alpha[0]),
        (xz - alpha[1], yz + alpha[0], -(xx + yy)),
    )
    return LinkMotion(omega, alpha, spread, acceleration)


def body_wrench(body: Body[S], motion: LinkMotion[S]) -> tuple[Vector[S], Vector[S]]:
    """Force and moment (at the origin) that move a body."""
    u, a, h = motion.spread, motion.acceleration, body.first_moment
    force = add(scale(body.mass, a), multiply(u, h))
    return force, add(_spin_moment(body, motion), cross(h, a))


def _spin_moment(body: Body[S], motion: LinkMotion[S]) -> Vector[S]:
    """I alpha + omega x (I omega), with the products of omega shared with U."""
    i, u = body.inertia, motion.spread
    (x, y, z), (ax, ay, az) = motion.omega, motion.alpha
    return (
        (i.xx * ax + (i.zz - i.yy) * (y * z)) + (i.xz * u[1][0] - i.xy * u[2][0]) + i.yz * (y * y - z * z),
        (i.yy * ay + (i.xx - i.zz) * (x * z)) + (i.xy * u[2][1] - i.yz * u[0][1]) + i.xz * (z * z - x * x),
        (i.zz * az + (i.yy - i.xx) * (x * y)) + (i.yz * u[0][2] - i.xz * u[1][2]) + i.xy * (x * x - y * y),
    )


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

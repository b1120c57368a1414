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
from derive.mechanics.inertia_matrix import Wrench, wrench_to_parent
from derive.mechanics.joint_motion import along_axes, axis, generalized_force
from derive.mechanics.link_motion import PLAIN, FrameChoice, LinkMotion, link_motions
from derive.mechanics.vectors import S, Vector, add, cross, dot, multiply, scale


def inverse_dynamics(
    chain: Chain[S], qd: Sequence[S], qdd: Sequence[S], choices: Sequence[FrameChoice] = ()
) -> list[S]:
    """Torques and forces of the joints, friction left out.

    Args:
        chain: The arm.
        qd: Joint velocities, n entries.
        qdd: Joint accelerations, n entries.
        choices: One for each joint, those by which the chain was arranged; or none.

    Returns:
        B qdd + C qd + g, n entries [N m or N].
    """
    rates, accelerations = along_axes(chain, qd), along_axes(chain, qdd)
    motions = link_motions(chain, rates, accelerations, choices)
    torques: list[S] = []
    force = moment = chain.null
    for i in range(chain.n - 1, -1, -1):
        joint, motion, before = chain.joints[i], motions[i + 1], motions[i]
        own_force, own_moment = body_wrench(chain.bodies[i], motion, (choices[i] if choices else PLAIN).second_moments)
        if chain.axial:
            along_z = own_force[2] + chain.axial[i] * motion.acceleration[2]
            own_force = (own_force[0], own_force[1], along_z)
        force, moment = add(force, own_force), add(moment, own_moment)
        own_rotor = joint.coupling * dot(axis(joint), before.alpha) + joint.armature * accelerations[i]
        torque = generalized_force(joint, force, moment) + own_rotor
        torques.append(torque if joint.sign > 0 else -torque)
        force, moment = wrench_to_parent(joint, (force, moment))
        moment = add(moment, rotor_moment(joint, before.omega, rates[i], accelerations[i]))
    return torques[::-1]


def body_wrench(body: Body[S], motion: LinkMotion[S], second_moments: bool = False) -> Wrench[S]:
    """Force and moment (at the origin) that move a body.

    Args:
        body: The body, in its joint frame.
        motion: Its motion, in the same frame.
        second_moments: P_zz of the body is zero: the moment is written in second moments.

    Returns:
        m a + U h and sum m r x (U r) + h x a.
    """
    u, a, h = motion.tensor, motion.acceleration, body.first_moment
    force = add(scale(body.mass, a), multiply(u, h))
    i, differences = body.inertia, motion.diagonal_differences
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


def rotor_moment(joint: ChainJoint[S], omega: Vector[S], rate: S, acceleration: S) -> Vector[S]:
    """Moment that the rotor of a joint asks of the link that carries it, beyond a rigid part of that link.

    Args:
        joint: Joint i.
        omega: Angular velocity of link i-1, in its joint frame.
        rate: Velocity of the joint positive about +z.
        acceleration: Its acceleration.

    Returns:
        c (acceleration u + rate omega x u), in joint frame i-1.
    """
    u = axis(joint)
    turn = cross(omega, u)
    return scale(joint.coupling, add(scale(acceleration, u), scale(rate, turn)))

"""Kinetic and potential energy by recursion, rotors included.

*Kinetic*: a body whose frame moves with v and turns with omega has, with its linear parameters m, h and I about the
frame's origin, the energy m v.v/2 + v.(omega x h) + omega.I omega/2. The rotor of joint i is a rigid part of link i-1
but for its own spin, which adds c rate (u.omega) + a rate^2/2, with u its axis, omega of link i-1, c = ratio I and a
what resists the joint's own acceleration (Siciliano et al., Robotics, section 7.1).

*Potential*: U = -sum m g.p, zero at the world's origin. Gravity is turned outward as far as some link, the first
moments of all beyond are carried inward to it: where the two meet changes the cost and not the value.
"""

from collections.abc import Sequence

from derive.mechanics.chain import Chain
from derive.mechanics.joint_motion import along_axes, axis, origin, to_child, to_parent
from derive.mechanics.vectors import S, Vector, add, cross, dot, scale


def kinetic_energy(chain: Chain[S], qd: Sequence[S], half: S, base: tuple[Vector[S], Vector[S]] | None = None) -> S:
    """T = qd^T B qd / 2; ``base``: velocity and angular velocity of frame 0 in its own axes, None where it stands."""
    twice, once = chain.zero, chain.zero
    moving = [base or (chain.null, chain.null)]
    for i, (joint, rate) in enumerate(zip(chain.joints, along_axes(chain, qd), strict=True)):
        velocity, omega = moving[joint.parent + 1]
        once = once + joint.coupling * rate * dot(axis(joint), omega)
        twice = twice + joint.armature * (rate * rate)
        velocity = to_child(joint, add(velocity, cross(omega, origin(joint))))
        omega = to_child(joint, omega)
        if joint.revolute:
            omega = (omega[0], omega[1], omega[2] + rate)
        else:
            velocity = (velocity[0], velocity[1], velocity[2] + rate)
        moving.append((velocity, omega))
        body, (x, y, z) = chain.bodies[i], omega
        tensor = body.inertia
        once = once + dot(body.first_moment, cross(velocity, omega))
        once = once + tensor.xy * (x * y) + tensor.xz * (x * z) + tensor.yz * (y * z)
        twice = twice + tensor.xx * (x * x) + tensor.yy * (y * y) + tensor.zz * (z * z)
        twice = twice + body.mass * dot(velocity, velocity)
        if chain.axial:
            twice = twice + chain.axial[i] * (velocity[2] * velocity[2])
    return half * twice + once


def potential_energy(chain: Chain[S], meeting: int = 0) -> S:
    """U = -sum m g.p over links and rotors."""
    assert not chain.axial, "axial masses have no place"
    beyond = [(chain.zero, chain.null)] * (chain.n + 1)  # masses and moments that the base and each link carry
    for i in range(chain.n - 1, meeting - 1, -1):
        joint, body, (mass, moment) = chain.joints[i], chain.bodies[i], beyond[i + 1]
        mass, moment = mass + body.mass, add(moment, body.first_moment)
        moment = add(to_parent(joint, moment), scale(mass, origin(joint)))
        others = beyond[joint.parent + 1]
        beyond[joint.parent + 1] = others[0] + mass, add(others[1], moment)
    fields = [(chain.gravity, chain.drop)]
    work = dot(chain.gravity, chain.ground.first_moment) + chain.drop * chain.ground.mass
    for joint, body in zip(chain.joints[:meeting], chain.bodies[:meeting], strict=True):
        gravity, drop = fields[joint.parent + 1]
        drop, gravity = drop + dot(gravity, origin(joint)), to_child(joint, gravity)
        fields.append((gravity, drop))
        work = work + dot(gravity, body.first_moment) + drop * body.mass
    for (gravity, drop), (mass, moment) in zip(fields, beyond[: meeting + 1], strict=True):
        work = work + dot(gravity, moment) + drop * mass
    return -work

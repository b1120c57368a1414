"""Energies by recursion, and what follows from them: inertia matrix and gravity vector; rotors included.

*Inertia matrix*, by composite rigid bodies: for joint j everything outward of it moves as one body when joint j alone
moves; the wrench that this takes per unit of acceleration, carried inward, has the components B_ij (Walker and Orin
1982; Featherstone, Rigid Body Dynamics Algorithms, ch. 6). The rotor of joint j, carried by link j-1, adds ratio^2 I on
the diagonal and the moment ratio I z_j on link j-1.

*Gravity vector*, by composite first moments: g_i is the moment (force) of the weight of all that joint i carries about
(along) its axis, against gravity: with the acceleration of gravity gamma in joint frame i, g_i = -(h x gamma)_z for a
revolute joint and -m gamma_z for a prismatic one.

*Kinetic*: a body whose frame moves with v and turns with omega has, with its linear parameters m, h and I about the
frame's origin, the energy m v.v/2 + v.(omega x h) + omega.I omega/2. The rotor of joint i is a rigid part of link i-1
but for its own spin, which adds c rate (u.omega) + a rate^2/2, with u its axis, omega of link i-1, c = ratio I and a
what resists the joint's own acceleration (Siciliano et al., Robotics, section 7.1).

*Potential*: U = -sum m g.p, zero at the world's origin. Gravity is turned outward as far as some link, the first
moments of all beyond are carried inward to it: where the two meet changes the cost and not the value.
"""

from collections.abc import Sequence

from derive.mechanics import joint_motion
from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import along_axes, axis, generalized_force, origin, to_child, to_parent
from derive.mechanics.vectors import S, Vector, add, cross, dot, scale

Wrench = tuple[Vector[S], Vector[S]]  # force, and moment about the origin of the frame in whose axes both are written


def inertia_matrix(chain: Chain[S]) -> list[list[S]]:
    """B(q), symmetric, in the joint variables: kinetic energy is qd^T B qd / 2."""
    composites = list(chain.bodies)
    for i in range(chain.n - 1, 0, -1):
        if (before := chain.joints[i].parent) >= 0:
            composites[before] = composites[before] + joint_motion.body_to_parent(chain.joints[i], composites[i])
    matrix = [[chain.zero] * chain.n for _ in range(chain.n)]
    for j, joint in enumerate(chain.joints):
        wrench = unit_wrench(chain, joint, composites[j])
        matrix[j][j] = generalized_force(joint, *wrench) + joint.armature
        for i, outer in chain.inward(j):
            wrench = wrench_to_parent(outer, wrench)
            if outer is joint:
                wrench = (wrench[0], add(wrench[1], scale(joint.coupling, axis(joint))))
            entry = generalized_force(chain.joints[i], *wrench)
            matrix[i][j] = matrix[j][i] = entry if joint.sign == chain.joints[i].sign else -entry
    return matrix


def unit_wrench(chain: Chain[S], joint: ChainJoint[S], body: Body[S]) -> Wrench[S]:
    """The wrench that gives a joint a unit acceleration from rest."""
    x, y, _ = body.first_moment
    if joint.revolute:
        return (-y, x, chain.zero), (body.inertia.xz, body.inertia.yz, body.inertia.zz)
    return (chain.zero, chain.zero, body.mass), (y, -x, chain.zero)


def wrench_to_parent(joint: ChainJoint[S], wrench: Wrench[S]) -> Wrench[S]:
    """A wrench of joint frame i at the origin, and in the axes, of joint frame i-1."""
    force = to_parent(joint, wrench[0])
    return force, add(to_parent(joint, wrench[1]), cross(origin(joint), force))


def gravity_vector(chain: Chain[S]) -> list[S]:
    """g(q) = dU/dq, n entries [N m or N]."""
    gravities = [chain.gravity]
    for joint in chain.joints:
        gravities.append(to_child(joint, gravities[joint.parent + 1]))
    torques: list[S] = []
    beyond = [(chain.zero, chain.null)] * (chain.n + 1)  # masses and moments that the base and each link carry
    for i in range(chain.n - 1, -1, -1):
        joint, body, gamma, (mass, moment) = chain.joints[i], chain.bodies[i], gravities[i + 1], beyond[i + 1]
        mass, moment = mass + body.mass, add(moment, body.first_moment)
        torque = moment[1] * gamma[0] - moment[0] * gamma[1] if joint.revolute else -(mass * gamma[2])
        torques.append(torque if joint.sign > 0 else -torque)
        others = beyond[joint.parent + 1]
        moved = add(to_parent(joint, moment), scale(mass, origin(joint)))
        beyond[joint.parent + 1] = others[0] + mass, add(others[1], moved)
    return torques[::-1]


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

"""The inertia matrix by composite rigid bodies, rotors included, and the gravity vector by composite first moments.

For joint j everything outward of it moves as one body when joint j alone moves; the wrench that this takes per unit of
acceleration, carried inward, has the components B_ij (Walker and Orin 1982; Featherstone, Rigid Body Dynamics
Algorithms, ch. 6). The rotor of joint j, carried by link j-1, adds ratio^2 I on the diagonal and the moment ratio I
z_j on link j-1.

g_i is the moment (force) of the weight of all that joint i carries about (along) its axis, against gravity: with the
acceleration of gravity gamma in joint frame i, g_i = -(h x gamma)_z for a revolute joint and -m gamma_z for a
prismatic one.
"""

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import axis, body_to_parent, generalized_force, origin, to_child, to_parent
from derive.mechanics.vectors import S, Vector, add, cross, scale

Wrench = tuple[Vector[S], Vector[S]]  # force, and moment about the origin of the frame in whose axes both are written


def inertia_matrix(chain: Chain[S]) -> list[list[S]]:
    """B(q), symmetric, in the joint variables: kinetic energy is qd^T B qd / 2."""
    composites = list(chain.bodies)
    for i in range(chain.n - 1, 0, -1):
        if (before := chain.joints[i].parent) >= 0:
            composites[before] = composites[before] + body_to_parent(chain.joints[i], composites[i])
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

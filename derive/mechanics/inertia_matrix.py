"""The inertia matrix by composite rigid bodies, rotors included.

For joint j everything outward of it moves as one body when joint j alone moves; the wrench that this takes per unit of
acceleration, carried inward, has the components B_ij (Walker and Orin 1982; Featherstone, Rigid Body Dynamics
Algorithms, ch. 6). The rotor of joint j, carried by link j-1, adds ratio^2 I on the diagonal and the moment ratio I
z_j on link j-1.

The gravity vector by composite first moments.

g_i is the moment (force) of the weight of all that joint i carries about (along) its axis, against gravity: with the
acceleration of gravity gamma in joint frame i, g_i = -(h x gamma)_z for a revolute joint and -m gamma_z for a
prismatic one.
"""

from __future__ import annotations

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import axis, composite_bodies, origin, to_child, to_parent, work
from derive.mechanics.vectors import S, Vector, add, cross, scale

Wrench = tuple[Vector[S], Vector[S]]


def inertia_matrix(chain: Chain[S]) -> list[list[S]]:
    """B(q), nxn, symmetric, in the joint variables: kinetic energy is qd^T B qd / 2."""
    bodies = composite_bodies(chain)
    matrix = [[chain.zero] * chain.n for _ in range(chain.n)]
    for j, joint in enumerate(chain.joints):
        wrench = unit_wrench(chain, joint, bodies[j])
        matrix[j][j] = work(joint, *wrench) + joint.reflected
        for i in range(j - 1, -1, -1):
            wrench = wrench_to_parent(chain.joints[i + 1], wrench)
            if i == j - 1:
                wrench = (wrench[0], add(wrench[1], scale(joint.coupling, axis(joint))))
            entry = work(chain.joints[i], *wrench)
            matrix[i][j] = matrix[j][i] = entry if joint.sign == chain.joints[i].sign else -entry
    return matrix


def unit_wrench(chain: Chain[S], joint: ChainJoint[S], body: Body[S]) -> Wrench[S]:
    """Force and moment (at the joint frame's origin) for a unit acceleration of the joint from rest."""
    x, y, _ = body.first_moment
    if joint.revolute:
        return (-y, x, chain.zero), (body.inertia.xz, body.inertia.yz, body.inertia.zz)
    return (chain.zero, chain.zero, body.mass), (y, -x, chain.zero)


def wrench_to_parent(joint: ChainJoint[S], wrench: Wrench[S]) -> Wrench[S]:
    """The same wrench at the origin, and in the axes, of joint frame i-1."""
    force = to_parent(joint, wrench[0])
    return force, add(to_parent(joint, wrench[1]), cross(origin(joint), force))


def gravity_vector(chain: Chain[S]) -> list[S]:
    """g(q) = dU/dq, n entries."""
    gravities = _gravities(chain)
    entries: list[S] = []
    mass, moment = chain.zero, (chain.zero, chain.zero, chain.zero)
    for i in range(chain.n - 1, -1, -1):
        joint, body, gamma = chain.joints[i], chain.bodies[i], gravities[i]
        mass, moment = mass + body.mass, add(moment, body.first_moment)
        pull = moment[1] * gamma[0] - moment[0] * gamma[1] if joint.revolute else -(mass * gamma[2])
        entries.append(pull if joint.sign > 0 else -pull)
        moment = add(to_parent(joint, moment), scale(mass, origin(joint)))
    return entries[::-1]


def _gravities(chain: Chain[S]) -> list[Vector[S]]:
    """The acceleration of gravity in each joint frame."""
    found: list[Vector[S]] = []
    gamma = chain.gravity
    for joint in chain.joints:
        gamma = to_child(joint, gamma)
        found.append(gamma)
    return found

"""The inertia matrix by composite rigid bodies, rotors included.

For joint j everything outward of it moves as one body when joint j alone moves; the wrench that this takes per unit of
acceleration, carried inward, has the components B_ij (Walker and Orin 1982; Featherstone, Rigid Body Dynamics
Algorithms, ch. 6). The rotor of joint j, carried by link j-1, adds ratio^2 I on the diagonal and the moment ratio I
z_j on link j-1.
"""

from __future__ import annotations

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import axis, composite_bodies, origin, to_parent, work
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

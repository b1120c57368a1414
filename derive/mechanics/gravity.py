"""The gravity vector by composite first moments.

g_i is the moment (force) of the weight of all that joint i carries about (along) its axis, against gravity: with the
acceleration of gravity gamma in joint frame i, g_i = -(h x gamma)_z for a revolute joint and -m gamma_z for a
prismatic one.
"""

from __future__ import annotations

from derive.mechanics.chain import Chain
from derive.mechanics.joint_motion import origin, to_child, to_parent
from derive.mechanics.vectors import S, Vector, add, scale


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

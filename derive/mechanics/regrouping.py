"""Inertial parameters that act only in combination, moved to where they cost nothing (base parameters).

Whatever part of link i looks the same however joint i moves belongs as well to link i-1. For a revolute joint this is
a part symmetric about z_i: mass, m r_z and an inertia diag(w, w, 0); for a prismatic joint it is the whole inertia
tensor (that of a body without mass). Moving w = I_yy leaves links without mass, m r_z and I_yy behind revolute joints,
and a regrouped tensor inward, exactly and for any numbers (Gautier and Khalil, IEEE Trans. Robotics and Automation
6(3), 1990; Khalil and Dombre, Modeling, Identification and Control of Robots, ch. 9). Inertia matrix, Coriolis matrix,
gravity and torques do not change.
"""

from __future__ import annotations

from dataclasses import replace

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import origin, shift, turn_about_z, turn_tensor
from derive.mechanics.vectors import S, Symmetric, Vector, add, multiply, scale


def regroup(chain: Chain[S]) -> Chain[S]:
    """The same arm with as many inertial parameters zero as this rule makes."""
    bodies = list(chain.bodies)
    if not bodies:
        return chain
    for i in range(chain.n - 1, -1, -1):
        joint = chain.joints[i]
        kept, moved = (_split_revolute if joint.revolute else _split_prismatic)(chain, bodies[i])
        bodies[i] = kept
        if i:
            bodies[i - 1] = bodies[i - 1] + _invariant_to_parent(joint, moved)
    return replace(chain, bodies=tuple(bodies))


def _split_revolute(chain: Chain[S], body: Body[S]) -> tuple[Body[S], Body[S]]:
    """What stays, and the part symmetric about z."""
    z, i = chain.zero, body.inertia
    x, y, along = body.first_moment
    kept = Body(z, (x, y, z), Symmetric(i.xx - i.yy, z, i.zz, i.xy, i.xz, i.yz))
    return kept, Body(body.mass, (z, z, along), Symmetric(i.yy, i.yy, z, z, z, z))


def _split_prismatic(chain: Chain[S], body: Body[S]) -> tuple[Body[S], Body[S]]:
    """What stays, and the tensor alone."""
    z = chain.zero
    none = Symmetric(z, z, z, z, z, z)
    return Body(body.mass, body.first_moment, none), Body(z, (z, z, z), body.inertia)


def _invariant_to_parent(joint: ChainJoint[S], body: Body[S]) -> Body[S]:
    """As `body_to_parent`, for a part on which a revolute joint's angle has no effect."""
    turn = joint.fixed.rotation
    if not joint.revolute:
        tensor = turn_tensor(turn, turn_about_z(joint.cosine, joint.sine, body.inertia))
        return Body(body.mass, body.first_moment, tensor)
    p: Vector[S] = origin(joint)
    moment = multiply(turn, body.first_moment)
    moved = shift(body.mass, moment, turn_tensor(turn, body.inertia), p)
    return Body(body.mass, add(moment, scale(body.mass, p)), moved)

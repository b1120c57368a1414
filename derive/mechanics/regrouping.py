"""Inertial parameters that act only in combination, moved to where they cost nothing (base parameters).

Whatever part of link i looks the same however joint i moves belongs as well to link i-1. For a revolute joint this is
a part symmetric about z_i: mass, m r_z and an inertia diag(w, w, 0); for a prismatic joint it is the whole inertia
tensor (that of a body without mass). Moving w = I_yy, or w = P_zz = (I_xx + I_yy - I_zz)/2 with P the second moments,
leaves links without mass, m r_z and w behind revolute joints, and a regrouped tensor inward, exactly and for any
numbers (Gautier and Khalil, IEEE Trans. Robotics and Automation 6(3), 1990; Khalil and Dombre, Modeling, Identification
and Control of Robots, ch. 9). Inertia matrix, Coriolis matrix, gravity and torques do not change.

A prismatic joint along the axis about which all joints before it turn leaves all of its link to link i-1 but for what
the mass does along z: an *axial* mass, which Newton-Euler knows (`Chain.axial`) and the other recursions do not.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import body_to_parent, origin, shift, tensor_to_parent, turn_tensor
from derive.mechanics.vectors import S, Symmetric, add, multiply, scale


@dataclass(frozen=True, slots=True)
class Rule:
    """What is moved inward from a link."""

    second_moments: bool = False  # from a revolute joint's link P_zz, else I_yy
    axial: bool = False  # from a prismatic joint's link all but its axial mass; its joint must allow it


def regroup(chain: Chain[S], rules: Sequence[Rule] = (), half: S | None = None) -> Chain[S]:
    """The same arm with as many inertial parameters zero as this rule makes."""
    bodies = list(chain.bodies)
    if not bodies:
        return chain
    axial = [chain.zero] * chain.n
    ground = chain.ground
    for i in range(chain.n - 1, -1, -1):
        joint, body, rule = chain.joints[i], bodies[i], rules[i] if rules else Rule()
        before = joint.parent
        if rule.axial and before >= 0:
            bodies[i], moved = _massless(chain), body_to_parent(replace(joint, offset=chain.zero), body)
            axial[i], axial[before] = axial[i] + body.mass, axial[before] - body.mass
        elif joint.revolute:
            bodies[i], moved = _split_revolute(chain, joint, body, half if rule.second_moments else None)
            if before >= 0:
                axial[i], axial[before] = chain.zero, axial[before] + axial[i]
        else:
            still = _massless(chain)
            bodies[i] = replace(still, mass=body.mass, first_moment=body.first_moment)
            moved = replace(still, inertia=tensor_to_parent(joint, body.inertia))
        if before >= 0:
            bodies[before] = bodies[before] + moved
        else:
            ground = ground + moved
    masses = tuple(axial) if any(rule.axial for rule in rules) else ()
    return replace(chain, bodies=tuple(bodies), ground=ground, axial=masses)


def _massless(chain: Chain[S]) -> Body[S]:
    z = chain.zero
    return Body(z, chain.null, Symmetric(z, z, z, z, z, z))


def _split_revolute(chain: Chain[S], joint: ChainJoint[S], body: Body[S], half: S | None) -> tuple[Body[S], Body[S]]:
    """What stays, and in joint frame i-1 the part symmetric about the axis: with ``half`` P_zz moves, else I_yy."""
    z, i = chain.zero, body.inertia
    x, y, along = body.first_moment
    if half is not None:
        w = half * ((i.xx + i.yy) - i.zz)
        xx, yy = half * ((i.xx + i.zz) - i.yy), half * ((i.yy + i.zz) - i.xx)
    else:
        w, xx, yy = i.yy, i.xx - i.yy, z
    kept = Body(z, (x, y, z), Symmetric(xx, yy, i.zz, i.xy, i.xz, i.yz))
    turn, p = joint.fixed.rotation, origin(joint)
    moment = multiply(turn, (z, z, along))
    tensor = shift(body.mass, moment, turn_tensor(turn, Symmetric(w, w, z, z, z, z)), p)
    return kept, Body(body.mass, add(moment, scale(body.mass, p)), tensor)

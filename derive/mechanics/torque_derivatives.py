"""Derivatives of the joint torques with respect to q and qd, by composite bodies, rotors included.

All that joint j carries meets the rest of the arm through the motion of its link: angular velocity omega, angular
acceleration alpha and acceleration a of the origin, all in joint frame j. When the base of that part is turned about z
by -dq_j, or shifted, the motion changes by

    d omega = zdot,  d alpha + omega x d omega = zddot,  d a = a x z  (revolute);    d a = zddot  (prismatic),

with zdot = omega x z, zddot = U z and U = alpha^ + omega^ omega^. The wrench that joint j carries answers by

    df = m da + zddot x h + 2 zdot x hdot,    dn = h x da + I zddot + 2 D zdot,

with the moments m, h, hdot, I and D of `derive.mechanics.coriolis`; seen from the links before, it also turns with the
joint (revolute) or gets another lever (prismatic). Carried inward it has the components d tau_i / d q_j, i < j. For i >
j, the torque of joint i answers the same three changes through the wrench u, eta that accelerates joint i alone and
through delta, carried inward: d tau_i = u . da + eta . zddot + 2 delta . zdot.

Since the Christoffel symbols are symmetric in their last two indices, d(C qd)/d qd = 2 C.

The composite formulas of Carpentier and Mansard (RSS 2018) and of Singh, Russell and Wensing (IEEE Robotics and
Automation Letters 7(2), 2022) compute the same in one frame for all links; in joint frames most of their entries are
zero or shared with Newton-Euler.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.coriolis import ClosedColumn, MovingBody, christoffel_matrix, column_to_parent, moving_composites
from derive.mechanics.inertia_matrix import Wrench, unit_wrench, wrench_to_parent
from derive.mechanics.joint_motion import axis, rates, work
from derive.mechanics.link_motion import PLAIN, JointForm, LinkMotion, link_motions
from derive.mechanics.newton_euler import body_wrench, rotor_moment
from derive.mechanics.vectors import S, Symmetric, Vector, add, cross, dot, multiply, scale


def torque_velocity_derivative(chain: Chain[S], velocities: Sequence[S], half: S) -> list[list[S]]:
    """d tau / d qd, nxn, row i for tau_i: 2 C plus viscous friction; that of Coulomb friction is 0.

    The factor 2 is on the inertial parameters, where it costs nothing at run time.

    Args:
        chain: The arm.
        velocities: qd, n entries.
        half: The scalar 1/2.
    """
    matrix = christoffel_matrix(_doubled(chain), velocities, half)
    for i, joint in enumerate(chain.joints):
        matrix[i][i] = matrix[i][i] + joint.viscous
    return matrix


def torque_position_derivative(
    chain: Chain[S], velocities: Sequence[S], accelerations: Sequence[S], half: S, forms: Sequence[JointForm] = ()
) -> list[list[S]]:
    """d tau / d q, nxn, row i for tau_i.

    Args:
        chain: The arm.
        velocities: qd, n entries.
        accelerations: qdd, n entries.
        half: The scalar 1/2.
        forms: One for each joint, those by which the chain was arranged; or none.
    """
    speed, gain = rates(chain, velocities), rates(chain, accelerations)
    motions = link_motions(chain, speed, gain, forms)
    wrenches = _carried_wrenches(chain, motions, speed, gain, forms)
    omegas = [motion.omega for motion in motions]
    bodies = moving_composites(chain, speed, omegas, half)
    matrix = [[chain.zero] * chain.n for _ in range(chain.n)]
    for j, joint in enumerate(chain.joints):
        column = _column(chain, joint, bodies[j], motions[j + 1])
        matrix[j][j] = work(joint, column.force, column.moment)
        column = _with_carried_wrench(joint, column, wrenches[j])
        for i in range(j - 1, -1, -1):
            column = column_to_parent(chain.joints[i + 1], column, omegas[i + 1], speed[i + 1])
            if i == j - 1:
                column = _with_rotor(column, joint, omegas[j], half)
            inner = chain.joints[i]
            upper = work(inner, column.force, column.moment)
            lower = _answer(inner, column, motions[i + 1])
            same = joint.sign == inner.sign
            matrix[i][j], matrix[j][i] = (upper, lower) if same else (-upper, -lower)
    return matrix


def _doubled(chain: Chain[S]) -> Chain[S]:
    """The same arm, twice as heavy."""
    bodies = tuple(_twice(body) for body in chain.bodies)
    joints = tuple(replace(joint, coupling=joint.coupling + joint.coupling) for joint in chain.joints)
    return replace(chain, bodies=bodies, joints=joints)


def _twice(body: Body[S]) -> Body[S]:
    i = body.inertia
    tensor = Symmetric(i.xx + i.xx, i.yy + i.yy, i.zz + i.zz, i.xy + i.xy, i.xz + i.xz, i.yz + i.yz)
    return Body(body.mass + body.mass, add(body.first_moment, body.first_moment), tensor)


def _carried_wrenches(
    chain: Chain[S],
    motions: Sequence[LinkMotion[S]],
    speed: Sequence[S],
    gain: Sequence[S],
    forms: Sequence[JointForm],
) -> list[Wrench[S]]:
    """For each joint, the wrench that moves all that it carries, at the origin of its frame."""
    zero = (chain.zero, chain.zero, chain.zero)
    force, moment = zero, zero
    found: list[Wrench[S]] = []
    for i in range(chain.n - 1, -1, -1):
        form = forms[i] if forms else PLAIN
        own_force, own_moment = body_wrench(chain.bodies[i], motions[i + 1], form.second_moments)
        force, moment = add(force, own_force), add(moment, own_moment)
        found.append((force, moment))
        force, moment = wrench_to_parent(chain.joints[i], (force, moment))
        moment = add(moment, rotor_moment(chain.joints[i], motions[i].omega, speed[i], gain[i]))
    return found[::-1]


def _spin(motion: LinkMotion[S], zero: S) -> Vector[S]:
    """The rate of change of the z axis."""
    x, y, _ = motion.omega
    return (y, -x, zero)


def _column(chain: Chain[S], joint: ChainJoint[S], moving: MovingBody[S], motion: LinkMotion[S]) -> ClosedColumn[S]:
    """How the wrench on all that joint j carries answers its variable, in frame j, and what its own torque answers."""
    h, hdot, e, body = moving.body.first_moment, moving.growth, moving.spread, moving.body
    unit, eta = unit_wrench(chain, joint, body)
    bend = tuple(row[2] for row in motion.spread)
    curve: Vector[S] = (bend[0], bend[1], bend[2])
    if not joint.revolute:
        delta = (hdot[1], -hdot[0], chain.zero)
        return ClosedColumn(scale(body.mass, curve), cross(h, curve), unit, eta, delta)
    turn = _spin(motion, chain.zero)
    twice = add(turn, turn)
    a = motion.acceleration
    shift: Vector[S] = (a[1], -a[0], chain.zero)
    force = add(add(scale(body.mass, shift), cross(curve, h)), cross(twice, hdot))
    x, y, _ = twice
    spread = (
        (e[1][1] + e[2][2]) * x - e[0][1] * y,
        (e[0][0] + e[2][2]) * y - e[1][0] * x,
        -(e[2][0] * x + e[2][1] * y),
    )
    moment = add(add(cross(h, shift), multiply(body.inertia.matrix, curve)), spread)
    return ClosedColumn(force, moment, unit, eta, (-e[2][0], -e[2][1], e[0][0] + e[1][1]))


def _with_carried_wrench(joint: ChainJoint[S], column: ClosedColumn[S], wrench: Wrench[S]) -> ClosedColumn[S]:
    """Seen from the links before, the wrench turns with a revolute joint and is shifted by a prismatic one."""
    (fx, fy, fz), (nx, ny, nz) = wrench
    zero = fz - fz
    lever: Vector[S] = (-fy, fx, zero)
    if not joint.revolute:
        return replace(column, moment=add(column.moment, lever))
    return replace(column, force=add(column.force, lever), moment=add(column.moment, (-ny, nx, nz - nz)))


def _with_rotor(column: ClosedColumn[S], joint: ChainJoint[S], omega: Vector[S], half: S) -> ClosedColumn[S]:
    """What the rotor of joint j, on link j-1, asks of the joint when that link moves otherwise."""
    u = axis(joint)
    eta = add(column.eta, scale(joint.coupling, u))
    delta = add(column.delta, scale(half * joint.coupling, cross(omega, u)))
    return replace(column, eta=eta, delta=delta)


def _answer(joint: ChainJoint[S], column: ClosedColumn[S], motion: LinkMotion[S]) -> S:
    """d tau_j / d q_i in rates, for joint i < j with link i in this motion."""
    curve = (motion.spread[0][2], motion.spread[1][2], motion.spread[2][2])
    if not joint.revolute:
        return dot(column.unit, curve)
    x, y, _ = motion.omega
    ax, ay, _ = motion.acceleration
    lever = column.delta[0] * y - column.delta[1] * x
    return (column.unit[0] * ay - column.unit[1] * ax) + dot(column.eta, curve) + (lever + lever)

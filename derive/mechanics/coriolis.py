"""The Christoffel Coriolis matrix by composite bodies, rotors included.

A rigid body is a sum of points, and for points C_ij = sum m J_i . dJ_j/dt is exactly the Christoffel matrix, J_i the
velocity of the point per unit rate of joint i. With x the place of a point seen from the origin of joint j and z the
joint's axis, J_j = z x x, so all that joint j carries enters through

    m,  h = sum m x,  hdot = sum m xdot,  I,  E = sum m xdot x^T,

and dJ_j/dt = zdot x x + z x xdot asks for the force zdot x h + z x hdot and the moment I zdot + D z, D = tr(E) 1 - E.
Carried inward, that wrench has the components C_ij, i < j. For row j, C_ji = eta . zdot_i + delta . z_i, where eta is
the moment of the wrench that accelerates joint j alone (B_ij = eta . z_i) and delta = D^T z plus the lever arms'
rates. The result agrees with the consistent factorisation of Echeandia and Wensing, J. Mechanisms and Robotics 13(6),
2021; the recursion is our own.

A rotor spinning at ``ratio*qd`` about u is a body of its own. Against the same rotor locked to its link, with c =
ratio I and omega of that link, it adds c rate/2 u^ to E of the link, c/2 omega x u to the moment of its column, c u to
eta and c/2 omega x u to delta of its row.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.composite_inertia import unit_wrench
from derive.mechanics.joint_motion import (
    angular_velocities,
    axis,
    body_to_parent,
    origin,
    rates,
    to_parent,
    turn_matrix,
    work,
)
from derive.mechanics.vectors import (
    Matrix,
    S,
    Vector,
    add,
    add_matrices,
    cross,
    hat,
    matmul,
    multiply,
    outer,
    scale,
    transpose,
)


@dataclass(frozen=True, slots=True)
class MovingBody(Generic[S]):
    """A composite body and how its moments change, in a joint frame.

    Attributes:
        body: Mass, first moment, inertia about the origin.
        growth: hdot = sum m xdot.
        spread: E = sum m xdot x^T.
    """

    body: Body[S]
    growth: Vector[S]
    spread: Matrix[S]

    def __add__(self, other: MovingBody[S]) -> MovingBody[S]:
        """Both together."""
        return MovingBody(
            self.body + other.body, add(self.growth, other.growth), add_matrices(self.spread, other.spread)
        )


@dataclass(frozen=True, slots=True)
class Column(Generic[S]):
    """What is carried inward for joint j.

    Attributes:
        force: Of the wrench of column j of C.
        moment: Of the same.
        unit: Force that accelerates joint j alone.
        eta: Moment of the same.
        delta: Moment that meets z_i in row j of C.
    """

    force: Vector[S]
    moment: Vector[S]
    unit: Vector[S]
    eta: Vector[S]
    delta: Vector[S]


def coriolis_matrix(chain: Chain[S], velocities: Sequence[S], half: S) -> list[list[S]]:
    """C(q, qd), nxn, in Christoffel form: C + C^T = dB/dt, C qd is the velocity torque.

    Args:
        chain: The arm.
        velocities: qd, n entries.
        half: The scalar 1/2.
    """
    speed = rates(chain, velocities)
    omegas = angular_velocities(chain, speed)
    bodies = moving_composites(chain, speed, omegas, half)
    matrix = [[chain.zero] * chain.n for _ in range(chain.n)]
    for j, joint in enumerate(chain.joints):
        column = _column(chain, joint, bodies[j], omegas[j + 1])
        matrix[j][j] = work(joint, column.force, column.moment)
        for i in range(j - 1, -1, -1):
            column = column_to_parent(chain.joints[i + 1], column, omegas[i + 1], speed[i + 1])
            if i == j - 1:
                column = _with_rotor(column, joint, omegas[j], half)
            upper, lower = _entries(chain.joints[i], column, omegas[i + 1])
            same = joint.sign == chain.joints[i].sign
            matrix[i][j], matrix[j][i] = (upper, lower) if same else (-upper, -lower)
    return matrix


def moving_composites(chain: Chain[S], speed: Sequence[S], omegas: Sequence[Vector[S]], half: S) -> list[MovingBody[S]]:
    """For each joint, all that it carries and how that moves, in its joint frame; ``omegas`` with that of the base."""
    bodies = [_moving(body, omega, half) for body, omega in zip(chain.bodies, omegas[1:], strict=True)]
    for i in range(chain.n - 1, 0, -1):
        joint = chain.joints[i]
        spin = hat(scale(half * joint.coupling * speed[i], axis(joint)), chain.zero)
        carried = _to_parent(joint, bodies[i], _origin_rate(joint, omegas[i], speed[i]))
        inner = bodies[i - 1] + carried
        bodies[i - 1] = MovingBody(inner.body, inner.growth, add_matrices(inner.spread, spin))
    return bodies


def _moving(body: Body[S], omega: Vector[S], half: S) -> MovingBody[S]:
    """One link: xdot = omega x x, so E = omega^ times the second moments."""
    i = body.inertia
    total = half * (i.xx + i.yy + i.zz)
    second = ((total - i.xx, -i.xy, -i.xz), (-i.xy, total - i.yy, -i.yz), (-i.xz, -i.yz, total - i.zz))
    columns = [cross(omega, row) for row in second]
    return MovingBody(body, cross(omega, body.first_moment), transpose((columns[0], columns[1], columns[2])))


def _to_parent(joint: ChainJoint[S], moving: MovingBody[S], rate: Vector[S]) -> MovingBody[S]:
    """Seen from the origin of joint frame i-1: x' = x + p, x'dot = xdot + pdot."""
    p = origin(joint)
    growth = to_parent(joint, moving.growth)
    body = body_to_parent(joint, moving.body)
    turned = matmul(
        matmul(joint.fixed.rotation, turn_matrix(joint.cosine, joint.sine, moving.spread)),
        transpose(joint.fixed.rotation),
    )
    spread = add_matrices(add_matrices(turned, outer(growth, p)), outer(rate, body.first_moment))
    return MovingBody(body, add(growth, scale(body.mass, rate)), spread)


def _origin_rate(joint: ChainJoint[S], omega: Vector[S], rate: S) -> Vector[S]:
    """Velocity of the origin of frame i seen from that of frame i-1, in frame i-1."""
    turning = cross(omega, origin(joint))
    return turning if joint.revolute else add(turning, scale(rate, axis(joint)))


def _column(chain: Chain[S], joint: ChainJoint[S], moving: MovingBody[S], omega: Vector[S]) -> Column[S]:
    """At the joint itself, in joint frame j; zdot = omega x z = (omega_y, -omega_x, 0)."""
    unit, eta = unit_wrench(chain, joint, moving.body)
    turn: Vector[S] = (omega[1], -omega[0], chain.zero)
    h, hdot, e, i = moving.body.first_moment, moving.growth, moving.spread, moving.body.inertia
    if not joint.revolute:
        force = scale(moving.body.mass, turn)
        return Column(force, cross(h, turn), unit, eta, (hdot[1], -hdot[0], chain.zero))
    planar = e[0][0] + e[1][1]
    force = add(cross(turn, h), (-hdot[1], hdot[0], chain.zero))
    moment = add(multiply(i.matrix, turn), (-e[0][2], -e[1][2], planar))
    return Column(force, moment, unit, eta, (-e[2][0], -e[2][1], planar))


def column_to_parent(joint: ChainJoint[S], column: Column[S], omega: Vector[S], rate: S) -> Column[S]:
    """From joint frame i to i-1; ``omega`` of link i-1, ``rate`` of joint i."""
    p = origin(joint)
    force, unit = to_parent(joint, column.force), to_parent(joint, column.unit)
    moment = add(to_parent(joint, column.moment), cross(p, force))
    eta = add(to_parent(joint, column.eta), cross(p, unit))
    delta = add(to_parent(joint, column.delta), cross(_origin_rate(joint, omega, rate), unit))
    return Column(force, moment, unit, eta, delta)


def _with_rotor(column: Column[S], joint: ChainJoint[S], omega: Vector[S], half: S) -> Column[S]:
    """The rotor of joint j, on link j-1."""
    u = axis(joint)
    turn = scale(half * joint.coupling, cross(omega, u))
    eta = add(column.eta, scale(joint.coupling, u))
    return Column(column.force, add(column.moment, turn), column.unit, eta, add(column.delta, turn))


def _entries(joint: ChainJoint[S], column: Column[S], omega: Vector[S]) -> tuple[S, S]:
    """C_ij and C_ji in rates, with omega of link i."""
    x, y, _ = omega
    if joint.revolute:
        return column.moment[2], column.delta[2] + (y * column.eta[0] - x * column.eta[1])
    return column.force[2], y * column.unit[0] - x * column.unit[1]

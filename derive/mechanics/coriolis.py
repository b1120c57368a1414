"""The Christoffel Coriolis matrix by composite bodies whose inner motion alone is carried inward, rotors included.

A rigid body is a sum of points, and for points C_ij = sum m J_i . dJ_j/dt is exactly the Christoffel matrix, J_i the
velocity of the point per unit rate of joint i. All that joint j carries, seen from the origin of its frame, enters with

    m,  h = sum m x,  P = sum m x x^T,  h' = sum m x',  E = sum m x' x^T,

where x' is the velocity seen *from link j*: rigid parts of it do not count, so E is zero for the last link and grows
inward by a joint's rate times z^ P and by no lever of a revolute joint. With omega of link j and the unit wrench
(u, eta) that accelerates joint j alone, u = z x h, eta = I z, column j of C is the wrench

    f = omega x u + z x h',   n = z x (-P omega) + (-E_xz, -E_yz, E_xx + E_yy)

for a revolute joint, m zdot and h x zdot for a prismatic one, zdot = omega x z; carried inward it has the components
C_ij, i < j. Row j is C_ji = kappa . z_i, where kappa begins as the rate of eta seen from link j less n. Inward, a
joint's rate takes eta x z from it and a lever p adds p x (u x omega). That C + C^T is the rate of B is built in.
Echeandia and Wensing, J. Mechanisms and Robotics 13(6), 2021, have the same matrix from another recursion.

A rotor spinning at ``ratio*qd`` about k is a body of its own. Against the same rotor locked to its link, with c =
ratio I and omega of that link, it adds c rate/2 k^ to E of the link, c/2 omega x k to n of its column, c k to eta and
the opposite of the former to kappa.

The Christoffel Coriolis matrix by composite bodies, rotors included.

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
from derive.mechanics.inertia_matrix import unit_wrench
from derive.mechanics.joint_motion import (
    angular_velocities,
    axis,
    body_to_parent,
    origin,
    rates,
    to_parent,
    turn_about_z,
    turn_matrix,
    turn_tensor,
    work,
)
from derive.mechanics.vectors import (
    Matrix,
    S,
    Symmetric,
    Vector,
    add,
    add_matrices,
    cross,
    hat,
    matmul,
    multiply,
    outer,
    scale,
    subtract,
    transpose,
)


@dataclass(frozen=True, slots=True)
class Carried(Generic[S]):
    """All that a joint carries and how it moves, seen from its link, in its frame.

    Attributes:
        mass: m.
        first: h = sum m x.
        second: P = sum m x x^T.
        first_rate: h' = sum m x'.
        spread: E = sum m x' x^T.
    """

    mass: S
    first: Vector[S]
    second: Symmetric[S]
    first_rate: Vector[S]
    spread: Matrix[S]


@dataclass(frozen=True, slots=True)
class Column(Generic[S]):
    """What goes inward for joint j.

    Attributes:
        force: Of the wrench of column j of C.
        moment: Of the same.
        unit: Force that accelerates joint j alone.
        eta: Moment of the same.
        kappa: Moment whose part along z_i is C_ji.
    """

    force: Vector[S]
    moment: Vector[S]
    unit: Vector[S]
    eta: Vector[S]
    kappa: Vector[S]


def christoffel_matrix(chain: Chain[S], velocities: Sequence[S], half: S) -> list[list[S]]:
    """C(q, qd), nxn, in Christoffel form: C + C^T = dB/dt, C qd is the velocity torque.

    Args:
        chain: The arm.
        velocities: qd, n entries.
        half: The scalar 1/2.
    """
    speed = rates(chain, velocities)
    omegas = angular_velocities(chain, speed)
    carried = _composites(chain, speed, half)
    matrix = [[chain.zero] * chain.n for _ in range(chain.n)]
    for j, joint in enumerate(chain.joints):
        column = (_revolute_column if joint.revolute else _prismatic_column)(chain, carried[j], omegas[j + 1])
        matrix[j][j] = work(joint, column.force, column.moment)
        for i in range(j - 1, -1, -1):
            column = _inward(chain.joints[i + 1], column, omegas[i + 1], speed[i + 1])
            if i == j - 1:
                column = _with_rotor(column, joint, omegas[j], half)
            inner = chain.joints[i]
            upper, lower = _entries(inner, column, omegas[i + 1])
            same = joint.sign == inner.sign
            matrix[i][j], matrix[j][i] = (upper, lower) if same else (-upper, -lower)
    return matrix


def _composites(chain: Chain[S], speed: Sequence[S], half: S) -> list[Carried[S]]:
    carried = [_resting(chain, body, half) for body in chain.bodies]
    for i in range(chain.n - 1, 0, -1):
        joint = chain.joints[i]
        moved = _to_parent(chain, joint, carried[i], speed[i])
        own = carried[i - 1]
        spin = hat(scale(half * joint.coupling * speed[i], axis(joint)), chain.zero)
        carried[i - 1] = Carried(
            own.mass + moved.mass,
            add(own.first, moved.first),
            own.second + moved.second,
            moved.first_rate,
            add_matrices(moved.spread, spin),
        )
    return carried


def _resting(chain: Chain[S], body: Body[S], half: S) -> Carried[S]:
    """A link alone: nothing moves seen from itself."""
    i, rest = body.inertia, (chain.zero, chain.zero, chain.zero)
    xx, yy, zz = half * ((i.yy + i.zz) - i.xx), half * ((i.xx + i.zz) - i.yy), half * ((i.xx + i.yy) - i.zz)
    second = Symmetric(xx, yy, zz, -i.xy, -i.xz, -i.yz)
    return Carried(body.mass, body.first_moment, second, rest, (rest, rest, rest))


def _to_parent(chain: Chain[S], joint: ChainJoint[S], carried: Carried[S], rate: S) -> Carried[S]:
    """Seen from link i-1, in joint frame i-1."""
    turned = _turned(joint, carried, rate)
    fixed, p = joint.fixed.rotation, origin(joint)
    first, first_rate = multiply(fixed, turned.first), multiply(fixed, turned.first_rate)
    spread = add_matrices(matmul(matmul(fixed, turned.spread), transpose(fixed)), outer(first_rate, p))
    second = _shifted(turned.mass, first, turn_tensor(fixed, turned.second), p)
    first = add(first, scale(turned.mass, p))
    if not joint.revolute:
        slide = scale(rate, axis(joint))
        first_rate = add(first_rate, scale(turned.mass, slide))
        spread = add_matrices(spread, outer(slide, first))
    return Carried(turned.mass, first, second, first_rate, spread)


def _turned(joint: ChainJoint[S], carried: Carried[S], rate: S) -> Carried[S]:
    """Before the joint's turn, which for a revolute joint adds rate z x x to every x'."""
    c, s = joint.cosine, joint.sine
    first, (x, y, z) = _about_z(c, s, carried.first), _about_z(c, s, carried.first_rate)
    second, spread = turn_about_z(c, s, carried.second), turn_matrix(c, s, carried.spread)
    if joint.revolute:
        x, y = x - rate * first[1], y + rate * first[0]
        xy = rate * second.xy
        swept = (
            (-xy, -(rate * second.yy), -(rate * second.yz)),
            (rate * second.xx, xy, rate * second.xz),
        )
        spread = (add(spread[0], swept[0]), add(spread[1], swept[1]), spread[2])
    return Carried(carried.mass, first, second, (x, y, z), spread)


def _revolute_column(chain: Chain[S], carried: Carried[S], omega: Vector[S]) -> Column[S]:
    (x, y, z), (hx, hy, _), (rx, ry, _) = omega, carried.first, carried.first_rate
    p, e = carried.second, carried.spread
    swing_x = p.xx * x + p.xy * y + p.xz * z
    swing_y = p.xy * x + p.yy * y + p.yz * z
    planar = e[0][0] + e[1][1]
    return Column(
        force=(-(z * hx) - ry, rx - z * hy, x * hx + y * hy),
        moment=(swing_y - e[0][2], -(swing_x + e[1][2]), planar),
        unit=(-hy, hx, chain.zero),
        eta=(-p.xz, -p.yz, p.xx + p.yy),
        kappa=(-(swing_y + e[2][0]), swing_x - e[2][1], planar),
    )


def _prismatic_column(chain: Chain[S], carried: Carried[S], omega: Vector[S]) -> Column[S]:
    (x, y, _), (hx, hy, hz), (rx, ry, _) = omega, carried.first, carried.first_rate
    m, zero = carried.mass, chain.zero
    moment = (hz * x, hz * y, -(hx * x + hy * y))
    return Column(
        force=(m * y, -(m * x), zero),
        moment=moment,
        unit=(zero, zero, m),
        eta=(hy, -hx, zero),
        kappa=(ry - moment[0], -(rx + moment[1]), -moment[2]),
    )


def _inward(joint: ChainJoint[S], column: Column[S], omega: Vector[S], rate: S) -> Column[S]:
    """From joint frame i to i-1; ``omega`` of link i-1, ``rate`` of joint i."""
    p = origin(joint)
    force, unit = to_parent(joint, column.force), to_parent(joint, column.unit)
    moment = add(to_parent(joint, column.moment), cross(p, force))
    eta = add(to_parent(joint, column.eta), cross(p, unit))
    kappa, lever = column.kappa, cross(p, cross(unit, omega))
    if joint.revolute:
        kappa = (kappa[0] - rate * column.eta[1], kappa[1] + rate * column.eta[0], kappa[2])
    else:
        lever = add(lever, cross(scale(rate, axis(joint)), unit))
    return Column(force, moment, unit, eta, add(to_parent(joint, kappa), lever))


def _with_rotor(column: Column[S], joint: ChainJoint[S], omega: Vector[S], half: S) -> Column[S]:
    """The rotor of joint j, on link j-1."""
    k = axis(joint)
    turn = scale(half * joint.coupling, cross(omega, k))
    eta = add(column.eta, scale(joint.coupling, k))
    return Column(column.force, add(column.moment, turn), column.unit, eta, subtract(column.kappa, turn))


def _entries(joint: ChainJoint[S], column: Column[S], omega: Vector[S]) -> tuple[S, S]:
    """C_ij and C_ji in rates, with omega of link i."""
    if joint.revolute:
        return column.moment[2], column.kappa[2]
    return column.force[2], column.unit[0] * omega[1] - column.unit[1] * omega[0]


def _about_z(c: S, s: S, v: Vector[S]) -> Vector[S]:
    return (c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])


def _shifted(mass: S, first: Vector[S], second: Symmetric[S], p: Vector[S]) -> Symmetric[S]:
    """Second moments about a point from which the old one is seen at ``p``: P + h p^T + p h^T + m p p^T."""
    moved = add(first, scale(mass, p))
    a, b, c = ((first[k] + moved[k]) * p[k] for k in range(3))
    return Symmetric(
        second.xx + a,
        second.yy + b,
        second.zz + c,
        second.xy + (moved[0] * p[1] + first[1] * p[0]),
        second.xz + (moved[0] * p[2] + first[2] * p[0]),
        second.yz + (moved[1] * p[2] + first[2] * p[1]),
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
class ClosedColumn(Generic[S]):
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
                column = _column_with_rotor(column, joint, omegas[j], half)
            upper, lower = _closed_entries(chain.joints[i], column, omegas[i + 1])
            same = joint.sign == chain.joints[i].sign
            matrix[i][j], matrix[j][i] = (upper, lower) if same else (-upper, -lower)
    return matrix


def moving_composites(chain: Chain[S], speed: Sequence[S], omegas: Sequence[Vector[S]], half: S) -> list[MovingBody[S]]:
    """For each joint, all that it carries and how that moves, in its joint frame; ``omegas`` with that of the base."""
    bodies = [_moving(body, omega, half) for body, omega in zip(chain.bodies, omegas[1:], strict=True)]
    for i in range(chain.n - 1, 0, -1):
        joint = chain.joints[i]
        spin = hat(scale(half * joint.coupling * speed[i], axis(joint)), chain.zero)
        carried = _column_to_parent(joint, bodies[i], _origin_rate(joint, omegas[i], speed[i]))
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


def _column_to_parent(joint: ChainJoint[S], moving: MovingBody[S], rate: Vector[S]) -> MovingBody[S]:
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


def _column(chain: Chain[S], joint: ChainJoint[S], moving: MovingBody[S], omega: Vector[S]) -> ClosedColumn[S]:
    """At the joint itself, in joint frame j; zdot = omega x z = (omega_y, -omega_x, 0)."""
    unit, eta = unit_wrench(chain, joint, moving.body)
    turn: Vector[S] = (omega[1], -omega[0], chain.zero)
    h, hdot, e, i = moving.body.first_moment, moving.growth, moving.spread, moving.body.inertia
    if not joint.revolute:
        force = scale(moving.body.mass, turn)
        return ClosedColumn(force, cross(h, turn), unit, eta, (hdot[1], -hdot[0], chain.zero))
    planar = e[0][0] + e[1][1]
    force = add(cross(turn, h), (-hdot[1], hdot[0], chain.zero))
    moment = add(multiply(i.matrix, turn), (-e[0][2], -e[1][2], planar))
    return ClosedColumn(force, moment, unit, eta, (-e[2][0], -e[2][1], planar))


def column_to_parent(joint: ChainJoint[S], column: ClosedColumn[S], omega: Vector[S], rate: S) -> ClosedColumn[S]:
    """From joint frame i to i-1; ``omega`` of link i-1, ``rate`` of joint i."""
    p = origin(joint)
    force, unit = to_parent(joint, column.force), to_parent(joint, column.unit)
    moment = add(to_parent(joint, column.moment), cross(p, force))
    eta = add(to_parent(joint, column.eta), cross(p, unit))
    delta = add(to_parent(joint, column.delta), cross(_origin_rate(joint, omega, rate), unit))
    return ClosedColumn(force, moment, unit, eta, delta)


def _column_with_rotor(column: ClosedColumn[S], joint: ChainJoint[S], omega: Vector[S], half: S) -> ClosedColumn[S]:
    """The rotor of joint j, on link j-1."""
    u = axis(joint)
    turn = scale(half * joint.coupling, cross(omega, u))
    eta = add(column.eta, scale(joint.coupling, u))
    return ClosedColumn(column.force, add(column.moment, turn), column.unit, eta, add(column.delta, turn))


def _closed_entries(joint: ChainJoint[S], column: ClosedColumn[S], omega: Vector[S]) -> tuple[S, S]:
    """C_ij and C_ji in rates, with omega of link i."""
    x, y, _ = omega
    if joint.revolute:
        return column.moment[2], column.delta[2] + (y * column.eta[0] - x * column.eta[1])
    return column.force[2], y * column.unit[0] - x * column.unit[1]

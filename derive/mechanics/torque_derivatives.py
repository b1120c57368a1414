"""The Christoffel Coriolis matrix and the derivatives of the torques by q and qd, by composite bodies, rotors included.

*C*: a rigid body is a sum of points, and for points C_ij = sum m J_i . dJ_j/dt is exactly the Christoffel matrix, J_i
the velocity of the point per unit rate of joint i. All that joint j carries, seen from the origin of its frame, enters
with

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

*Derivatives*: since the Christoffel symbols are symmetric in their last two indices, d(C qd)/d qd = 2 C. By q, all that
joint j carries meets the rest of the arm through the motion of its link: angular velocity omega, angular acceleration
alpha and acceleration a of the origin, all in joint frame j. When the base of that part is turned about z by -dq_j, or
shifted, the motion changes by

    d omega = zdot,  d alpha + omega x d omega = zddot,  d a = a x z  (revolute);    d a = zddot  (prismatic),

with zdot = omega x z, zddot = U z and U = alpha^ + omega^ omega^. With its moments, here those of the whole motion,

    m,  h = sum m x,  hdot = sum m xdot,  I,  E = sum m xdot x^T,  D = tr(E) 1 - E,

x the place of a point seen from the origin of joint j, the wrench that joint j carries answers by

    df = m da + zddot x h + 2 zdot x hdot,    dn = h x da + I zddot + 2 D zdot;

seen from the links before, it also turns with the joint (revolute) or gets another lever (prismatic). Carried inward it
has the components d tau_i / d q_j, i < j. For i > j, the torque of joint i answers the same three changes through the
wrench u, eta that accelerates joint i alone and through delta = D^T z plus the lever arms' rates, carried inward:
d tau_i = u . da + eta . zddot + 2 delta . zdot.

A rotor spinning at ``ratio*qd`` about u is a body of its own. Against the same rotor locked to its link, with c =
ratio I and omega of that link, it adds c rate/2 u^ to E of the link, c u to eta and c/2 omega x u to delta.

The composite formulas of Carpentier and Mansard (RSS 2018) and of Singh, Russell and Wensing (IEEE Robotics and
Automation Letters 7(2), 2022) compute the same in one frame for all links; in joint frames most of their entries are
zero or shared with Newton-Euler.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Generic

from derive.mechanics import joint_motion, vectors
from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.energy import unit_wrench
from derive.mechanics.joint_motion import along_axes, axis, generalized_force, origin, to_child, to_parent
from derive.mechanics.newton_euler import FrameChoice, LinkMotion, carried_wrenches, link_motions
from derive.mechanics.vectors import Matrix, S, Symmetric, Vector, add, add_matrices, cross, dot, multiply, scale


@dataclass(frozen=True, slots=True)
class _Composite(Generic[S]):
    """All that a joint carries and how it moves, seen from its link, in its frame."""

    mass: S  # m
    first: Vector[S]  # h = sum m x
    second: Symmetric[S]  # P = sum m x x^T
    first_rate: Vector[S]  # h' = sum m x'
    second_rate: Matrix[S]  # E = sum m x' x^T

    def to_parent(self, joint: ChainJoint[S], rate: S) -> _Composite[S]:
        """Seen from link i-1, in joint frame i-1."""
        c, s, fixed, p, mass = joint.cosine, joint.sine, joint.fixed.rotation, origin(joint), self.mass
        # In the axes before the joint's turn: h and h' as vectors, P and E as R P R^T.
        first, (x, y, z) = joint_motion.turn_vector(c, s, self.first), joint_motion.turn_vector(c, s, self.first_rate)
        second = joint_motion.turn_about_z(c, s, self.second)
        second_rate = joint_motion.turn_matrix(c, s, self.second_rate)
        # The turn adds rate z x x to every x': rate z x h to h' and rate z^ P to E, whose third row stays.
        if joint.revolute:
            x, y = x - rate * first[1], y + rate * first[0]
            xy = rate * second.xy
            swept_x = (-xy, -(rate * second.yy), -(rate * second.yz))
            swept_y = (rate * second.xx, xy, rate * second.xz)
            second_rate = (add(second_rate[0], swept_x), add(second_rate[1], swept_y), second_rate[2])
        # in the axes, and then seen from the origin, of joint frame i-1: P + h p^T + p h^T + m p p^T
        first, first_rate = multiply(fixed, first), multiply(fixed, (x, y, z))
        # E + h' p^T: every place x grows by p, and no x' does.
        second_rate = add_matrices(vectors.conjugate(fixed, second_rate), vectors.outer(first_rate, p))
        second, moved = joint_motion.turn_tensor(fixed, second), add(first, scale(mass, p))
        xx, yy = second.xx + (first[0] + moved[0]) * p[0], second.yy + (first[1] + moved[1]) * p[1]
        zz, xy = second.zz + (first[2] + moved[2]) * p[2], second.xy + (moved[0] * p[1] + first[1] * p[0])
        xz, yz = second.xz + (moved[0] * p[2] + first[2] * p[0]), second.yz + (moved[1] * p[2] + first[2] * p[1])
        shifted = Symmetric(xx, yy, zz, xy, xz, yz)
        # A slide moves everything with rate z: h' gains m rate z, and E gains rate z h^T.
        if not joint.revolute:
            slide = scale(rate, axis(joint))
            first_rate = add(first_rate, scale(mass, slide))
            second_rate = add_matrices(second_rate, vectors.outer(slide, moved))
        return _Composite(mass, moved, shifted, first_rate, second_rate)

    def column(self, joint: ChainJoint[S], omega: Vector[S], zero: S) -> _ColumnWrench[S]:
        """What begins its way inward in joint frame j."""
        # f = m zdot and n = h x zdot with zdot = omega x z; kappa = h' x z - n.
        (x, y, z), (hx, hy, hz), (rx, ry, _) = omega, self.first, self.first_rate
        m, p, e = self.mass, self.second, self.second_rate
        if not joint.revolute:
            moment = (hz * x, hz * y, -(hx * x + hy * y))
            force, kappa = (m * y, -(m * x), zero), (ry - moment[0], -(rx + moment[1]), -moment[2])
            return _ColumnWrench(force, moment, unit=(zero, zero, m), eta=(hy, -hx, zero), kappa=kappa)
        # f = omega x u + z x h', n = z x (-P omega) + (-E_xz, -E_yz, E_xx + E_yy); kappa is the rate of I z less n.
        swing_x = p.xx * x + p.xy * y + p.xz * z
        swing_y = p.xy * x + p.yy * y + p.yz * z
        planar = e[0][0] + e[1][1]
        force = (-(z * hx) - ry, rx - z * hy, x * hx + y * hy)
        moment = (swing_y - e[0][2], -(swing_x + e[1][2]), planar)
        eta, kappa = (-p.xz, -p.yz, p.xx + p.yy), (-(swing_y + e[2][0]), swing_x - e[2][1], planar)
        return _ColumnWrench(force, moment, (-hy, hx, zero), eta, kappa)


@dataclass(frozen=True, slots=True)
class _ColumnWrench(Generic[S]):
    """What goes inward for joint j."""

    force: Vector[S]  # of the wrench of column j of C
    moment: Vector[S]  # of the same
    unit: Vector[S]  # force that accelerates joint j alone
    eta: Vector[S]  # moment of the same
    kappa: Vector[S]  # moment whose part along z_i is C_ji

    def to_parent(self, joint: ChainJoint[S], omega: Vector[S], rate: S) -> _ColumnWrench[S]:
        # Force and moment about the origin of frame i-1: n' = n + p x f.
        p = origin(joint)
        force, unit = to_parent(joint, self.force), to_parent(joint, self.unit)
        moment = add(to_parent(joint, self.moment), cross(p, force))
        eta = add(to_parent(joint, self.eta), cross(p, unit))
        kappa, lever = self.kappa, cross(p, cross(unit, omega))
        # The joint's rate takes eta x z from kappa; the lever adds p x (u x omega), a slide rate z x u.
        if joint.revolute:
            kappa = (kappa[0] - rate * self.eta[1], kappa[1] + rate * self.eta[0], kappa[2])
        else:
            lever = add(lever, cross(scale(rate, axis(joint)), unit))
        return _ColumnWrench(force, moment, unit, eta, add(to_parent(joint, kappa), lever))


def coriolis_matrix(chain: Chain[S], qd: Sequence[S], half: S) -> list[list[S]]:
    """C(q, qd) in Christoffel form: C + C^T = dB/dt, C qd is the velocity torque."""
    rates = along_axes(chain, qd)
    omegas = [chain.null]  # of the base and the links, each in its own joint frame
    for joint, rate in zip(chain.joints, rates, strict=True):
        x, y, z = to_child(joint, omegas[joint.parent + 1])
        omegas.append((x, y, z + rate if joint.revolute else z))
    composites = _composites(chain, rates, half)
    matrix = [[chain.zero] * chain.n for _ in range(chain.n)]
    for j, joint in enumerate(chain.joints):
        # C_jj is the component of the wrench of column j along joint j itself.
        column = composites[j].column(joint, omegas[j + 1], chain.zero)
        matrix[j][j] = generalized_force(joint, column.force, column.moment)
        outer_rate = rates[j]
        for i, outer in chain.inward(j):
            inner, omega = chain.joints[i], omegas[i + 1]
            column, outer_rate = column.to_parent(outer, omega, outer_rate), rates[i]
            if outer is joint:  # the rotor of joint j, on link i
                k = axis(joint)
                turn = scale(half * joint.coupling, cross(omega, k))
                eta = add(column.eta, scale(joint.coupling, k))
                moment, kappa = add(column.moment, turn), vectors.subtract(column.kappa, turn)
                column = replace(column, moment=moment, eta=eta, kappa=kappa)
            # C_ij = wrench . z_i; C_ji = kappa . z_i, or u . (omega x z_i) where joint i slides.
            upper = generalized_force(inner, column.force, column.moment)
            lower = column.kappa[2] if inner.revolute else column.unit[0] * omega[1] - column.unit[1] * omega[0]
            # Rates count about +z; a joint with sign -1 has the other sign in its row and its column.
            matrix[i][j], matrix[j][i] = (upper, lower) if joint.sign == inner.sign else (-upper, -lower)
    return matrix


def _composites(chain: Chain[S], rates: Sequence[S], half: S) -> list[_Composite[S]]:
    composites = []
    for body in chain.bodies:  # a link alone: nothing moves seen from itself
        i, null = body.inertia, chain.null
        # Second moments from the tensor: P = tr(I)/2 1 - I, for instance P_xx = (I_yy + I_zz - I_xx)/2.
        xx, yy, zz = half * ((i.yy + i.zz) - i.xx), half * ((i.xx + i.zz) - i.yy), half * ((i.xx + i.yy) - i.zz)
        second = Symmetric(xx, yy, zz, -i.xy, -i.xz, -i.yz)
        composites.append(_Composite(body.mass, body.first_moment, second, null, (null, null, null)))
    # Inward, each link takes up what the next joint carries; a rotor on it adds c rate/2 k^ to E.
    for k in range(chain.n - 1, 0, -1):
        joint = chain.joints[k]
        if joint.parent < 0:
            continue
        own = composites[joint.parent]
        moved = composites[k].to_parent(joint, rates[k])
        spin = vectors.hat(scale(half * joint.coupling * rates[k], axis(joint)), chain.zero)
        mass, first = own.mass + moved.mass, add(own.first, moved.first)
        second, first_rate = own.second + moved.second, add(own.first_rate, moved.first_rate)
        second_rate = add_matrices(own.second_rate, add_matrices(moved.second_rate, spin))
        composites[joint.parent] = _Composite(mass, first, second, first_rate, second_rate)
    return composites


# -- derivatives of the torques


@dataclass(frozen=True, slots=True)
class _MovingBody(Generic[S]):
    """A composite body and how its moments change, in a joint frame."""

    body: Body[S]  # mass, first moment, inertia about the origin
    first_rate: Vector[S]  # hdot = sum m xdot
    second_rate: Matrix[S]  # E = sum m xdot x^T

    def to_parent(self, joint: ChainJoint[S], origin_rate: Vector[S]) -> _MovingBody[S]:
        """Seen from the origin of joint frame i-1: x' = x + p, x'dot = xdot + pdot."""
        p = origin(joint)
        first_rate = to_parent(joint, self.first_rate)
        body = joint_motion.body_to_parent(joint, self.body)
        second_rate = add_matrices(joint_motion.matrix_to_parent(joint, self.second_rate), vectors.outer(first_rate, p))
        second_rate = add_matrices(second_rate, vectors.outer(origin_rate, body.first_moment))
        return _MovingBody(body, add(first_rate, scale(body.mass, origin_rate)), second_rate)

    def response(self, chain: Chain[S], joint: ChainJoint[S], motion: LinkMotion[S]) -> _Response[S]:
        """Derivatives by q_j of the wrench on all that joint j carries, in frame j, and of its own torque."""
        # Unit wrench of the joint, and zddot = U z: d/dt of omega x z on the link, the third column of U.
        h, hdot, e, body = self.body.first_moment, self.first_rate, self.second_rate, self.body
        unit, eta = unit_wrench(chain, joint, body)
        zddot = vectors.column(motion.tensor, 2)
        # Shifted base: df = m zddot, dn = h x zddot; the torque's lever delta = h' x z.
        if not joint.revolute:
            delta = (hdot[1], -hdot[0], chain.zero)
            return _Response(scale(body.mass, zddot), cross(h, zddot), unit, eta, delta)
        # Turned base: zdot = omega x z, d a = a x z, and twice zdot meets the moments' rates.
        zdot: Vector[S] = (motion.omega[1], -motion.omega[0], chain.zero)
        twice = add(zdot, zdot)
        a = motion.acceleration
        a_z: Vector[S] = (a[1], -a[0], chain.zero)
        # df = m a x z + zddot x h + 2 zdot x hdot
        force = add(add(scale(body.mass, a_z), cross(zddot, h)), cross(twice, hdot))
        x, y, _ = twice
        # 2 D zdot with D = tr(E) 1 - E; the third component of zdot is zero.
        first = (e[1][1] + e[2][2]) * x - e[0][1] * y
        spread = (first, (e[0][0] + e[2][2]) * y - e[1][0] * x, -(e[2][0] * x + e[2][1] * y))
        # dn = h x (a x z) + I zddot + 2 D zdot; delta = D^T z
        moment = add(add(cross(h, a_z), multiply(body.inertia.matrix, zddot)), spread)
        return _Response(force, moment, unit, eta, (-e[2][0], -e[2][1], e[0][0] + e[1][1]))


@dataclass(frozen=True, slots=True)
class _Response(Generic[S]):
    """What goes inward for joint j."""

    force: Vector[S]  # of the wrench that answers the variable of joint j
    moment: Vector[S]  # of the same
    unit: Vector[S]  # force that accelerates joint j alone
    eta: Vector[S]  # moment of the same
    delta: Vector[S]  # moment by which the torque of joint j answers the rate of an axis

    def to_parent(self, joint: ChainJoint[S], omega: Vector[S], rate: S) -> _Response[S]:
        # To the origin of frame i-1: moments gain p x force, delta gains pdot x u.
        p = origin(joint)
        force, unit = to_parent(joint, self.force), to_parent(joint, self.unit)
        moment = add(to_parent(joint, self.moment), cross(p, force))
        eta = add(to_parent(joint, self.eta), cross(p, unit))
        delta = add(to_parent(joint, self.delta), cross(_origin_rate(joint, omega, rate), unit))
        return _Response(force, moment, unit, eta, delta)

    def inner_derivative(self, inner: ChainJoint[S], motion: LinkMotion[S]) -> S:
        """d tau_j / d q_i in rates, i < j."""
        # u . da + eta . zddot + 2 delta . zdot, of which a slide has the first alone.
        zddot = vectors.column(motion.tensor, 2)
        if not inner.revolute:
            return dot(self.unit, zddot)
        x, y, _ = motion.omega
        ax, ay, _ = motion.acceleration
        lever = self.delta[0] * y - self.delta[1] * x
        return (self.unit[0] * ay - self.unit[1] * ax) + dot(self.eta, zddot) + (lever + lever)


def torque_velocity_derivative(chain: Chain[S], qd: Sequence[S], half: S) -> list[list[S]]:
    """d tau / d qd: 2 C, the factor on inertial parameters, plus viscous friction; that of Coulomb friction is 0."""
    joints = tuple(replace(joint, coupling=joint.coupling + joint.coupling) for joint in chain.joints)
    doubled = replace(chain, bodies=tuple(body + body for body in chain.bodies), joints=joints)
    matrix = coriolis_matrix(doubled, qd, half)
    for i, joint in enumerate(chain.joints):
        matrix[i][i] = matrix[i][i] + joint.viscous
    return matrix


def torque_position_derivative(
    chain: Chain[S], qd: Sequence[S], qdd: Sequence[S], half: S, choices: Sequence[FrameChoice] = ()
) -> list[list[S]]:
    """d tau / d q."""
    rates, accelerations = along_axes(chain, qd), along_axes(chain, qdd)
    motions = link_motions(chain, rates, accelerations, choices)
    wrenches = dict(carried_wrenches(chain, motions, rates, accelerations, choices))
    omegas = [motion.omega for motion in motions]
    bodies = _moving_composites(chain, rates, omegas, half)
    matrix = [[chain.zero] * chain.n for _ in range(chain.n)]
    for j, joint in enumerate(chain.joints):
        # d tau_j / d q_j
        response = bodies[j].response(chain, joint, motions[j + 1])
        matrix[j][j] = generalized_force(joint, response.force, response.moment)
        # seen from the links before, the carried wrench turns with a revolute joint and is shifted by a prismatic one
        (fx, fy, fz), (nx, ny, nz) = wrenches[j]
        turned: Vector[S] = (-fy, fx, fz - fz)
        if joint.revolute:
            moment = add(response.moment, (-ny, nx, nz - nz))
            response = replace(response, force=add(response.force, turned), moment=moment)
        else:
            response = replace(response, moment=add(response.moment, turned))
        # Inward: d tau_i / d q_j from the wrench, and d tau_j / d q_i from the unit wrench, i < j.
        outer_rate = rates[j]
        for i, outer in chain.inward(j):
            inner = chain.joints[i]
            response, outer_rate = response.to_parent(outer, omegas[i + 1], outer_rate), rates[i]
            if outer is joint:  # the rotor of joint j, on link i
                u = axis(joint)
                eta = add(response.eta, scale(joint.coupling, u))
                delta = add(response.delta, scale(half * joint.coupling, cross(omegas[i + 1], u)))
                response = replace(response, eta=eta, delta=delta)
            upper = generalized_force(inner, response.force, response.moment)
            lower = response.inner_derivative(inner, motions[i + 1])
            matrix[i][j], matrix[j][i] = (upper, lower) if joint.sign == inner.sign else (-upper, -lower)
    return matrix


def _moving_composites(
    chain: Chain[S], rates: Sequence[S], omegas: Sequence[Vector[S]], half: S
) -> list[_MovingBody[S]]:
    """For each joint, all that it carries and how that moves, in its joint frame; ``omegas`` with that of the base."""
    bodies = []
    for body, omega in zip(chain.bodies, omegas[1:], strict=True):
        # one link: xdot = omega x x, so E = omega^ times the second moments
        t = body.inertia
        total = half * (t.xx + t.yy + t.zz)
        second = ((total - t.xx, -t.xy, -t.xz), (-t.xy, total - t.yy, -t.yz), (-t.xz, -t.yz, total - t.zz))
        x, y, z = (cross(omega, row) for row in second)
        bodies.append(_MovingBody(body, cross(omega, body.first_moment), vectors.transpose((x, y, z))))
    for i in range(chain.n - 1, 0, -1):
        # The rotor of joint i spins on link i-1: c rate/2 u^ in E.
        joint = chain.joints[i]
        if joint.parent < 0:
            continue
        inner, omega = bodies[joint.parent], omegas[joint.parent + 1]
        spin = vectors.hat(scale(half * joint.coupling * rates[i], axis(joint)), chain.zero)
        moved = bodies[i].to_parent(joint, _origin_rate(joint, omega, rates[i]))
        body, first = inner.body + moved.body, add(inner.first_rate, moved.first_rate)
        second = add_matrices(add_matrices(inner.second_rate, moved.second_rate), spin)
        bodies[joint.parent] = _MovingBody(body, first, second)
    return bodies


def _origin_rate(joint: ChainJoint[S], omega: Vector[S], rate: S) -> Vector[S]:
    """Velocity of the origin of frame i seen from that of frame i-1, in frame i-1."""
    turning = cross(omega, origin(joint))
    return turning if joint.revolute else add(turning, scale(rate, axis(joint)))

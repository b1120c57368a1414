"""Joint accelerations from torques, in two ways: by the factorised inertia matrix, and by articulated bodies.

The first solves B qdd = tau - (C qd + g + friction) by a factorisation without roots. The work grows with n^3, that of
articulated bodies with n.

Articulated bodies, in joint frames, rotors included: from the tip inward every link with all that hangs on it, its
joints free to give way, answers an acceleration A of its origin by the wrench I_A A + p. With U = I_A s for the joint's
motion s and D = s . U, the link before feels

    I_A - U U^T / D,    p + I_A A_v + U (tau - s . p) / D;

outward, the accelerations follow (Featherstone, Rigid Body Dynamics Algorithms, ch. 7). The rotor of a joint adds its
coupling c about the axis to U and its armature to D. D is the pivot of the inertia matrix eliminated from the tip
inward: regrouped parameters, with which single bodies have no mass, change nothing in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from operator import mul
from typing import Any, Generic, Protocol, Self, TypeVar

from derive.mechanics import joint_motion, vectors
from derive.mechanics.chain import Chain, ChainJoint
from derive.mechanics.joint_motion import along_axes, axis, generalized_force, origin, to_child, to_parent
from derive.mechanics.newton_euler import FrameChoice, body_wrench, link_motions
from derive.mechanics.vectors import Matrix, S, Scalar, Symmetric, Vector, add, cross, dot, scale, subtract


class Field(Scalar, Protocol):
    """A scalar that can also divide."""

    def __truediv__(self, other: Any, /) -> Self: ...


F = TypeVar("F", bound=Field)


def factorised(
    matrix: Sequence[Sequence[F]], sides: Sequence[Sequence[F]]
) -> tuple[list[list[F]], list[F], list[list[F]]]:
    """U D U^T, U unit upper, of a symmetric matrix: columns of U, pivots D and y = U^-1 v for each right-hand side v.

    Starting at the last row keeps the zeros of a chain's inertia matrix (Featherstone, Rigid Body Dynamics Algorithms,
    section 6.5). The pivots of a positive definite matrix are positive in any order.
    """
    # `rest` is the part still to be factorised, `factors[k]` column k of U, `rest[k][k]` pivot D_k.
    rest, lifted = [list(row[: i + 1]) for i, row in enumerate(matrix)], [list(side) for side in sides]
    factors: list[list[F]] = [[] for _ in rest]
    for k in range(len(rest) - 1, -1, -1):
        factors[k] = [entry / rest[k][k] for entry in rest[k][:k]]
        # Schur complement rest - U_k D_k U_k^T, and back substitution in U y = v beside it.
        for i in range(k):
            for j in range(i + 1):
                rest[i][j] = rest[i][j] - factors[k][i] * rest[k][j]
            for side in lifted:
                side[i] = side[i] - factors[k][i] * side[k]
    return factors, [rest[k][k] for k in range(len(rest))], lifted


def carried(lifted: Sequence[Sequence[F]], pivots: Sequence[F], zero: F) -> list[list[F]]:
    """V^T (U D U^T)^-1 V of right-hand sides V, symmetric: the sum of y_k y_k^T / D_k with y = U^-1 V."""
    divided = [[y / pivot for y, pivot in zip(side, pivots, strict=True)] for side in lifted]
    places = range(len(lifted))
    half = [[sum(map(mul, divided[i], lifted[j]), zero) for j in range(i + 1)] for i in places]
    return [[half[max(i, j)][min(i, j)] for j in places] for i in places]


def forward_dynamics(inertia: Sequence[Sequence[F]], bias: Sequence[F], torques: Sequence[F]) -> list[F]:
    """The accelerations qdd under torques tau, n entries [N m or N]."""
    factors, pivots, (qdd,) = factorised(inertia, [[torque - b for torque, b in zip(torques, bias, strict=True)]])
    # D U^T qdd = y, from the base outward.
    for k, pivot in enumerate(pivots):
        qdd[k] = qdd[k] / pivot
        for i in range(k):
            qdd[k] = qdd[k] - factors[k][i] * qdd[i]
    return qdd


@dataclass(frozen=True, slots=True)
class _Articulated(Generic[F]):
    """How a link with joints beyond it answers: force = M a + H^T alpha + f, moment = H a + I alpha + n."""

    mass: Symmetric[F]  # M, symmetric
    coupling: Matrix[F]  # H, from acceleration to moment
    inertia: Symmetric[F]  # I, symmetric
    force: Vector[F]  # f, at no acceleration
    moment: Vector[F]  # n, at no acceleration

    def __add__(self, other: _Articulated[F]) -> _Articulated[F]:
        mass, coupling = self.mass + other.mass, vectors.add_matrices(self.coupling, other.coupling)
        inertia, force = self.inertia + other.inertia, add(self.force, other.force)
        return _Articulated(mass, coupling, inertia, force, add(self.moment, other.moment))

    def to_parent(self, joint: ChainJoint[F]) -> _Articulated[F]:
        """In the axes, and at the origin, of joint frame i-1: H' = H + p^ M and I' = I + p^ H^T - H' p^."""
        # In the axes of frame i-1 first, then about its origin.
        p = origin(joint)
        mass, inertia = (joint_motion.tensor_to_parent(joint, tensor) for tensor in (self.mass, self.inertia))
        turned = joint_motion.matrix_to_parent(joint, self.coupling)
        m = mass.matrix
        # H' = H + p^ M: p x the columns of M, which is symmetric.
        moved = vectors.add_matrices(turned, vectors.transpose((cross(p, m[0]), cross(p, m[1]), cross(p, m[2]))))
        force = to_parent(joint, self.force)
        moment = add(to_parent(joint, self.moment), cross(p, force))
        # I' = I + p^ H^T - H' p^, its upper triangle alone.
        left, right = [cross(p, row) for row in turned], [cross(p, row) for row in moved]
        i = inertia.matrix
        shifted = Symmetric(*(i[r][c] + (left[c][r] + right[r][c]) for r, c in vectors.UPPER))
        return _Articulated(mass, moved, shifted, force, moment)

    def release(self, joint: ChainJoint[F], torque: F) -> tuple[_Release[F], _Articulated[F]]:
        """What the joint needs, and the link as the one before feels it while the joint gives way."""
        mass, coupling, inertia = self.mass.matrix, self.coupling, self.inertia.matrix
        # U = I_A s, its force part (upper) and its moment part (lower): the third row of [H I] or column of [M; H].
        upper, lower = (coupling[2], inertia[2]) if joint.revolute else (mass[2], vectors.column(coupling, 2))
        # D = s . U + armature; the rotor's coupling belongs to U and not to D.
        pivot = (lower[2] if joint.revolute else upper[2]) + joint.armature
        lower = (lower[0], lower[1], lower[2] + joint.coupling)
        up: Vector[F] = (upper[0] / pivot, upper[1] / pivot, upper[2] / pivot)
        low: Vector[F] = (lower[0] / pivot, lower[1] / pivot, lower[2] / pivot)
        # The acceleration of the joint if its link's origin did not accelerate: (tau - s . p) / D.
        rest = (torque - generalized_force(joint, self.force, self.moment)) / pivot
        mass_left, taken = _less(self.mass, upper, up), vectors.outer(low, upper)
        # As the link before feels it: I_A - U U^T / D and p + U (tau - s . p) / D.
        x, y, z = map(subtract, coupling, taken)
        inertia_left, force = _less(self.inertia, lower, low), add(self.force, scale(rest, upper))
        moment = add(self.moment, scale(rest, lower))
        return _Release(rest, up, low), _Articulated(mass_left, (x, y, z), inertia_left, force, moment)


@dataclass(frozen=True, slots=True)
class _Release(Generic[S]):
    """What a joint needs to find its own acceleration: (rest - upper . a - lower . alpha) / D, divided already."""

    rest: S  # (tau - s . p) / D
    upper: Vector[S]  # U / D, that meets the acceleration of the origin
    lower: Vector[S]  # U / D, that meets the angular acceleration


def articulated_accelerations(
    chain: Chain[F], qd: Sequence[F], torques: Sequence[F], choices: Sequence[FrameChoice] = ()
) -> list[F]:
    """The accelerations qdd under torques tau less friction, n entries [N m or N], by articulated bodies."""
    releases = _releases(chain, along_axes(chain, qd), along_axes(chain, torques), choices)
    motions = [(chain.null, chain.null)]
    qdd: list[F] = []
    for joint, release in zip(chain.joints, releases, strict=True):
        # Acceleration of the link's origin as a point of the link before, its joint still.
        a, alpha = motions[joint.parent + 1]
        a, alpha = to_child(joint, add(a, cross(alpha, origin(joint)))), to_child(joint, alpha)
        # qdd = (tau - s . p - U . A) / D
        own = release.rest - (dot(release.upper, a) + dot(release.lower, alpha))
        qdd.append(own if joint.sign > 0 else -own)
        # A of this link: the joint's own s qdd on top.
        if joint.revolute:
            alpha = (alpha[0], alpha[1], alpha[2] + own)
        else:
            a = (a[0], a[1], a[2] + own)
        motions.append((a, alpha))
    return qdd


def _releases(
    chain: Chain[F], rates: Sequence[F], torques: Sequence[F], choices: Sequence[FrameChoice]
) -> list[_Release[F]]:
    """From the tip inward, by the motions of the links without any acceleration of the joints, gravity included."""
    motions = link_motions(chain, rates, [chain.zero] * chain.n, choices)
    found: list[_Release[F]] = []
    carried: dict[int, _Articulated[F]] = {}
    for i in range(chain.n - 1, -1, -1):
        joint = chain.joints[i]
        before, beyond = motions[joint.parent + 1], carried.get(i)
        wrench = body_wrench(chain.bodies[i], motions[i + 1], bool(choices) and choices[i].second_moments)
        body, m, zero = chain.bodies[i], chain.bodies[i].mass, chain.zero
        # A single rigid link: M = m 1, H = h^, I about the origin.
        mass, coupling = Symmetric(m, m, m, zero, zero, zero), vectors.hat(body.first_moment, zero)
        link = _Articulated(mass, coupling, body.inertia, *wrench)
        link = link if beyond is None else link + beyond
        # Of its torque the joint spends c u . alpha on its own rotor.
        release, free = link.release(joint, torques[i] - joint.coupling * dot(axis(joint), before.alpha))
        found.append(release)
        beyond = free.to_parent(joint)
        # The spinning rotor turns with link i-1: moment c rate omega x u.
        turning = scale(joint.coupling * rates[i], cross(before.omega, axis(joint)))
        beyond = replace(beyond, moment=add(beyond.moment, turning))
        others = carried.get(joint.parent)
        carried[joint.parent] = beyond if others is None else others + beyond
    return found[::-1]


def _less(tensor: Symmetric[F], a: Vector[F], divided: Vector[F]) -> Symmetric[F]:
    """I - a a^T / D; what the joint's own direction meets becomes zero where ``divided[2]`` is 1."""
    (x, y, z), d = a, divided
    diagonal = (tensor.xx - d[0] * x, tensor.yy - d[1] * y, tensor.zz - d[2] * z)
    return Symmetric(*diagonal, tensor.xy - d[0] * y, tensor.xz - d[2] * x, tensor.yz - d[2] * y)

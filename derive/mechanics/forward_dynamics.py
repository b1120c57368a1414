"""Accelerations by articulated bodies, in joint frames, rotors included.

From the tip inward every link with all that hangs on it, its joints free to give way, answers an acceleration A of its
origin by the wrench I_A A + p. With U = I_A s for the joint's motion s and D = s . U, the link before feels

    I_A - U U^T / D,    p + I_A A_v + U (tau - s . p) / D;

outward, the accelerations follow (Featherstone, Rigid Body Dynamics Algorithms, ch. 7). The rotor of a joint adds its
coupling c about the axis to U and its reflected inertia to D. D is the pivot of the inertia matrix eliminated from the
tip inward: regrouped parameters, with which single bodies have no mass, change nothing in it. The work grows with n,
that of the inertia matrix and its factorisation with n^3.

Accelerations from torques: B qdd = tau - (C qd + g + friction), by a factorisation without roots.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, Protocol, Self, TypeVar

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.inertia_matrix import Wrench
from derive.mechanics.joint_motion import (
    axis,
    origin,
    rates,
    to_child,
    to_parent,
    turn_about_z,
    turn_matrix,
    turn_tensor,
    work,
)
from derive.mechanics.link_motion import JointForm, LinkMotion, link_motions
from derive.mechanics.newton_euler import body_wrench
from derive.mechanics.vectors import (
    Matrix,
    S,
    Scalar,
    Symmetric,
    Vector,
    add,
    column,
    cross,
    dot,
    matmul,
    scale,
    subtract,
    transpose,
)


class Field(Scalar, Protocol):
    """A scalar that can also divide."""

    def __truediv__(self, other: Any, /) -> Self:
        """Self over other."""


F = TypeVar("F", bound=Field)


def forward_dynamics(inertia: Sequence[Sequence[F]], bias: Sequence[F], torques: Sequence[F]) -> list[F]:
    """The accelerations qdd.

    Args:
        inertia: B(q), symmetric positive definite.
        bias: C qd + g + friction.
        torques: tau.
    """
    return solve_symmetric(inertia, [t - b for t, b in zip(torques, bias, strict=True)])


def solve_symmetric(matrix: Sequence[Sequence[F]], right: Sequence[F]) -> list[F]:
    """Solve ``matrix x = right`` by matrix = U D U^T with unit upper U, from the last row up.

    Starting at the tip keeps the zeros of a chain's inertia matrix (Featherstone, Rigid Body Dynamics Algorithms,
    section 6.5).
    """
    n = len(right)
    work = [list(row[: i + 1]) for i, row in enumerate(matrix)]
    x = list(right)
    factors: list[list[F]] = [[] for _ in range(n)]
    for k in range(n - 1, -1, -1):
        factors[k] = [entry / work[k][k] for entry in work[k][:k]]
        for i in range(k):
            for j in range(i + 1):
                work[i][j] = work[i][j] - factors[k][i] * work[k][j]
            x[i] = x[i] - factors[k][i] * x[k]
    for k in range(n):
        x[k] = x[k] / work[k][k]
        for i in range(k):
            x[k] = x[k] - factors[k][i] * x[i]
    return x


@dataclass(frozen=True, slots=True)
class Articulated(Generic[S]):
    """How a link with joints beyond it answers: force = M a + H^T alpha + f, moment = H a + I alpha + n.

    Attributes:
        mass: M, symmetric.
        coupling: H, from acceleration to moment.
        inertia: I, symmetric.
        force: f, at no acceleration.
        moment: n, at no acceleration.
    """

    mass: Symmetric[S]
    coupling: Matrix[S]
    inertia: Symmetric[S]
    force: Vector[S]
    moment: Vector[S]

    def __add__(self, other: Articulated[S]) -> Articulated[S]:
        """Both together."""
        return Articulated(
            self.mass + other.mass,
            _add(self.coupling, other.coupling),
            self.inertia + other.inertia,
            add(self.force, other.force),
            add(self.moment, other.moment),
        )


@dataclass(frozen=True, slots=True)
class Release(Generic[S]):
    """What a joint needs to find its own acceleration: (push - upper . a - lower . alpha) / D, divided already.

    Attributes:
        push: (tau - s . p) / D.
        upper: U / D, that meets the acceleration of the origin.
        lower: U / D, that meets the angular acceleration.
    """

    push: S
    upper: Vector[S]
    lower: Vector[S]


def articulated_accelerations(
    chain: Chain[F], velocities: Sequence[F], torques: Sequence[F], forms: Sequence[JointForm] = ()
) -> list[F]:
    """The accelerations qdd under given torques, friction taken off them.

    Args:
        chain: The arm.
        velocities: qd, n entries.
        torques: tau less friction, n entries.
        forms: One for each joint, those by which the chain was arranged; or none.
    """
    speed, push = rates(chain, velocities), rates(chain, torques)
    motions = link_motions(chain, speed, [chain.zero] * chain.n, forms)
    releases = _releases(chain, motions, speed, push, forms)
    a = alpha = (chain.zero, chain.zero, chain.zero)
    found: list[F] = []
    for joint, release in zip(chain.joints, releases, strict=True):
        a, alpha = to_child(joint, add(a, cross(alpha, origin(joint)))), to_child(joint, alpha)
        own = release.push - (dot(release.upper, a) + dot(release.lower, alpha))
        found.append(own if joint.sign > 0 else -own)
        if joint.revolute:
            alpha = (alpha[0], alpha[1], alpha[2] + own)
        else:
            a = (a[0], a[1], a[2] + own)
    return found


def _releases(
    chain: Chain[F],
    motions: Sequence[LinkMotion[F]],
    speed: Sequence[F],
    push: Sequence[F],
    forms: Sequence[JointForm],
) -> list[Release[F]]:
    """From the tip inward; ``motions`` are those without any acceleration of the joints, gravity included."""
    found: list[Release[F]] = []
    beyond: Articulated[F] | None = None
    for i in range(chain.n - 1, -1, -1):
        joint, before = chain.joints[i], motions[i]
        wrench = body_wrench(chain.bodies[i], motions[i + 1], bool(forms) and forms[i].second_moments)
        link = _link(chain, chain.bodies[i], wrench)
        link = link if beyond is None else link + beyond
        own = push[i] - joint.coupling * dot(axis(joint), before.alpha)
        release, free = _release(joint, link, own)
        found.append(release)
        beyond = _to_parent(joint, free)
        turning = scale(joint.coupling * speed[i], cross(before.omega, axis(joint)))
        beyond = replace(beyond, moment=add(beyond.moment, turning))
    return found[::-1]


def _link(chain: Chain[F], body: Body[F], wrench: Wrench[F]) -> Articulated[F]:
    """One link alone."""
    m, z, (x, y, w) = body.mass, chain.zero, body.first_moment
    hat = ((z, -w, y), (w, z, -x), (-y, x, z))
    return Articulated(Symmetric(m, m, m, z, z, z), hat, body.inertia, *wrench)


def _release(joint: ChainJoint[F], link: Articulated[F], push: F) -> tuple[Release[F], Articulated[F]]:
    """What the joint needs, and the link as the one before feels it while the joint gives way."""
    mass, coupling, inertia = link.mass.matrix, link.coupling, link.inertia.matrix
    if joint.revolute:
        upper, lower = coupling[2], inertia[2]
    else:
        upper, lower = mass[2], column(coupling, 2)
    pivot = (lower[2] if joint.revolute else upper[2]) + joint.reflected
    lower = (lower[0], lower[1], lower[2] + joint.coupling)
    up, low = _divided(upper, pivot), _divided(lower, pivot)
    rest = (push - work(joint, link.force, link.moment)) / pivot
    free = Articulated(
        _less(link.mass, upper, up),
        _subtract(coupling, (scale(low[0], upper), scale(low[1], upper), scale(low[2], upper))),
        _less(link.inertia, lower, low),
        add(link.force, scale(rest, upper)),
        add(link.moment, scale(rest, lower)),
    )
    return Release(rest, up, low), free


def _divided(a: Vector[F], pivot: F) -> Vector[F]:
    """A / D; the last entry is 1 where it is the pivot itself."""
    return (a[0] / pivot, a[1] / pivot, a[2] / pivot)


def _less(tensor: Symmetric[F], a: Vector[F], divided: Vector[F]) -> Symmetric[F]:
    """I - a a^T / D; what the joint's own direction meets becomes zero where ``divided[2]`` is 1."""
    return Symmetric(
        tensor.xx - divided[0] * a[0],
        tensor.yy - divided[1] * a[1],
        tensor.zz - divided[2] * a[2],
        tensor.xy - divided[0] * a[1],
        tensor.xz - divided[2] * a[0],
        tensor.yz - divided[2] * a[1],
    )


def _to_parent(joint: ChainJoint[F], link: Articulated[F]) -> Articulated[F]:
    """In the axes, and at the origin, of joint frame i-1."""
    p, turn = origin(joint), joint.fixed.rotation
    mass = turn_tensor(turn, turn_about_z(joint.cosine, joint.sine, link.mass))
    inertia = turn_tensor(turn, turn_about_z(joint.cosine, joint.sine, link.inertia))
    turned = matmul(matmul(turn, turn_matrix(joint.cosine, joint.sine, link.coupling)), transpose(turn))
    m = mass.matrix
    lever = transpose((cross(p, m[0]), cross(p, m[1]), cross(p, m[2])))
    moved = _add(turned, lever)
    force = to_parent(joint, link.force)
    moment = add(to_parent(joint, link.moment), cross(p, force))
    return Articulated(mass, moved, _shifted(inertia, turned, moved, p), force, moment)


def _shifted(inertia: Symmetric[F], before: Matrix[F], after: Matrix[F], p: Vector[F]) -> Symmetric[F]:
    """I + p^ H^T - H' p^, with the coupling H before and H' after the shift by p."""
    left = [cross(p, row) for row in before]
    right = [cross(p, row) for row in after]
    i = inertia.matrix

    def entry(r: int, c: int) -> F:
        return i[r][c] + (left[c][r] + right[r][c])

    return Symmetric(entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2))


def _add(a: Matrix[S], b: Matrix[S]) -> Matrix[S]:
    return (add(a[0], b[0]), add(a[1], b[1]), add(a[2], b[2]))


def _subtract(a: Matrix[F], b: Matrix[F]) -> Matrix[F]:
    return (subtract(a[0], b[0]), subtract(a[1], b[1]), subtract(a[2], b[2]))

"""Motion of the links from the base outwards, in joint frames.

A point at r in a link accelerates with a + U r, where U = alpha^ + omega^ omega^ holds all that forces and moments
need of omega and alpha (Khalil and Kleinfinger, 1987). The axis k of a joint stands still in both links that it joins,
so U k is the same vector for both: the third column of U of a link is that of the link before, turned. With it

    alpha_x = omega_y omega_z - U_yz,   alpha_y = U_xz - omega_x omega_z,   omega_x^2 + omega_y^2 = -U_zz

come from products that U asks for anyway. Where the twist is a multiple of pi/2 this takes five operations less than
turning alpha; elsewhere turning alpha is cheaper.

What a recursion may choose at each joint without changing what it computes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Generic

from derive.mechanics.chain import Chain, ChainJoint
from derive.mechanics.joint_motion import axis, origin, to_child
from derive.mechanics.vectors import Matrix, S, Vector, add, dot, matmul, multiply, transpose


class Place(Enum):
    """Where on the joint's axis the origin of its frame stands."""

    AFTER = "after the joint's own offset"
    BEFORE = "before the joint's own offset"
    BEYOND = "after the offset of the next joint too, whose axis is parallel"


@dataclass(frozen=True, slots=True)
class JointForm:
    """Choices for one joint and its link; which are cheapest depends on the arm.

    Attributes:
        place: Where the origin stands.
        held: The link's vectors are written in axes that its joint does not turn, and its body is turned instead; for
            the last link, and before a parallel axis.
        second_moments: The parameter that vanishes by regrouping is P_zz = (I_xx + I_yy - I_zz)/2, and moments are
            written in second moments; else it is I_yy.
        column: The third column of U comes from the link before (for a slide all of U); else alpha does.
        squares: So does omega_x^2 + omega_y^2; else all three squares are made.
        grown: In held axes, where omega gains its z alone, the rest of U is that of the link before with what the joint
            adds; else it is made from omega and alpha.
    """

    place: Place = Place.AFTER
    held: bool = False
    second_moments: bool = False
    column: bool = True
    squares: bool = True
    grown: bool = True


PLAIN = JointForm()
"""DH frames on the joint axes, turning with the links."""


@dataclass(frozen=True, slots=True)
class LinkMotion(Generic[S]):
    """The motion of one link, in its joint frame.

    Attributes:
        omega: Angular velocity.
        alpha: Angular acceleration.
        spread: U = alpha^ + omega^ omega^; a point at r accelerates with ``acceleration + U r``.
        acceleration: Acceleration of the origin, less gravity.
        steps: U_zz - U_yy, U_xx - U_zz and U_yy - U_xx, where they came cheaper than as such.
    """

    omega: Vector[S]
    alpha: Vector[S]
    spread: Matrix[S]
    acceleration: Vector[S]
    steps: Vector[S] | None = None

    @property
    def diagonal_steps(self) -> Vector[S]:
        """U_zz - U_yy, U_xx - U_zz and U_yy - U_xx."""
        u = self.spread
        return self.steps or (u[2][2] - u[1][1], u[0][0] - u[2][2], u[1][1] - u[0][0])


def link_motions(
    chain: Chain[S], speed: Sequence[S], gain: Sequence[S], forms: Sequence[JointForm] = ()
) -> list[LinkMotion[S]]:
    """Base and links 1..n.

    Args:
        chain: The arm.
        speed: Rates positive about +z.
        gain: Their derivatives.
        forms: One for each joint, or none.
    """
    motions = [_at_rest(chain)]
    for i, joint in enumerate(chain.joints):
        form = forms[i] if forms else PLAIN
        step = _turned if joint.revolute else _slid
        motions.append(step(chain, joint, motions[-1], speed[i], gain[i], form))
    return motions


def _at_rest(chain: Chain[S]) -> LinkMotion[S]:
    rest = (chain.zero, chain.zero, chain.zero)
    x, y, z = chain.gravity
    return LinkMotion(rest, rest, (rest, rest, rest), (-x, -y, -z), rest)


def _carried(joint: ChainJoint[S], before: LinkMotion[S]) -> Vector[S]:
    """The acceleration of the joint frame's origin as a point of the link before."""
    return to_child(joint, add(before.acceleration, multiply(before.spread, origin(joint))))


def _turned(
    chain: Chain[S], joint: ChainJoint[S], before: LinkMotion[S], rate: S, growth: S, form: JointForm
) -> LinkMotion[S]:
    """Beyond a revolute joint."""
    x, y, inner = to_child(joint, before.omega)
    omega = (x, y, inner + rate)
    if not form.column:
        ax, ay, az = to_child(joint, before.alpha)
        return _motion(omega, (ax + rate * y, ay - rate * x, az + growth), _carried(joint, before))
    xz, yz = x * omega[2], y * omega[2]
    third = to_child(joint, multiply(before.spread, axis(joint)))
    alpha = (yz - third[1], third[0] - xz, dot(axis(joint), before.alpha) + growth)
    if not form.squares:
        return _motion(omega, alpha, _carried(joint, before), third)
    motion = _from_column(omega, alpha, third, _carried(joint, before))
    return _grown(joint, before, motion, rate, growth) if form.held and form.grown else motion


def _grown(joint: ChainJoint[S], before: LinkMotion[S], motion: LinkMotion[S], rate: S, growth: S) -> LinkMotion[S]:
    """Entries of U off the diagonal from those of the link before, in axes that the joint does not turn."""
    fixed, u = joint.fixed.rotation, motion.spread
    old = matmul(matmul(transpose(fixed), before.spread), fixed)
    twice = rate + rate
    spread = (
        (u[0][0], old[0][1] - growth, u[0][2]),
        (old[1][0] + growth, u[1][1], u[1][2]),
        (old[2][0] + twice * motion.omega[0], old[2][1] + twice * motion.omega[1], u[2][2]),
    )
    return replace(motion, spread=spread)


def _from_column(omega: Vector[S], alpha: Vector[S], third: Vector[S], acceleration: Vector[S]) -> LinkMotion[S]:
    """With omega_x^2 + omega_y^2 = -U_zz: two squares in place of three."""
    x, y, z = omega
    yy, zz = y * y, z * z
    across = zz - yy
    xx_zz, yy_zz = across - third[2], yy + zz
    xy = x * y
    spread = (
        (-yy_zz, xy - alpha[2], third[0]),
        (xy + alpha[2], -xx_zz, third[1]),
        (x * z - alpha[1], y * z + alpha[0], third[2]),
    )
    steps = (across, -(third[2] + yy_zz), yy_zz - xx_zz)
    return LinkMotion(omega, alpha, spread, acceleration, steps)


def _motion(
    omega: Vector[S], alpha: Vector[S], acceleration: Vector[S], third: Vector[S] | None = None
) -> LinkMotion[S]:
    """From omega and alpha; the third column of U may be known."""
    x, y, z = omega
    xx, yy, zz = x * x, y * y, z * z
    xy, xz, yz = x * y, x * z, y * z
    if third is None:
        third = (xz + alpha[1], yz - alpha[0], -(xx + yy))
    spread = (
        (-(yy + zz), xy - alpha[2], third[0]),
        (xy + alpha[2], -(xx + zz), third[1]),
        (xz - alpha[1], yz + alpha[0], -(xx + yy)),
    )
    return LinkMotion(omega, alpha, spread, acceleration, (zz - yy, xx - zz, yy - xx))


def _slid(
    chain: Chain[S], joint: ChainJoint[S], before: LinkMotion[S], rate: S, growth: S, form: JointForm
) -> LinkMotion[S]:
    """Beyond a prismatic joint: omega, alpha and U are those of the link before, in other axes."""
    omega, alpha = to_child(joint, before.omega), to_child(joint, before.alpha)
    twice = rate + rate
    acceleration = add(_carried(joint, before), (twice * omega[1], -(twice * omega[0]), growth))
    if not form.column:
        return _motion(omega, alpha, acceleration)
    turn = matmul(joint.fixed.rotation, joint.motion(chain.zero, chain.one).rotation)
    spread = matmul(matmul(transpose(turn), before.spread), turn)
    return LinkMotion(omega, alpha, spread, acceleration)

"""Motion of the links from the base outwards, in joint frames.

A point at r in a link accelerates with a + U r, where U = alpha^ + omega^ omega^, the angular acceleration tensor, has
all that forces and moments need of omega and alpha (Khalil and Kleinfinger, 1987). The axis k of a joint stands still
in both links that it joins, so U k is the same vector for both: the third column of U of a link is that of the link
before, turned. With it

    alpha_x = omega_y omega_z - U_yz,   alpha_y = U_xz - omega_x omega_z,   omega_x^2 + omega_y^2 = -U_zz

come from products that U asks for anyway. Where the twist is a multiple of pi/2 this takes five operations less than
turning alpha; elsewhere turning alpha is cheaper. `FrameChoice` says which way each joint takes, and where its frame
stands: choices that change the cost of a recursion and not what it computes.
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
class FrameChoice:
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


PLAIN = FrameChoice()
"""DH frames on the joint axes, turning with the links."""


@dataclass(frozen=True, slots=True)
class LinkMotion(Generic[S]):
    """The motion of one link, in its joint frame.

    Attributes:
        omega: Angular velocity.
        alpha: Angular acceleration.
        tensor: U = alpha^ + omega^ omega^; a point at r accelerates with ``acceleration + U r``.
        acceleration: Acceleration of the origin, less gravity.
        differences: U_zz - U_yy, U_xx - U_zz and U_yy - U_xx, where they came cheaper than as such.
    """

    omega: Vector[S]
    alpha: Vector[S]
    tensor: Matrix[S]
    acceleration: Vector[S]
    differences: Vector[S] | None = None

    @property
    def diagonal_differences(self) -> Vector[S]:
        """U_zz - U_yy, U_xx - U_zz and U_yy - U_xx."""
        u = self.tensor
        return self.differences or (u[2][2] - u[1][1], u[0][0] - u[2][2], u[1][1] - u[0][0])


def link_motions(
    chain: Chain[S], rates: Sequence[S], accelerations: Sequence[S], choices: Sequence[FrameChoice] = ()
) -> list[LinkMotion[S]]:
    """Motions of the base and of links 1..n, gravity taken as an acceleration of the base.

    Args:
        chain: The arm.
        rates: Joint velocities positive about +z, n entries.
        accelerations: Joint accelerations positive about +z, n entries.
        choices: One for each joint, those by which the chain was arranged; or none.

    Returns:
        n+1 motions, each in its own joint frame.
    """
    x, y, z = chain.gravity
    null = chain.null
    motions = [LinkMotion(null, null, (null, null, null), (-x, -y, -z), null)]
    for i, joint in enumerate(chain.joints):
        choice = choices[i] if choices else PLAIN
        step = _beyond_revolute if joint.revolute else _beyond_prismatic
        motions.append(step(chain, joint, motions[-1], rates[i], accelerations[i], choice))
    return motions


def angular_acceleration_tensor(
    omega: Vector[S], alpha: Vector[S], third: Vector[S] | None = None
) -> tuple[Matrix[S], Vector[S]]:
    """U = alpha^ + omega^ omega^ from its definition.

    Args:
        omega: Angular velocity.
        alpha: Angular acceleration.
        third: Its third column, where that is known.

    Returns:
        U, and the differences U_zz - U_yy, U_xx - U_zz and U_yy - U_xx of its diagonal.
    """
    x, y, z = omega
    xx, yy, zz = x * x, y * y, z * z
    xy, xz, yz = x * y, x * z, y * z
    if third is None:
        third = (xz + alpha[1], yz - alpha[0], -(xx + yy))
    tensor = (
        (-(yy + zz), xy - alpha[2], third[0]),
        (xy + alpha[2], -(xx + zz), third[1]),
        (xz - alpha[1], yz + alpha[0], -(xx + yy)),
    )
    return tensor, (zz - yy, xx - zz, yy - xx)


def _beyond_revolute(
    chain: Chain[S], joint: ChainJoint[S], before: LinkMotion[S], rate: S, acceleration: S, choice: FrameChoice
) -> LinkMotion[S]:
    x, y, inner = to_child(joint, before.omega)
    omega = (x, y, inner + rate)
    if not choice.column:
        ax, ay, az = to_child(joint, before.alpha)
        alpha = (ax + rate * y, ay - rate * x, az + acceleration)
        return _from_angular(omega, alpha, _origin_acceleration(joint, before))
    xz, yz = x * omega[2], y * omega[2]
    third = to_child(joint, multiply(before.tensor, axis(joint)))
    alpha = (yz - third[1], third[0] - xz, dot(axis(joint), before.alpha) + acceleration)
    if not choice.squares:
        return _from_angular(omega, alpha, _origin_acceleration(joint, before), third)
    motion = _from_third_column(omega, alpha, third, _origin_acceleration(joint, before))
    return _grown(joint, before, motion, rate, acceleration) if choice.held and choice.grown else motion


def _beyond_prismatic(
    chain: Chain[S], joint: ChainJoint[S], before: LinkMotion[S], rate: S, acceleration: S, choice: FrameChoice
) -> LinkMotion[S]:
    """omega, alpha and U are those of the link before, in other axes."""
    omega, alpha = to_child(joint, before.omega), to_child(joint, before.alpha)
    twice = rate + rate
    origin_acceleration = add(
        _origin_acceleration(joint, before), (twice * omega[1], -(twice * omega[0]), acceleration)
    )
    if not choice.column:
        return _from_angular(omega, alpha, origin_acceleration)
    turn = matmul(joint.fixed.rotation, joint.motion(chain.zero, chain.one).rotation)
    tensor = matmul(matmul(transpose(turn), before.tensor), turn)
    return LinkMotion(omega, alpha, tensor, origin_acceleration)


def _origin_acceleration(joint: ChainJoint[S], before: LinkMotion[S]) -> Vector[S]:
    """The acceleration of the joint frame's origin as a point of the link before."""
    return to_child(joint, add(before.acceleration, multiply(before.tensor, origin(joint))))


def _from_angular(
    omega: Vector[S], alpha: Vector[S], acceleration: Vector[S], third: Vector[S] | None = None
) -> LinkMotion[S]:
    tensor, differences = angular_acceleration_tensor(omega, alpha, third)
    return LinkMotion(omega, alpha, tensor, acceleration, differences)


def _from_third_column(omega: Vector[S], alpha: Vector[S], third: Vector[S], acceleration: Vector[S]) -> LinkMotion[S]:
    """With omega_x^2 + omega_y^2 = -U_zz: two squares in place of three."""
    x, y, z = omega
    yy, zz = y * y, z * z
    across = zz - yy
    xx_zz, yy_zz = across - third[2], yy + zz
    xy = x * y
    tensor = (
        (-yy_zz, xy - alpha[2], third[0]),
        (xy + alpha[2], -xx_zz, third[1]),
        (x * z - alpha[1], y * z + alpha[0], third[2]),
    )
    return LinkMotion(omega, alpha, tensor, acceleration, (across, -(third[2] + yy_zz), yy_zz - xx_zz))


def _grown(
    joint: ChainJoint[S], before: LinkMotion[S], motion: LinkMotion[S], rate: S, acceleration: S
) -> LinkMotion[S]:
    """Entries of U off the diagonal from those of the link before, in axes that the joint does not turn."""
    fixed, u = joint.fixed.rotation, motion.tensor
    old = matmul(matmul(transpose(fixed), before.tensor), fixed)
    twice = rate + rate
    tensor = (
        (u[0][0], old[0][1] - acceleration, u[0][2]),
        (old[1][0] + acceleration, u[1][1], u[1][2]),
        (old[2][0] + twice * motion.omega[0], old[2][1] + twice * motion.omega[1], u[2][2]),
    )
    return replace(motion, tensor=tensor)

"""Axes that are almost parallel, and angles that somebody cut off after a few decimals, which make them so.

Two axes that 1.57 and -1.5708 turn are not parallel, and have a common normal: some hundred metres away.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, Context
from fractions import Fraction
from math import pi

from flint import arb

from derive.exchange.arm import FRACTIONS, Arm, joints_between
from derive.exchange.common_normals import ALIKE
from derive.exchange.urdf import Origin, Urdf, UrdfJoint
from derive.mechanics.space import DIGITS, decimal, length, plus
from derive.mechanics.vectors import cross

PLACES = range(2, 13)  # so many decimals has an angle that somebody cut off
MOST_NAMED = 8  # so many of them are named
CutOff = Sequence[tuple[UrdfJoint, Fraction]]  # angles that are almost fractions of pi, with their joints


def meant(angle: Fraction) -> Fraction:
    """The fraction of pi, to many digits, of which an angle has the first decimals, the last one rounded or not."""
    ulp = next((Fraction(1, 10**places) for places in PLACES if angle * 10**places % 1 == 0), Fraction(0))
    for fraction in FRACTIONS if angle else ():
        near = decimal(arb.pi() * round(float(angle) * fraction / pi) / fraction, 3 * DIGITS)
        if 2 * abs(angle - near) <= ulp or 0 < abs(near) - abs(angle) < ulp:
            return near
    return angle


def as_meant(urdf: Urdf) -> Urdf:
    """A robot with fractions of pi where joints have their first decimals; see `meant`."""
    joints = []
    for joint in urdf.joints:
        roll, pitch, yaw = map(meant, joint.origin.rpy)
        joints.append(replace(joint, origin=Origin(joint.origin.xyz, (roll, pitch, yaw))))
    return replace(urdf, joints=tuple(joints))


def cut_off(urdf: Urdf, one: str, other: str, snap: Fraction) -> CutOff:
    """Angles between two links, with their joints, that are first decimals of fractions of pi beyond the snap [rad]."""
    between = joints_between(urdf, one, other)
    angles = [(joint, angle) for joint in between for angle in joint.origin.rpy]
    return [(joint, angle) for joint, angle in angles if abs(meant(angle) - angle) > snap]


def snap_for(widest: float) -> Fraction:
    """The least snap of two digits that takes angles of some difference for each other [rad]."""
    return Fraction(Context(prec=2, rounding=ROUND_CEILING).create_decimal(repr(widest * (1 + ALIKE))))


def slant(arm: Arm, i: int) -> float:
    """Sine of the angle between an axis and the one before."""
    return float(length(cross(arm.axes[i - 1].line.direction, arm.axes[i].line.direction)))


def slanted(arm: Arm, i: int, taken: bool) -> str:
    """What was done with an axis that is almost parallel to the one before, as a sentence."""
    before, axis = arm.axes[i - 1], arm.axes[i]
    away = float(length(plus(before.line.nearest(axis.line), before.line.point, -1)))
    said = f"joints {before.joint.name} and {axis.joint.name} (line {axis.joint.location.line})"
    done = "taken as parallel" if taken else "kept"
    return (
        f"{said} are {slant(arm, i):.2g} rad from parallel, their common normal {float(f'{away:.3g}'):g} m away: {done}"
    )


def named(cut: CutOff, taken: bool) -> str:
    """What was done with angles that somebody cut off, as a sentence."""
    told = [
        f"{float(angle):.12g} (joint {joint.name}, line {joint.location.line})" for joint, angle in cut[:MOST_NAMED]
    ]
    more = ", ..." if len(cut) > MOST_NAMED else ""
    return f"{', '.join(told)}{more}: {'taken for' if taken else 'almost'} fractions of pi"

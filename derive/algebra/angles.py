"""Exact constant angles: what part is a multiple of pi, what part is a sum of symbols.

An angle is written ``f*pi + sum k_j*u_j`` with rational f and k_j, where each unit u_j is a name, a plain number of
radians or an expression that is not a sum. Sines and cosines of multiples of pi/2, pi/4, pi/6 are algebraic numbers;
every other unit keeps its own sine and cosine.

Groups of joints whose angles books add: revolute joints with aligned, parallel axes.

A group decides only how an expression is written, never what it is: sums of angles are as good a basis as the angles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from derive.robot.description import Convention
from derive.robot.expression import Expression, Number, Pi, Power, Product, Sum
from derive.robot.robot import Robot
from derive.robot.style import Contraction

Terms = tuple[tuple[Expression, Fraction], ...]


@dataclass(frozen=True, slots=True)
class ExactAngle:
    """``pi_multiple*pi + sum coefficient*unit``.

    Attributes:
        pi_multiple: Factor of pi.
        terms: Pairs (unit, coefficient), coefficient not zero, in order of first appearance. A plain number of
            radians r appears as the unit ``Number(1)`` with coefficient r.
    """

    pi_multiple: Fraction
    terms: Terms


def decompose(angle: Expression) -> ExactAngle:
    """Split an angle [rad] into its multiple of pi and its units."""
    parts: dict[Expression | None, Fraction] = {}
    _collect(angle, Fraction(1), parts)
    pi_multiple = parts.pop(None, Fraction(0))
    terms = tuple((unit, k) for unit, k in parts.items() if unit is not None and k)
    return ExactAngle(pi_multiple, terms)


def _collect(e: Expression, factor: Fraction, parts: dict[Expression | None, Fraction]) -> None:
    if isinstance(e, Sum):
        for term in e.terms:
            _collect(term, factor, parts)
        return
    number, rest = split_coefficient(e)
    if isinstance(rest, Sum):
        _collect(rest, factor * number, parts)
        return
    key = None if isinstance(rest, Pi) else rest
    parts[key] = parts.get(key, Fraction(0)) + factor * number


def split_coefficient(e: Expression) -> tuple[Fraction, Expression]:
    """A product as (rational factor, rest); a bare number r as (r, Number(1))."""
    one = Number(Fraction(1))
    if isinstance(e, Number):
        return e.value, one
    if isinstance(e, Power) and isinstance(e.base, Number) and (e.base.value or e.exponent > 0):
        return e.base.value**e.exponent, one
    if not isinstance(e, Product):
        return Fraction(1), e
    number, rest = Fraction(1), []
    for factor in e.factors:
        k, r = split_coefficient(factor)
        number *= k
        if r != one:
            rest.append(r)
    if not rest:
        return number, one
    return number, rest[0] if len(rest) == 1 else Product(tuple(rest))


Row = tuple[float, float, float]
Rotation = tuple[Row, Row, Row]

IDENTITY: Rotation = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_UNIT_STEP = 0.737_912
"""Stand-in for the first symbolic angle; any value that is no multiple of pi will do."""


def aligned_groups(robot: Robot) -> tuple[tuple[int, ...], ...]:
    """Maximal runs of revolute joints (indices from 0) whose axes are parallel and point the same way.

    The sign of the variable counts as a direction: ``theta: -q`` on an axis that points down is aligned with ``theta:
    q`` on one that points up. Prismatic joints may stand between the joints of a group.
    """
    return _groups(robot, Contraction.ALIGNED)[0]


def contracted_groups(robot: Robot, contraction: Contraction) -> tuple[tuple[tuple[int, ...], ...], tuple[int, ...]]:
    """The groups whose angles are summed, and for every joint its direction (+1 or -1) within its group.

    With `Contraction.OPPOSED` axes that point opposite ways belong to one group, and their angles are subtracted.
    """
    return _groups(robot, contraction)


def _groups(robot: Robot, contraction: Contraction) -> tuple[tuple[tuple[int, ...], ...], tuple[int, ...]]:
    groups: list[list[int]] = []
    directions = [1] * robot.n
    relative = IDENTITY
    units: dict[Expression, float] = {}
    standard = robot.convention is Convention.STANDARD
    for i, joint in enumerate(robot.joints):
        twist = _about_x(_value(joint.alpha, units))
        if not standard:
            relative = _product(relative, twist)
        if joint.is_revolute:
            last = groups[-1][-1] if groups else -1
            turn = _direction(relative) * joint.sign * robot.joints[last].sign if groups else 0
            if turn == 1 or (turn == -1 and contraction is Contraction.OPPOSED):
                groups[-1].append(i)
                directions[i] = turn * directions[last]
            else:
                groups.append([i])
            relative = IDENTITY
        else:
            relative = _product(relative, _about_z(_value(joint.theta, units)))
        if standard:
            relative = _product(relative, twist)
    return tuple(tuple(group) for group in groups), tuple(directions)


def _direction(relative: Rotation) -> int:
    """+1 where the z axes are aligned, -1 where they are opposed, else 0."""
    cosine = relative[2][2]
    return round(cosine) if abs(abs(cosine) - 1) < 1e-12 else 0


def _value(angle: Expression, units: dict[Expression, float]) -> float:
    exact = decompose(angle)
    total = float(exact.pi_multiple) * math.pi
    for unit, k in exact.terms:
        default = 1.0 if isinstance(unit, Number) else _UNIT_STEP * (1 + 0.618_034 * len(units))
        total += float(k) * units.setdefault(unit, default)
    return total


def _about_x(angle: float) -> Rotation:
    c, s = math.cos(angle), math.sin(angle)
    return ((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c))


def _about_z(angle: float) -> Rotation:
    c, s = math.cos(angle), math.sin(angle)
    return ((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0))


def _product(a: Rotation, b: Rotation) -> Rotation:
    rows = [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    return (
        (rows[0][0], rows[0][1], rows[0][2]),
        (rows[1][0], rows[1][1], rows[1][2]),
        (rows[2][0], rows[2][1], rows[2][2]),
    )

"""Exact angles: what part is a multiple of pi, what part a sum of symbols, and which joints add theirs.

An angle is written ``f*pi + sum k_j*u_j`` with rational f and k_j, where each unit u_j is a name, a plain number of
radians or an expression that is not a sum. Sines and cosines of multiples of pi/2, pi/4, pi/6 are algebraic numbers;
every other unit keeps its own sine and cosine.

Joint angles come in groups: those of revolute joints with parallel axes, which books add. A group decides only how an
expression is written, never what it is: sums of angles are as good a basis as the angles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from itertools import combinations, pairwise

from derive.robot import tree
from derive.robot.description import Convention, Stand
from derive.robot.evaluate import evaluate
from derive.robot.expression import ZERO, Expression, Name, Number, Pi, Power, Product, Sum, add, multiply, names
from derive.robot.options.style import Contraction
from derive.robot.robot import Robot

Terms = tuple[tuple[Expression, Fraction], ...]
Axis = tuple[float, float, float]
Groups = tuple[tuple[int, ...], ...]
_UNIT_STEP = 0.737_912  # stand-in for the first symbolic angle; any value that is no multiple of pi will do


@dataclass(frozen=True, slots=True)
class ExactAngle:
    """``pi_multiple*pi + sum coefficient*unit``."""

    pi_multiple: Fraction  # factor of pi
    # Pairs (unit, coefficient), coefficient not zero, in order of first appearance. A plain number of radians r
    # appears as the unit ``Number(1)`` with coefficient r.
    terms: Terms


@lru_cache(10_000)  # formulas have the same few angles again and again
def decompose(angle: Expression) -> ExactAngle:
    """An angle as a multiple of pi and multiples of its units."""
    parts: dict[Expression | None, Fraction] = {}
    _collect(angle, Fraction(1), parts)
    pi_multiple = parts.pop(None, Fraction(0))
    return ExactAngle(pi_multiple, tuple((unit, k) for unit, k in parts.items() if unit is not None and k))


def composed(angle: ExactAngle) -> Expression:
    """The expression of an angle, its units first."""
    return add(*[multiply(Number(k), unit) for unit, k in angle.terms], multiply(Number(angle.pi_multiple), Pi()))


def _collect(e: Expression, factor: Fraction, parts: dict[Expression | None, Fraction]) -> None:
    if isinstance(e, Sum):
        for term in e.terms:
            _collect(term, factor, parts)
        return
    number, rest = _split_coefficient(e)
    if isinstance(rest, Sum):
        _collect(rest, factor * number, parts)
        return
    key = None if isinstance(rest, Pi) else rest
    parts[key] = parts.get(key, Fraction(0)) + factor * number


def _split_coefficient(e: Expression) -> tuple[Fraction, Expression]:
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
        k, r = _split_coefficient(factor)
        number *= k
        if r != one:
            rest.append(r)
    if not rest:
        return number, one
    return number, rest[0] if len(rest) == 1 else Product(tuple(rest))


@dataclass(frozen=True, slots=True)
class _Reached:
    """A frame of the table, with the revolute joints before it whose axes are parallel."""

    group: tuple[int, ...] = ()  # the last of them, from the base outwards
    axis: Axis = (0.0, 0.0, 1.0)  # that of the last one, in the frame

    def turned(self, about: str, angle: Expression, units: dict[Expression, float]) -> _Reached:
        """The frame that is turned by a constant about z or x."""
        turn = _float(angle, units)
        c, s, (x, y, z) = math.cos(turn), math.sin(turn), self.axis
        axis = (x * c + y * s, y * c - x * s, z) if about == "z" else (x, y * c + z * s, z * c - y * s)
        return replace(self, axis=axis)

    def behind(self, stand: Stand, units: dict[Expression, float]) -> _Reached:
        """The frame behind the mount and gamma of a row."""
        cells = [row[:3] for row in stand.mount[:3]]
        values = {name: _float(Name(name), units) for row in cells for cell in row for name in names(cell)}
        try:
            m = [[evaluate(cell, values) for cell in row] for row in cells]
        except ArithmeticError:  # where the stand-ins give no value nothing is called parallel
            return replace(self, axis=(0.0, 0.0, 0.0))
        x, y, z = (sum(row[k] * along for row, along in zip(m, self.axis, strict=True)) for k in range(3))
        return replace(self, axis=(x, y, z)).turned("z", stand.gamma, units)


def contracted_groups(robot: Robot, contraction: Contraction) -> tuple[Groups, tuple[int, ...]]:
    """Maximal runs of revolute joints with parallel axes, whose angles are summed; in a tree they begin alike.

    The sign of the variable counts as a direction: ``theta: -q`` on an axis that points down is aligned with ``theta:
    q`` on one that points up. Prismatic joints may stand between the joints of a group.
    """
    directions, is_standard = [1] * robot.n, robot.convention is Convention.STANDARD
    units: dict[Expression, float] = {}
    reached: list[_Reached] = []  # DH frames 1 to n
    found: list[tuple[int, ...]] = []
    for i, (joint, way) in enumerate(zip(robot.joints, tree.ways(robot), strict=True)):
        frame = reached[way.joint] if way.joint >= 0 else _Reached()
        for row in way.rows:
            frame = frame.behind(row.stand, units)
            turns = (("z", row.theta), ("x", row.alpha))
            for about, angle in turns if is_standard else reversed(turns):
                frame = frame.turned(about, angle, units)
        if joint.stand:
            frame = frame.behind(joint.stand, units)
        frame = frame if is_standard else frame.turned("x", joint.alpha, units)
        if joint.is_revolute:
            last = frame.group[-1] if frame.group else -1
            # z of the last revolute joint in this frame: (0, 0, 1) is aligned, (0, 0, -1) opposed
            parallel = round(frame.axis[2]) if abs(abs(frame.axis[2]) - 1) < 1e-12 else 0
            turn = parallel * joint.sign * robot.joints[last].sign if frame.group else 0
            joins = turn == 1 or (turn == -1 and contraction is Contraction.OPPOSED)
            directions[i] = turn * directions[last] if joins else 1
            frame = _Reached((*frame.group, i) if joins else (i,))
            found.append(frame.group)
        else:
            frame = frame.turned("z", joint.theta, units)
        reached.append(frame.turned("x", joint.alpha, units) if is_standard else frame)
    groups = [group for group in found if not any(other[: len(group)] == group != other for other in found)]
    return tuple(groups), tuple(directions)


def _float(angle: Expression, units: dict[Expression, float]) -> float:
    """An angle in radians, with a stand-in for every symbolic unit."""
    exact = decompose(angle)
    total = float(exact.pi_multiple) * math.pi
    for unit, k in exact.terms:
        default = 1.0 if isinstance(unit, Number) else _UNIT_STEP * (1 + 0.618_034 * len(units))
        total += float(k) * units.setdefault(unit, default)
    return total


def printed_offsets(robot: Robot, groups: Groups, directions: tuple[int, ...]) -> tuple[Expression, ...]:
    """What is added to each joint angle inside the sines and cosines that are printed [rad]: ``cos(q1 + pi/4)``.

    That is the constant of its cell where it is no multiple of pi/2, sine and cosine of which are numbers that vanish.
    Where constants of a group add up to such a multiple, as two of pi/4 do, the sums of the group are turned by right
    angles until none does: then ``q1 + q2`` has no constant.
    """
    offsets: list[Expression] = [ZERO] * robot.n
    nothing = ExactAngle(Fraction(0), ())
    for group in groups:
        sums = [nothing]  # constants of q_1, q_1 + q_2, ... so far, multiples of pi/2 left out
        for i in group:
            own = decompose(robot.joints[i].theta)
            sums.append(sums[-1] if _is_right(own) else _plus(sums[-1], own, directions[i] * robot.joints[i].sign))
        if any(_is_right(d := _plus(b, a, -1)) and d != nothing for a, b in combinations(sums, 2)):
            sums = [
                ExactAngle((s.pi_multiple + Fraction(1, 4)) % Fraction(1, 2) - Fraction(1, 4), s.terms) for s in sums
            ]
        # the offset of a joint is the step between two sums, in the joint's own direction
        for i, (before, after) in zip(group, pairwise(sums), strict=True):
            offsets[i] = composed(_plus(nothing, _plus(after, before, -1), directions[i]))
    return tuple(offsets)


def _is_right(angle: ExactAngle) -> bool:
    """Whether an angle is a multiple of pi/2."""
    return not angle.terms and (2 * angle.pi_multiple).denominator == 1


def _plus(a: ExactAngle, b: ExactAngle, factor: int) -> ExactAngle:
    """a + factor*b."""
    parts = dict(a.terms)
    for unit, k in b.terms:
        parts[unit] = parts.get(unit, Fraction(0)) + factor * k
    return ExactAngle(a.pi_multiple + factor * b.pi_multiple, tuple((u, k) for u, k in parts.items() if k))

"""Formulas at random points, with fifty digits: counter-examples, and the last resort where algebra cannot decide."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath

from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, names
from derive.robot.robot import Robot

Real = Any
Values = Mapping[str, Fraction]

DIGITS = 50
POINTS = 8
TRIALS = 240
CLOSE = mpmath.mpf(10) ** -30
"""Relative difference below which two values with fifty digits are the same number."""

LARGEST = mpmath.mpf(10) ** 300
"""Values beyond it do not fit into a float and count as none."""

VISIBLE = mpmath.mpf(10) ** -3
"""Relative difference that a reader sees in a few digits; a counter-example should show one."""


def _root(value: Real) -> Real:
    if value < 0:
        raise ValueError("root of a negative number")
    return mpmath.sqrt(value)


_FUNCTIONS: Mapping[str, Callable[..., Real]] = {
    "sin": mpmath.sin,
    "cos": mpmath.cos,
    "tan": mpmath.tan,
    "sqrt": _root,
    "atan2": mpmath.atan2,
    "sign": mpmath.sign,
}


@dataclass(frozen=True, slots=True)
class CounterExample:
    """A point at which two formulas differ.

    Attributes:
        values: A number for every name in them, in SI units and radians.
        printed: Value of the formula in question.
        right: Value of the derived one.
    """

    values: tuple[tuple[str, Fraction], ...]
    printed: float
    right: float


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two formulas at some points.

    Attributes:
        points: At how many points both have a real value.
        differing: The point where they differ most visibly, if they differ at any.
    """

    points: int
    differing: CounterExample | None


def compare_at_points(robot: Robot, ours: Expression, theirs: Expression) -> Comparison:
    """Both formulas at random points where both have real values; deterministic."""
    wanted = sorted({*names(ours), *names(theirs)})
    found: list[tuple[Real, CounterExample]] = []
    points = 0
    with mpmath.workdps(DIGITS):
        for values in _samples(robot, wanted):
            right, printed = evaluate(ours, values), evaluate(theirs, values)
            if right is None or printed is None:
                continue
            points += 1
            gap = abs(right - printed) / (1 + abs(right) + abs(printed))
            if gap > CLOSE:
                example = CounterExample(tuple(values.items()), float(printed), float(right))
                found.append((min(gap, VISIBLE), example))
            if points == POINTS:
                break
    worst = max(found, key=lambda pair: pair[0], default=None)
    return Comparison(points, worst[1] if worst else None)


def evaluate(expression: Expression, values: Values) -> Real | None:
    """Value with the working precision of mpmath; None where it is no real number or does not fit into a float."""
    try:
        value = _value(expression, values)
    except (ArithmeticError, ValueError):
        return None
    return value if abs(value) < LARGEST else None


def _value(e: Expression, values: Values) -> Real:
    match e:
        case Number(value):
            return mpmath.mpf(value.numerator) / value.denominator
        case Pi():
            return +mpmath.pi
        case Name(name):
            return mpmath.mpf(values[name].numerator) / values[name].denominator
        case Sum(terms):
            return mpmath.fsum(_value(term, values) for term in terms)
        case Product(factors):
            return mpmath.fprod(_value(factor, values) for factor in factors)
        case Power(base, exponent):
            return _value(base, values) ** exponent
        case Call(function, arguments):
            return _FUNCTIONS[function](*(_value(argument, values) for argument in arguments))


def _samples(robot: Robot, wanted: list[str]) -> Iterator[dict[str, Fraction]]:
    """Points with two decimals, easy to type: angles of either sign, lengths and masses mostly positive."""
    rng = random.Random(1)
    angles = {joint.variable for joint in robot.joints if joint.is_revolute}
    for trial in range(TRIALS):
        point = {}
        for name in wanted:
            size = Fraction(rng.randint(10, 290 if name in angles else 200), 100)
            negative = rng.random() < (0.5 if name in angles else 0.25 * (trial % 2))
            point[name] = -size if negative else size
        yield point

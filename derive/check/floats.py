"""Exact expression trees as floating-point numbers, independent of the algebra that derives the formulas."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction

from derive.errors import ExpressionError
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum
from derive.robot.robot import Robot

FUNCTIONS: Mapping[str, Callable[..., float]] = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "sqrt": math.sqrt,
    "atan2": math.atan2,
}

Values = Mapping[str, Fraction | float]


def to_float(expression: Expression, values: Values) -> float:
    """The number of an expression.

    Args:
        expression: A tree of the cell grammar.
        values: A number for every name in it.

    Raises:
        ExpressionError: A name has no number, or the value does not exist (division by zero,
            root of a negative number).
    """
    try:
        number = float(_value(expression, values))
    except (ArithmeticError, ValueError) as error:
        raise ExpressionError(f"an expression has no finite value: {error}") from error
    if not math.isfinite(number):
        raise ExpressionError("an expression has no finite value: it overflows")
    return number


def parameter_values(robot: Robot, chosen: Mapping[str, float] | None = None) -> dict[str, Fraction | float]:
    """The numbers of all symbols of a robot: those of its file, overridden by ``chosen``.

    Args:
        robot: The robot.
        chosen: Numbers for free symbols, or other numbers for run-time parameters.
    """
    values: dict[str, Fraction | float] = {}
    for name, expression in robot.parameters:
        values[name] = _value(expression, values)
    return {**values, **(chosen or {})}


def _value(expression: Expression, values: Values) -> Fraction | float:
    """Exact as long as everything below is rational, so that differences of close decimals do not lose digits."""
    match expression:
        case Number(value):
            return value
        case Pi():
            return math.pi
        case Name(name):
            if name not in values:
                raise ExpressionError(f"the parameter {name!r} has no number", remedy="give it one")
            return values[name]
        case Sum(terms):
            return _sum(_value(term, values) for term in terms)
        case Product(factors):
            return _product(_value(factor, values) for factor in factors)
        case Power(base, exponent):
            return _value(base, values) ** exponent
        case Call(function, arguments):
            return FUNCTIONS[function](*(_value(argument, values) for argument in arguments))


def _sum(numbers: Iterable[Fraction | float]) -> Fraction | float:
    return sum(numbers, Fraction(0))


def _product(numbers: Iterable[Fraction | float]) -> Fraction | float:
    return math.prod(numbers, start=Fraction(1))

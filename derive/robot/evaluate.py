"""Numeric value of an expression tree, for checks of the robot file only.

Exact expression trees as floating-point numbers, independent of the algebra that derives the formulas.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction

from derive.errors import ExpressionError
from derive.robot.description import Description
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum

_SINGULAR = 1e-12
"""Denominators and cosines under a tangent below it are taken for zero: pi is only known to 1e-16."""

_FUNCTIONS: dict[str, Callable[..., float]] = {
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "sqrt": math.sqrt,
    "atan2": math.atan2,
}


def evaluate(expression: Expression, values: Mapping[str, float]) -> float:
    """Value in floats.

    Args:
        expression: The tree.
        values: Numbers of its names.

    Returns:
        A finite number.

    Raises:
        ArithmeticError: Division by zero, a tangent at its pole, a root of a negative number, or overflow.
        KeyError: A name without a number.
    """
    match expression:
        case Number(value):
            return float(value)
        case Pi():
            return math.pi
        case Name(name):
            return values[name]
        case Sum(terms):
            return _finite(math.fsum(evaluate(term, values) for term in terms))
        case Product(factors):
            return _finite(math.prod(evaluate(factor, values) for factor in factors))
        case Power(base, exponent):
            return _power(base, exponent, values)
        case Call(function, arguments):
            return _call(function, [evaluate(argument, values) for argument in arguments])
    raise TypeError(expression)


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise OverflowError("result is not finite")
    return value


def _power(base: Expression, exponent: int, values: Mapping[str, float]) -> float:
    value = evaluate(base, values)
    if exponent < 0 and (value == 0 or (abs(value) < _SINGULAR and isinstance(base, Sum | Call))):
        raise ZeroDivisionError("division by zero")
    return _finite(value**exponent)


def _call(function: str, arguments: list[float]) -> float:
    if function == "tan" and abs(math.cos(arguments[0])) < _SINGULAR:
        raise ZeroDivisionError("tangent at its pole")
    if function == "sqrt" and arguments[0] < 0:
        raise ArithmeticError("root of a negative number")
    return _finite(_FUNCTIONS[function](*arguments))


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


def parameter_values(robot: Description, chosen: Mapping[str, float] | None = None) -> dict[str, Fraction | float]:
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

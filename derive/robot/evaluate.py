"""Numeric value of an expression tree, for checks of the robot file only."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

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

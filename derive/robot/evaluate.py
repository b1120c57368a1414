"""The number of an exact expression tree, independent of the algebra that derives the formulas."""

import math
from collections.abc import Callable, Mapping
from fractions import Fraction

from derive.errors import ExpressionError
from derive.robot.description import Description
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum

# The functions of the cell grammar and of printed formulas, of floats.
FUNCTIONS: Mapping[str, Callable[..., float]] = {
    function.__name__: function for function in (math.sin, math.cos, math.tan, math.sqrt, math.atan2)
}
Values = Mapping[str, Fraction | float]  # numbers of names; rational ones stay exact in what is computed from them
_SINGULAR = 1e-12  # denominators and cosines under a tangent below it are taken for zero: pi is only known to 1e-16


def evaluate(expression: Expression, values: Values) -> float:
    """The number of an expression, for checks that know the place of a cell in its file."""
    return _finite(_value(expression, values))


def to_float(expression: Expression, values: Values) -> float:
    """The number of an expression, for users of a robot that has been read; see `evaluate`."""
    try:
        return evaluate(expression, values)
    except ArithmeticError as error:
        raise ExpressionError(f"an expression has no finite value: {error}") from error


def parameter_values(robot: Description, chosen: Mapping[str, float] | None = None) -> dict[str, Fraction | float]:
    """The numbers of all symbols of a robot: those of its file, overridden by ``chosen``."""
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
        case Sum(parts) | Product(parts):
            numbers = [_value(part, values) for part in parts]
            exact = all(isinstance(number, Fraction) for number in numbers)
            if isinstance(expression, Product):
                return math.prod(numbers) if exact else _finite(math.prod(map(float, numbers)))
            return sum(numbers, Fraction(0)) if exact else _finite(math.fsum(map(float, numbers)))
        case Power(base, exponent):
            number = _value(base, values)
            tiny = isinstance(number, float) and isinstance(base, Sum | Call) and abs(number) < _SINGULAR
            if exponent < 0 and (number == 0 or tiny):
                raise ZeroDivisionError("division by zero")
            return number**exponent if isinstance(number, Fraction) else _finite(number**exponent)
        case Call(function, arguments):
            points = [float(_value(argument, values)) for argument in arguments]
            if function == "tan" and abs(math.cos(points[0])) < _SINGULAR:
                raise ZeroDivisionError("tangent at its pole")
            if function == "sqrt" and points[0] < 0:
                raise ArithmeticError("root of a negative number")
            return _finite(FUNCTIONS[function](*points))


def _finite(value: Fraction | float) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise OverflowError("result is not finite")
    return number

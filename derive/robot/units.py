"""Degrees and millimetres to radians and metres, exactly.

A *plain number* is an additive term of a cell in which no name occurs: in ``q1 + 90`` it is 90, in ``2*a1 - 20`` it is
20. A number that multiplies a name is a factor without a unit, and names themselves are always in SI units and radians.
Arguments of sin, cos and tan are angles too, in every cell; where pi occurs in an argument, it is in radians already.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from derive.robot.arithmetic import add, contains_pi, is_constant, linear_terms, multiply, number, power
from derive.robot.expression import Call, Expression, Pi, Power, Product, Sum

_DEGREE = multiply(number(Fraction(1, 180)), Pi())
_MILLIMETRE = number(Fraction(1, 1000))
_ANGULAR = frozenset({"sin", "cos", "tan"})


class MixedUnitsError(ValueError):
    """pi stands in an angle cell whose plain numbers are degrees."""


@dataclass(frozen=True, slots=True)
class Units:
    """Units of plain numbers in a file."""

    degrees: bool = False
    millimetres: bool = False


def angle_in_radians(expression: Expression, units: Units) -> Expression:
    """An angle cell in radians.

    Raises:
        MixedUnitsError: pi outside the arguments of functions while angles are degrees.
    """
    if not units.degrees:
        return expression
    if contains_pi(expression):
        raise MixedUnitsError
    return _scaled(_arguments_in_radians(expression), _DEGREE)


def length_in_metres(expression: Expression, units: Units) -> Expression:
    """A length cell in metres."""
    converted = plain_number(expression, units)
    return _scaled(converted, _MILLIMETRE) if units.millimetres else converted


def plain_number(expression: Expression, units: Units) -> Expression:
    """A cell that is neither angle nor length: only arguments of functions change."""
    return _arguments_in_radians(expression) if units.degrees else expression


def _scaled(expression: Expression, unit: Expression) -> Expression:
    """The expression with every plain number multiplied by ``unit``."""
    pairs = linear_terms(expression)
    if not any(is_constant(term) for _, term in pairs):
        return expression
    return add(*(multiply(number(c), term, unit if is_constant(term) else number(1)) for c, term in pairs))


def _arguments_in_radians(expression: Expression) -> Expression:
    match expression:
        case Call(function, arguments):
            converted = tuple(_arguments_in_radians(argument) for argument in arguments)
            if function in _ANGULAR:
                converted = tuple(a if contains_pi(a) else _scaled(a, _DEGREE) for a in converted)
            return Call(function, converted)
        case Sum(parts):
            return add(*(_arguments_in_radians(part) for part in parts))
        case Product(parts):
            return multiply(*(_arguments_in_radians(part) for part in parts))
        case Power(base, exponent):
            return power(_arguments_in_radians(base), exponent)
        case _:
            return expression

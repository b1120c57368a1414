"""An expression tree as text of the cell grammar; parsing the text gives the tree back."""

from __future__ import annotations

from fractions import Fraction

from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum


def to_text(expression: Expression) -> str:
    """The expression as a user would write it in a cell: ``a1 + 2*pi/3 - sqrt(b)/2``."""
    match expression:
        case Number(value):
            return _fraction(value)
        case Pi():
            return "pi"
        case Name(name):
            return name
        case Sum(terms):
            return _sum(terms)
        case Product(factors):
            return _product(factors)
        case Power(base, exponent):
            return f"{_base(base)}**{exponent}" if exponent > 0 else _product((expression,))
        case Call(function, arguments):
            return f"{function}({', '.join(to_text(argument) for argument in arguments)})"
    raise TypeError(expression)


def _fraction(value: Fraction) -> str:
    return str(value.numerator) if value.denominator == 1 else f"{value.numerator}/{value.denominator}"


def _sum(terms: tuple[Expression, ...]) -> str:
    text = to_text(terms[0])
    for term in terms[1:]:
        printed = to_text(term)
        text += f" - {printed[1:]}" if printed.startswith("-") else f" + {printed}"
    return text


def _product(factors: tuple[Expression, ...]) -> str:
    coefficient = Fraction(1)
    if isinstance(factors[0], Number):
        coefficient, factors = factors[0].value, factors[1:]
    sign = "-" if coefficient < 0 else ""
    text = "" if abs(coefficient.numerator) == 1 else str(abs(coefficient.numerator))
    for factor in factors:
        if isinstance(factor, Power) and factor.exponent < 0:
            exponent = "" if factor.exponent == -1 else f"**{-factor.exponent}"
            text = f"{text or '1'}/{_base(factor.base)}{exponent}"
        else:
            text += ("*" if text else "") + _factor(factor)
    if coefficient.denominator != 1:
        text = f"{text}/{coefficient.denominator}"
    return sign + text


def _factor(expression: Expression) -> str:
    return f"({to_text(expression)})" if isinstance(expression, Sum) else to_text(expression)


def _base(expression: Expression) -> str:
    plain = isinstance(expression, Name | Pi | Call)
    if isinstance(expression, Number):
        plain = expression.value.denominator == 1 and expression.value >= 0
    return to_text(expression) if plain else f"({to_text(expression)})"

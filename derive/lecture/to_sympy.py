"""Exact expressions and printed factors as SymPy objects: plain symbols, plain sines and cosines."""

from __future__ import annotations

from functools import cache
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.lecture.terms import PrintedFactor
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum

Expr = Any
"""A SymPy expression; SymPy comes without types."""

Matrix = Any
"""A SymPy matrix; those of a model are immutable."""

_FUNCTIONS = {
    "sin": sympy.sin,
    "cos": sympy.cos,
    "tan": sympy.tan,
    "sqrt": sympy.sqrt,
    "atan2": sympy.atan2,
    "sign": sympy.sign,
}


@cache
def expression_to_sympy(e: Expression) -> Expr:
    """The SymPy form of an exact expression; every name becomes a plain symbol.

    Args:
        e: Any tree.
    """
    match e:
        case Number(value):
            return sympy.Rational(value.numerator, value.denominator)
        case Pi():
            return sympy.pi
        case Name(name):
            return sympy.Symbol(name)
        case Sum(terms):
            return sympy.Add(*(expression_to_sympy(t) for t in terms))
        case Product(factors):
            return sympy.Mul(*(expression_to_sympy(f) for f in factors))
        case Power(base, exponent):
            return expression_to_sympy(base) ** exponent
        case Call(function, arguments):
            return _FUNCTIONS[function](*(expression_to_sympy(a) for a in arguments))


def factor_to_sympy(domain: PolynomialDomain, factor: PrintedFactor) -> Expr:
    """One printed factor as a SymPy expression.

    Args:
        domain: Says which angles a sine or cosine sums.
        factor: The factor.
    """
    if factor.kind in (Kind.SINE, Kind.COSINE):
        angle = expression_to_sympy(domain.angle_sum(factor.joints))
        return sympy.sin(angle) if factor.kind is Kind.SINE else sympy.cos(angle)
    assert factor.argument is not None
    argument = expression_to_sympy(factor.argument)
    match factor.kind:
        case Kind.CONSTANT_SINE:
            return sympy.sin(argument, evaluate=not argument.has(sympy.pi))
        case Kind.CONSTANT_COSINE:
            # SymPy would turn the sine of 36 degrees into nested roots
            return sympy.cos(argument, evaluate=not argument.has(sympy.pi))
        case Kind.ROOT | Kind.PRIME_ROOT:
            return sympy.sqrt(argument)
        case Kind.INVERSE:
            return 1 / argument
        case _:
            return argument

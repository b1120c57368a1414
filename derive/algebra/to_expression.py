"""Exact polynomials as expression trees of the cell grammar."""

from __future__ import annotations

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Generator, Kind
from derive.algebra.ring import Polynomial
from derive.robot.arithmetic import add, multiply, power
from derive.robot.expression import Call, Expression, Number

_CALLS = {
    Kind.SINE: "sin",
    Kind.COSINE: "cos",
    Kind.CONSTANT_SINE: "sin",
    Kind.CONSTANT_COSINE: "cos",
    Kind.ROOT: "sqrt",
    Kind.PRIME_ROOT: "sqrt",
}


def polynomial_expression(p: Polynomial, domain: PolynomialDomain) -> Expression:
    """The polynomial, term by term.

    Args:
        p: An element of the ring of ``domain``.
        domain: Says what the generators stand for.
    """
    return add(*(_term(exponents, Number(coefficient), domain) for exponents, coefficient in p.terms()))


def _term(exponents: tuple[int, ...], coefficient: Expression, domain: PolynomialDomain) -> Expression:
    factors = (power(_base(g), e) for g, e in zip(domain.generators, exponents, strict=True) if e)
    return multiply(coefficient, *factors)


def _base(generator: Generator) -> Expression:
    if generator.kind is Kind.INVERSE:
        return power(generator.argument, -1)
    call = _CALLS.get(generator.kind)
    return generator.argument if call is None else Call(call, (generator.argument,))

"""Exact constant angles: what part is a multiple of pi, what part is a sum of symbols.

An angle is written ``f*pi + sum k_j*u_j`` with rational f and k_j, where each unit u_j is a name, a plain number of
radians or an expression that is not a sum. Sines and cosines of multiples of pi/2, pi/4, pi/6 are algebraic numbers;
every other unit keeps its own sine and cosine.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from derive.robot.expression import Expression, Number, Pi, Power, Product, Sum

Terms = tuple[tuple[Expression, Fraction], ...]


@dataclass(frozen=True, slots=True)
class ExactAngle:
    """``pi_multiple*pi + sum coefficient*unit``.

    Attributes:
        pi_multiple: Factor of pi.
        terms: Pairs (unit, coefficient), coefficient not zero, in order of first appearance. A plain number of
            radians r appears as the unit ``Number(1)`` with coefficient r.
    """

    pi_multiple: Fraction
    terms: Terms


def decompose(angle: Expression) -> ExactAngle:
    """Split an angle [rad] into its multiple of pi and its units."""
    parts: dict[Expression | None, Fraction] = {}
    _collect(angle, Fraction(1), parts)
    pi_multiple = parts.pop(None, Fraction(0))
    terms = tuple((unit, k) for unit, k in parts.items() if unit is not None and k)
    return ExactAngle(pi_multiple, terms)


def _collect(e: Expression, factor: Fraction, parts: dict[Expression | None, Fraction]) -> None:
    if isinstance(e, Sum):
        for term in e.terms:
            _collect(term, factor, parts)
        return
    number, rest = split_coefficient(e)
    if isinstance(rest, Sum):
        _collect(rest, factor * number, parts)
        return
    key = None if isinstance(rest, Pi) else rest
    parts[key] = parts.get(key, Fraction(0)) + factor * number


def split_coefficient(e: Expression) -> tuple[Fraction, Expression]:
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
        k, r = split_coefficient(factor)
        number *= k
        if r != one:
            rest.append(r)
    if not rest:
        return number, one
    return number, rest[0] if len(rest) == 1 else Product(tuple(rest))

"""Whether two expressions are written alike.

Two expressions have the same form when their trees agree after flattening sums and products, ignoring order and
moving signs and rational factors out of products and sums, and nothing else: ``c1*(a2*c2 + a3*c23)`` is not
``a2*c1*c2 + a3*c1*c23``.
"""

from __future__ import annotations

from fractions import Fraction
from math import gcd, lcm
from typing import Any

from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum

Shape = tuple[Any, ...]
"""The form of an expression up to a rational factor; ordered, so that equal forms are equal values."""

ONE: Shape = ("*",)


def same_form(a: Expression, b: Expression) -> bool:
    """Whether two expressions have the same form (and the same rational factor in front)."""
    return form(a) == form(b)


def form(e: Expression) -> tuple[Fraction, Shape]:
    """The rational factor of an expression and the shape of the rest."""
    match e:
        case Number(value):
            return value, ONE
        case Pi():
            return Fraction(1), ("pi",)
        case Name(name):
            return Fraction(1), ("name", name)
        case Sum():
            return _sum(e)
        case Product() | Power():
            return _product(e)
        case Call(function, arguments):
            return Fraction(1), ("call", function, *(form(a) for a in arguments))


def _product(e: Product | Power) -> tuple[Fraction, Shape]:
    factor = Fraction(1)
    factors: dict[Shape, int] = {}
    for base, exponent in _factors(e, 1):
        k, shape = form(base)
        factor *= k**exponent if k else Fraction(0)
        inner = shape[1:] if shape[0] == "*" else ((shape, 1),)
        for part, power in inner:
            factors[part] = factors.get(part, 0) + power * exponent
    kept = sorted(((s, p) for s, p in factors.items() if p), key=repr)
    if len(kept) == 1 and kept[0][1] == 1:
        return factor, kept[0][0]
    return factor, ("*", *kept)


def _factors(e: Expression, exponent: int) -> list[tuple[Expression, int]]:
    """Bases and exponents of the flattened product."""
    if isinstance(e, Product):
        return [pair for f in e.factors for pair in _factors(f, exponent)]
    if isinstance(e, Power):
        return _factors(e.base, exponent * e.exponent)
    return [(e, exponent)]


def _sum(e: Sum) -> tuple[Fraction, Shape]:
    terms: list[tuple[Fraction, Shape]] = []
    for term in e.terms:
        k, shape = form(term)
        if shape[0] == "+":
            terms.extend((k * inner, s) for inner, s in shape[1:])
        elif k:
            terms.append((k, shape))
    if len(terms) < 2:
        return terms[0] if terms else (Fraction(0), ONE)
    terms.sort(key=lambda pair: (repr(pair[1]), pair[0]))
    content = _content([k for k, _ in terms])
    if terms[0][0] < 0:
        content = -content
    return content, ("+", *((k / content, s) for k, s in terms))


def _content(numbers: list[Fraction]) -> Fraction:
    """The positive rational that leaves whole numbers without a common factor."""
    return Fraction(gcd(*(k.numerator for k in numbers)), lcm(*(k.denominator for k in numbers)))

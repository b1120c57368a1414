"""Product forms: a sum that is a product of sums, such as (a2*c2 + a3*c23)**2."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from derive.algebra.plan import Plan, Term, Times, flat
from derive.algebra.ring import fraction
from derive.algebra.terms import Terms

MAX_TERMS = 120
"""Sums with more terms are not factored."""


def product_form(terms: Terms, write: Callable[[Terms], Plan] = flat, *, monomials: bool = False) -> Plan | None:
    """The terms as a product with at least two sums in it (a square counts as two), or None.

    Sines and cosines are independent symbols here: only what is a product by its form is found.

    Args:
        terms: A sum.
        write: How each factor that is a sum is written.
        monomials: Whether a single sum times a monomial counts too.
    """
    if not 2 <= len(terms) <= MAX_TERMS:
        return None
    names = sorted({f for m in terms for f, _ in m})
    content, factors = _polynomial(terms, names).factor()
    coefficient, sums = fraction(content), []
    monomial: dict[int, int] = {}
    for factor, exponent in factors:
        inner = _terms(factor, names)
        if len(inner) > 1:
            sums.append((inner, int(exponent)))
            continue
        ((single, k),) = inner.items()
        coefficient *= k ** int(exponent)
        for f, e in single:
            monomial[f] = monomial.get(f, 0) + e * int(exponent)
    if sum(e for _, e in sums) < 2 and not (monomials and monomial):
        return None
    parts = []
    for inner, exponent in sums:
        sign = -1 if next(iter(inner.values())) < 0 else 1
        coefficient *= Fraction(sign) ** exponent
        parts.append((write({m: sign * c for m, c in inner.items()}), exponent))
    outer = tuple(sorted(monomial.items()))
    return Times(coefficient, outer, tuple(parts)) if parts else Term(coefficient, outer)


def _polynomial(terms: Terms, names: list[int]) -> fmpq_mpoly:
    context = fmpq_mpoly_ctx.get([f"x{i}" for i in names], Ordering.lex)
    place = {f: i for i, f in enumerate(names)}
    data = {}
    for monomial, c in terms.items():
        exponents = [0] * len(names)
        for f, e in monomial:
            exponents[place[f]] = e
        data[tuple(exponents)] = fmpq(c.numerator, c.denominator)
    return context.from_dict(data)


def _terms(p: fmpq_mpoly, names: list[int]) -> Terms:
    return {tuple((names[i], int(e)) for i, e in enumerate(exponents) if e): fraction(c) for exponents, c in p.terms()}

"""What sums and products may share: pairs of factors of a term, and pairs of terms of a sum up to a common factor.

The two-term divisors of multi-level logic synthesis (Rajski and Vasudevamurthy 1992; for polynomials Hosangadi, Fallah
and Kastner 2006), with coefficients: a*x + b*x*y is x*(a + b*y), and with numbers 2*x + 6*y is 2*(x + 3*y).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from derive.algebra.tape_coefficients import Coefficients
from derive.algebra.tape_graph import ONE, Ref
from derive.algebra.tape_network import Monomial

Key = tuple[int, int] | tuple[Monomial, Ref, Monomial, Ref]


class Place(NamedTuple):
    """Where a divisor stands in a polynomial: a term with a pair of factors, or two terms.

    Attributes:
        terms: Monomials of the terms.
        quotient: What is left of the terms without the divisor.
        coefficient: Its coefficient.
        saving: Operations saved here, the divisor itself not counted.
    """

    terms: tuple[Monomial, ...]
    quotient: Monomial
    coefficient: Ref
    saving: int


def factor_pairs(monomial: Monomial, coefficient: Ref) -> Iterator[tuple[Key, Place]]:
    """Pairs of factors of a term; the key of a pair with the coefficient is negative there."""
    if not monomial:
        return
    unit = coefficient >> 1 == ONE >> 1
    if len(monomial) + (not unit) < 2:
        return
    if not unit:
        for i, x in enumerate(monomial):
            if i and monomial[i - 1] == x:
                continue
            quotient = monomial[:i] + monomial[i + 1 :]
            yield (-(coefficient >> 1), x), Place((monomial,), quotient, ONE ^ (coefficient & 1), 1)
    seen = set()
    for i, x in enumerate(monomial):
        for j in range(i + 1, len(monomial)):
            key = (x, monomial[j])
            if key not in seen:
                seen.add(key)
                quotient = monomial[:i] + monomial[i + 1 : j] + monomial[j + 1 :]
                yield key, Place((monomial,), quotient, coefficient, 1)


def term_pairs(a: Monomial, j: Ref, b: Monomial, k: Ref, coefficients: Coefficients) -> list[tuple[Key, Place]]:
    """Two terms of a sum as divisors: as they are, and with the coefficient of the first taken out.

    Args:
        a: Monomial of the first term.
        j: Its coefficient.
        b: Monomial of the second term.
        k: Its coefficient.
        coefficients: Arithmetic of coefficients.
    """
    common = _common(a, b) if a and b else ()
    terms = (a, b)
    before = term_cost(a, j) + term_cost(b, k) + 1 - len(common)
    if common:
        a, b = _less(a, common), _less(b, common)
    if a > b:
        a, j, b, k = b, k, a, j
    sign = j & 1
    found: list[tuple[Key, Place]] = [((a, j ^ sign, b, k ^ sign), Place(terms, common, ONE ^ sign, before))]
    if j >> 1 != 1:
        ratio = coefficients.ratio(k, j)
        if ratio is not None:
            found.append(((a, ONE, b, ratio), Place(terms, common, j, before - 1)))
    return found


def term_cost(monomial: Monomial, coefficient: Ref) -> int:
    """Multiplications of a term."""
    return len(monomial) - 1 + (coefficient >> 1 != 1) if monomial else 0


def _common(a: Monomial, b: Monomial) -> Monomial:
    """The greatest common divisor of two monomials."""
    found: list[int] = []
    i = k = 0
    while i < len(a) and k < len(b):
        if a[i] == b[k]:
            found.append(a[i])
            i, k = i + 1, k + 1
        elif a[i] < b[k]:
            i += 1
        else:
            k += 1
    return tuple(found)


def _less(monomial: Monomial, common: Monomial) -> Monomial:
    """The monomial over a divisor of it."""
    rest = list(monomial)
    for variable in common:
        rest.remove(variable)
    return tuple(rest)

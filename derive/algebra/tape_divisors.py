"""What sums and products may share: pairs of factors of a term, and pairs of terms of a sum up to a common factor.

The two-term divisors of multi-level logic synthesis (Rajski and Vasudevamurthy 1992; for polynomials Hosangadi, Fallah
and Kastner 2006), with coefficients: a*x + b*x*y is x*(a + b*y), and with numbers 2*x + 6*y is 2*(x + 3*y).
"""

from __future__ import annotations

from derive.algebra.tape_coefficients import Coefficients
from derive.algebra.tape_graph import ONE, Ref
from derive.algebra.tape_network import Monomial

Key = tuple[int, int] | tuple[Monomial, Ref, Monomial, Ref]
"""Two factors (a negative first one is minus the index of a coefficient), or two terms."""

Place = tuple[tuple[Monomial, ...], Monomial, Ref, int]
"""Where a divisor stands in a polynomial: the monomials of the terms that hold it, what is left of them without it, the
coefficient, and the operations that are saved there, the divisor itself not counted."""

Found = list[tuple[Key, Place]]


def factor_pairs(monomial: Monomial, coefficient: Ref) -> Found:
    """Pairs of factors of a term, the coefficient among them."""
    found: Found = []
    count = len(monomial)
    here = (monomial,)
    if count and coefficient >> 1 != 1:
        key, rest = -(coefficient >> 1), ONE ^ (coefficient & 1)
        for i, x in enumerate(monomial):
            if not (i and monomial[i - 1] == x):
                found.append(((key, x), (here, monomial[:i] + monomial[i + 1 :], rest, 1)))
    if count < 2:
        return found
    seen = set()
    for i, x in enumerate(monomial):
        for j in range(i + 1, count):
            pair = (x, monomial[j])
            if pair not in seen:
                seen.add(pair)
                left = monomial[:i] + monomial[i + 1 : j] + monomial[j + 1 :]
                found.append((pair, (here, left, coefficient, 1)))
    return found


def term_pairs(a: Monomial, j: Ref, b: Monomial, k: Ref, coefficients: Coefficients) -> Found:
    """Two terms of a sum as divisors: as they are, and with the coefficient of the first taken out.

    Args:
        a: Monomial of the first term.
        j: Its coefficient.
        b: Monomial of the second term.
        k: Its coefficient.
        coefficients: Arithmetic of coefficients.
    """
    common = _common(a, b) if len(a) + len(b) > 2 and a and b else ()
    terms = (a, b)
    saving = (len(a) - 1 + (j >> 1 != 1) if a else 0) + (len(b) - 1 + (k >> 1 != 1) if b else 0) + 1
    if common:
        saving -= len(common)
        a, b = _less(a, common), _less(b, common)
    if a > b:
        a, j, b, k = b, k, a, j
    sign = j & 1
    found: Found = [((a, j ^ sign, b, k ^ sign), (terms, common, ONE ^ sign, saving))]
    if j >> 1 != 1:
        ratio = coefficients.ratio(k, j)
        if ratio is not None:
            found.append(((a, ONE, b, ratio), (terms, common, j, saving - 1)))
    return found


def price(key: Key) -> int:
    """Operations of a divisor."""
    if len(key) == 2:
        return 1
    a, j, b, k = key
    return (len(a) - 1 + (j >> 1 != 1) if a else 0) + (len(b) - 1 + (k >> 1 != 1) if b else 0) + 1


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

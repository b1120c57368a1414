"""Factors of a trigonometric polynomial in the tangents of the half angles, t = tan(q/2).

With c = (1 - t^2)/(1 + t^2) and s = 2t/(1 + t^2) a polynomial of degree d in an angle is one of degree at most 2d in t
over (1 + t^2)^d. Polynomials in t have unique factors. One of even degree 2k stands, over (1 + t^2)^k, for a
trigonometric polynomial again, by t^j/(1 + t^2)^k = sin(q/2)^j cos(q/2)^(2k - j), and so does the square of one of odd
degree; what is left of those stays together in a remainder. Roots at infinity are factors 1 + c.
"""

from __future__ import annotations

from collections.abc import Iterator

from flint import fmpq_mpoly

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial

MAX_TERMS = 1_500
"""Polynomials with more terms in t are not factored."""


class HalfAngles:
    """Factors the polynomials of one domain.

    Args:
        domain: The domain.
    """

    def __init__(self, domain: PolynomialDomain) -> None:
        self._ring = domain.ring
        places = {(g.kind, g.joint): i for i, g in enumerate(domain.generators) if g.joint >= 0}
        self._pairs = [(i, places[Kind.COSINE, joint]) for (kind, joint), i in places.items() if kind is Kind.SINE]

    def factors(self, p: Polynomial) -> tuple[list[tuple[Polynomial, int]], Polynomial]:
        """Factors with more than one term and their exponents, and a remainder; their product is exactly ``p``."""
        bounds = [self._degree(p, pair) for pair in self._pairs]
        numerator = self._in_tangents(p, bounds)
        if len(numerator) > MAX_TERMS:
            return [], p
        content, parts = numerator.factor()
        rest = self._ring.context.constant(content)
        found = []
        for part, power in parts:
            even, exponent = (part, int(power)) if self._is_even(part) else (part**2, int(power) // 2)
            if int(power) % 2 and even is not part:
                rest = rest * part
            if exponent:
                halves = self._halves(even)
                found.append((self._in_angles(even, halves), exponent))
                bounds = [bound - exponent * half for bound, half in zip(bounds, halves, strict=True)]
        found += self._at_infinity([bound - half for bound, half in zip(bounds, self._halves(rest), strict=True)])
        return found, self._in_angles(rest, self._halves(rest))

    def _at_infinity(self, powers: list[int]) -> list[tuple[Polynomial, int]]:
        """1/(1 + t^2) = (1 + c)/2 to the power that an angle has left."""
        generators = self._ring.context.gens()
        pairs = zip(self._pairs, powers, strict=True)
        return [(self._ring.wrap((1 + generators[c]) / 2), power) for (_, c), power in pairs if power]

    def _degree(self, p: Polynomial, pair: tuple[int, int]) -> int:
        sine, cosine = pair
        return max((e[sine] + e[cosine] for e, _ in p.terms()), default=0)

    def _is_even(self, part: fmpq_mpoly) -> bool:
        return not any(int(part.degrees()[cosine]) % 2 for _, cosine in self._pairs)

    def _halves(self, part: fmpq_mpoly) -> list[int]:
        """Half the degree in every tangent, rounded up."""
        return [(int(part.degrees()[cosine]) + 1) // 2 for _, cosine in self._pairs]

    def _in_tangents(self, p: Polynomial, bounds: list[int]) -> fmpq_mpoly:
        """p times the (1 + t^2)^bound of every angle; t takes the place of the cosine."""
        context = self._ring.context
        generators = context.gens()
        total = context.constant(0)
        for exponents, others in self._split(p.raw):
            for (sine, cosine), bound in zip(self._pairs, bounds, strict=True):
                t, a, j = generators[cosine], exponents[sine], exponents[cosine]
                others = others * (2 * t) ** a * (1 - t**2) ** j * (1 + t**2) ** (bound - a - j)
            total += others
        return total

    def _in_angles(self, raw: fmpq_mpoly, halves: list[int]) -> Polynomial:
        """A polynomial in tangents over (1 + t^2)^half of every angle."""
        generators = self._ring.context.gens()
        total = self._ring.context.constant(0)
        for exponents, others in self._split(raw):
            for (sine, cosine), half in zip(self._pairs, halves, strict=True):
                j, s, c = exponents[cosine], generators[sine], generators[cosine]
                lower, odd = divmod(j, 2)
                others = others * s**odd * (1 - c) ** lower * (1 + c) ** (half - lower - odd) / 2**half
            total += others
        return self._ring.wrap(total)

    def _split(self, raw: fmpq_mpoly) -> Iterator[tuple[tuple[int, ...], fmpq_mpoly]]:
        """The exponents of every term, and the term without sines and cosines of joint angles."""
        moving = {i for pair in self._pairs for i in pair}
        for exponents, coefficient in raw.terms():
            rest = tuple(0 if i in moving else int(e) for i, e in enumerate(exponents))
            yield tuple(int(e) for e in exponents), self._ring.context.from_dict({rest: coefficient})

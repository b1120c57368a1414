"""Factors of a polynomial modulo s^2 + c^2 = 1.

Modulo the squares factors are not unique: s^2 = (1 - c)(1 + c). What is taken out first are sines and cosines of the
joint angles and of their sums, whose zeros everybody reads off: s | A(c) + s B(c) exactly where 1 - c^2 divides A,
and c where it divides A and B. For that the polynomial is read in other angles of its groups, q2 and q3 in place of q2
and q2 + q3: the generators of the ring stay, only what they stand for changes (`derive.algebra.contraction` has the
trees of sums). Products stay products on the way there and back, so that a factor in one basis is a factor in all.

The rest is factored in the tangents of the half angles, t = tan(q/2), where factors are unique. With
c = (1 - t^2)/(1 + t^2) and s = 2t/(1 + t^2) a polynomial of degree d in an angle is one of degree at most 2d in t over
(1 + t^2)^d. A factor of even degree 2k stands, over (1 + t^2)^k, for a trigonometric polynomial again, by
t^j/(1 + t^2)^k = sin(q/2)^j cos(q/2)^(2k - j), and so does the square of one of odd degree; what is left of those stays
together in a remainder. Roots at infinity are factors 1 + c.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from math import prod

from flint import fmpq_mpoly

from derive.algebra.contraction import Edge, Tree, paths, trees
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial

# Polynomials with more terms are not factored beyond their sines and cosines: nobody would read the factors.
MAX_FACTORED_TERMS = 400
MAX_TANGENT_TERMS = 1_500  # polynomials with more terms in the tangents are not factored: it would take too long


@dataclass(frozen=True)
class Factor:
    """A power in a product."""

    value: Polynomial  # what is raised
    exponent: int  # at least 1
    kind: Kind | None = None  # `Kind.SINE` or `Kind.COSINE` of a sum of joint angles, None for anything else
    joints: tuple[int, ...] = ()  # the joints (from 0) of that sum


class Factoring:
    """Factors the polynomials of one domain."""

    def __init__(self, domain: PolynomialDomain) -> None:
        self._domain, self._ring, places = domain, domain.ring, domain.places
        # indices of the sine and cosine of every angle
        self._angles = [(i, places[Kind.COSINE, joint]) for (kind, joint), i in places.items() if kind is Kind.SINE]

    def factors(self, p: Polynomial) -> tuple[Factor, ...]:
        """Factors of exactly a polynomial: a rational number that is not 1, sines and cosines, then the others."""
        if not p:
            return (Factor(p, 1),)
        simple, rest = [], p
        for joints in self._domain.groups:
            # every sum of neighbouring angles of a group, as an edge between the nodes before and behind them
            for edge in combinations(range(len(joints) + 1), 2):
                for kind in (Kind.SINE, Kind.COSINE):
                    factor, rest = self._divided(rest, joints, edge, kind)
                    simple += [factor] if factor else []
        # everything else: a rational number and the factors that are no single sine or cosine
        number, others = self._ring.one, [(rest, 1)]
        if len(rest) <= MAX_FACTORED_TERMS:
            others, rest = self._half_angle_factors(rest)
            content, parts = rest.raw.factor()
            others += [(self._ring.wrap(part), int(exponent)) for part, exponent in parts]
            number = self._ring.wrap(self._ring.context.constant(content))
        every = (Factor(number, 1), *simple, *(Factor(value, exponent) for value, exponent in others))
        found = tuple(f for f in every if f.value != 1)
        # the product in the ring decides: it is multiplied out again, modulo s^2 + c^2 = 1
        product = prod((f.value**f.exponent for f in found), start=self._ring.one)
        return found if product == p else (Factor(p, 1),)

    def _divided(
        self, p: Polynomial, joints: tuple[int, ...], edge: Edge, kind: Kind
    ) -> tuple[Factor | None, Polynomial]:
        """The power of one sine or cosine of neighbouring angles that divides a polynomial, and the quotient."""
        bases, places = trees(len(joints), self._domain.adds_angles(joints)), self._domain.places
        # a basis of the group's angles that has the sum of this edge among its generators
        tree = next((tree for tree in bases if edge in tree), None)
        degrees = p.degrees()
        if tree is None or not any(degrees[places[k, joint]] for joint in joints for k in (Kind.SINE, Kind.COSINE)):
            return None, p
        joint = joints[tree.index(edge)]
        exponent, read = 0, self._read(p, joints, bases[0], tree)
        # the multiplicity of the zero: divide as long as nothing is left over
        while (quotient := self._quotient(read, joint, kind)) is not None:
            exponent, read = exponent + 1, quotient
        if not exponent:
            return None, p
        # factor and quotient back in the ring's own angles, which keeps their product what it was
        generator = self._ring.wrap(self._ring.context.gens()[places[kind, joint]])
        value = self._read(generator, joints, tree, bases[0])
        return Factor(value, exponent, kind, joints[slice(*edge)]), self._read(read, joints, tree, bases[0])

    def _read(self, p: Polynomial, joints: tuple[int, ...], now: Tree, then: Tree) -> Polynomial:
        """A polynomial with the angles of a group's generators those of one tree, in those of another."""
        if now == then:
            return p
        ring, places = self._ring, self._domain.places
        generators = ring.context.gens()
        images = list(generators)
        for joint, (lo, hi) in zip(joints, now, strict=True):
            # the angle of an edge is the signed sum of those on the path between its nodes: addition theorem for each
            cosine, sine = ring.one, ring.zero
            for place, sign in paths(then, lo)[hi].items():
                c, s = (ring.wrap(generators[places[kind, joints[place]]]) for kind in (Kind.COSINE, Kind.SINE))
                cosine, sine = cosine * c - sine * (sign * s), sine * c + cosine * (sign * s)
            images[places[Kind.COSINE, joint]], images[places[Kind.SINE, joint]] = cosine.raw, sine.raw
        return ring.wrap(p.raw.compose(*images))

    def _quotient(self, p: Polynomial, joint: int, kind: Kind) -> Polynomial | None:
        """The polynomial divided by the sine or cosine that a joint's generator is; None where there is a rest."""
        generators, places = self._ring.context.gens(), self._domain.places
        s, c = (generators[places[k, joint]] for k in (Kind.SINE, Kind.COSINE))
        if kind is Kind.COSINE:
            quotient, remainder = divmod(p.raw, c)
        else:
            # p = A(c) + s B(c) with B = dp/ds, for s is linear in normal form; A/s = s A/(1 - c^2), since s^2 = 1 - c^2
            by_sine = p.raw.derivative(places[Kind.SINE, joint])
            quotient, remainder = divmod(p.raw - s * by_sine, 1 - c**2)
            quotient = by_sine + s * quotient
        return None if remainder else self._ring.wrap(quotient)

    def _half_angle_factors(self, p: Polynomial) -> tuple[list[tuple[Polynomial, int]], Polynomial]:
        """Factors with more than one term and their exponents, and a remainder; their product is exactly ``p``."""
        # the degree d of every angle, s and c together: (1 + t^2)^d p is a polynomial in t = tan(q/2)
        bounds = [max((e[sine] + e[cosine] for e, _ in p.terms()), default=0) for sine, cosine in self._angles]
        numerator = self._in_tangents(p, bounds)
        if len(numerator) > MAX_TANGENT_TERMS:
            return [], p
        content, parts = numerator.factor()
        rest = self._ring.context.constant(content)
        found = []
        for part, power in parts:
            # of even degree 2k in every t a factor over (1 + t^2)^k is trigonometric; of odd degree its square is, and
            # a single one is left over
            is_even = not any(int(part.degrees()[cosine]) % 2 for _, cosine in self._angles)
            even, exponent = (part, int(power)) if is_even else (part**2, int(power) // 2)
            if int(power) % 2 and not is_even:
                rest = rest * part
            if exponent:
                halves = self._half_degrees(even)
                found.append((self._in_angles(even, halves), exponent))
                bounds = [bound - exponent * half for bound, half in zip(bounds, halves, strict=True)]
        # degrees that no factor has used are roots at infinity, t -> oo: the zero of 1 + c at q = pi
        generators, halves = self._ring.context.gens(), self._half_degrees(rest)
        for (_, cosine), bound, half in zip(self._angles, bounds, halves, strict=True):
            if bound - half:  # 1/(1 + t^2) = (1 + c)/2 to the power that the angle has left
                found.append((self._ring.wrap((1 + generators[cosine]) / 2), bound - half))
        return found, self._in_angles(rest, halves)

    def _half_degrees(self, part: fmpq_mpoly) -> list[int]:
        """Half the degree in every tangent, rounded up."""
        return [(int(part.degrees()[cosine]) + 1) // 2 for _, cosine in self._angles]

    def _in_tangents(self, p: Polynomial, bounds: list[int]) -> fmpq_mpoly:
        """A polynomial times the (1 + t^2)^bound of every angle; t takes the place of the cosine."""
        generators = self._ring.context.gens()
        total = self._ring.context.constant(0)
        for exponents, others in self._split(p.raw):
            for (sine, cosine), bound in zip(self._angles, bounds, strict=True):
                # s^a c^j with s = 2t/(1 + t^2) and c = (1 - t^2)/(1 + t^2)
                t, a, j = generators[cosine], exponents[sine], exponents[cosine]
                others = others * (2 * t) ** a * (1 - t**2) ** j * (1 + t**2) ** (bound - a - j)
            total += others
        return total

    def _in_angles(self, raw: fmpq_mpoly, halves: list[int]) -> Polynomial:
        """A polynomial in tangents over (1 + t^2)^half of every angle."""
        generators = self._ring.context.gens()
        total = self._ring.context.constant(0)
        for exponents, others in self._split(raw):
            for (sine, cosine), half in zip(self._angles, halves, strict=True):
                s, c = generators[sine], generators[cosine]
                # t^e/(1 + t^2)^h = sin^e cos^(2h - e) of q/2; sin^2 = (1 - c)/2, cos^2 = (1 + c)/2, sin cos = s/2
                lower, odd = divmod(exponents[cosine], 2)
                others = others * s**odd * (1 - c) ** lower * (1 + c) ** (half - lower - odd) / 2**half
            total += others
        return self._ring.wrap(total)

    def _split(self, raw: fmpq_mpoly) -> Iterator[tuple[tuple[int, ...], fmpq_mpoly]]:
        """The exponents of every term, and the term without sines and cosines of joint angles."""
        moving = {i for pair in self._angles for i in pair}
        for exponents, coefficient in raw.terms():
            rest = tuple(0 if i in moving else int(e) for i, e in enumerate(exponents))
            yield tuple(int(e) for e in exponents), self._ring.context.from_dict({rest: coefficient})

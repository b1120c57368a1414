"""Factors of a polynomial modulo s^2 + c^2 = 1.

Modulo the squares factors are not unique: s^2 = (1 - c)(1 + c). What is taken out first are sines and cosines of the
joint angles and of their sums, whose zeros everybody reads off: s | A(c) + s B(c) exactly where 1 - c^2 divides A,
and c where it divides A and B. The rest is factored in the tangents of the half angles, where factors are unique.

A polynomial read in other angles of its groups: q2 and q3 in place of q2 and q2 + q3.

The generators of a ring stay; only what they stand for changes: the sine and cosine of a group's i-th generator become
those of the i-th angle of a tree of sums (`derive.algebra.contraction`). Products stay products on the way there and
back, so that a factor found in one basis is a factor in all.

Factors of a trigonometric polynomial in the tangents of the half angles, t = tan(q/2).

With c = (1 - t^2)/(1 + t^2) and s = 2t/(1 + t^2) a polynomial of degree d in an angle is one of degree at most 2d in t
over (1 + t^2)^d. Polynomials in t have unique factors. One of even degree 2k stands, over (1 + t^2)^k, for a
trigonometric polynomial again, by t^j/(1 + t^2)^k = sin(q/2)^j cos(q/2)^(2k - j), and so does the square of one of odd
degree; what is left of those stays together in a remainder. Roots at infinity are factors 1 + c.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

from flint import fmpq_mpoly

from derive.algebra.contraction import Edge, Tree, paths, trees
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial

Pair = tuple[Polynomial, Polynomial]
"""Cosine and sine."""

Bases = Mapping[int, Tree]
"""Group number -> the tree that its generators are read in; groups that are not named are left as they are."""


@dataclass(frozen=True)
class AngleBases:
    """Changes between the angle bases of one domain.

    Args:
        domain: The domain of the polynomials.
    """

    domain: PolynomialDomain

    @cached_property
    def _places(self) -> dict[tuple[Kind, int], int]:
        return {(g.kind, g.joint): i for i, g in enumerate(self.domain.generators) if g.joint >= 0}

    def sine(self, joint: int) -> int:
        """Index of the generator that is the sine of a joint's angle."""
        return self._places[Kind.SINE, joint]

    def cosine(self, joint: int) -> int:
        """Index of the generator that is the cosine of a joint's angle."""
        return self._places[Kind.COSINE, joint]

    def own(self, group: int) -> Tree:
        """The tree that the ring's own generators are: sums from the first joint of the group on, or single angles."""
        return self.trees(group)[0]

    def trees(self, group: int) -> tuple[Tree, ...]:
        """The bases of a group, its own first."""
        joints = self.domain.groups[group]
        return trees(len(joints), len(joints) > 1 and len(self.domain.angles[joints[1]]) > 1)

    def to(self, p: Polynomial, bases: Bases) -> Polynomial:
        """A polynomial in the own angles, read in others."""
        return self._composed(p, {g: _steps(tree, self.own(g)) for g, tree in bases.items()})

    def back(self, p: Polynomial, bases: Bases) -> Polynomial:
        """A polynomial read in other angles, in the own ones."""
        return self._composed(p, {g: _steps(self.own(g), tree) for g, tree in bases.items()})

    def _composed(self, p: Polynomial, steps: Mapping[int, list[dict[int, int]]]) -> Polynomial:
        images = list(self.domain.ring.context.gens())
        for group, paths_of in steps.items():
            joints = self.domain.groups[group]
            for joint, path in zip(joints, paths_of, strict=True):
                cosine, sine = self._sum(joints, path)
                images[self.cosine(joint)], images[self.sine(joint)] = cosine.raw, sine.raw
        return self.domain.ring.wrap(p.raw.compose(*images))

    def _sum(self, joints: tuple[int, ...], path: Mapping[int, int]) -> Pair:
        """Cosine and sine of a signed sum of generator angles."""
        ring = self.domain.ring
        cosine, sine = ring.one, ring.zero
        for place, sign in path.items():
            c, s = (self._generator(index(joints[place])) for index in (self.cosine, self.sine))
            s = sign * s
            cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        return cosine, sine

    def _generator(self, index: int) -> Polynomial:
        return self.domain.ring.generator(self.domain.generators[index].name)


def _steps(basis: Tree, wanted: tuple[Edge, ...]) -> list[dict[int, int]]:
    """Every wanted sum of angles as a signed sum of the angles of a basis."""
    return [paths(basis, lo)[hi] for lo, hi in wanted]


MAX_TANGENT_TERMS = 1_500
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
        if len(numerator) > MAX_TANGENT_TERMS:
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


MAX_TERMS = 400
"""Polynomials with more terms are not factored beyond their sines and cosines."""


@dataclass(frozen=True)
class Factor:
    """A power in a product.

    Attributes:
        value: What is raised.
        exponent: At least 1.
        kind: `Kind.SINE` or `Kind.COSINE` of a sum of joint angles, None for anything else.
        joints: The joints (from 0) of that sum.
    """

    value: Polynomial
    exponent: int
    kind: Kind | None = None
    joints: tuple[int, ...] = ()


class Factoring:
    """Factors the polynomials of one domain.

    Args:
        domain: The domain.
    """

    def __init__(self, domain: PolynomialDomain) -> None:
        self._domain = domain
        self._bases = AngleBases(domain)
        self._half_angles = HalfAngles(domain)

    def factors(self, p: Polynomial) -> tuple[Factor, ...]:
        """Factors whose product is exactly ``p``: a constant, sines and cosines, then the others.

        A factor that is a rational number stands first, where it is not 1.
        """
        if not p:
            return (Factor(p, 1),)
        simple, rest = self._simple(p)
        number, others = self._others(rest)
        found = tuple(f for f in (Factor(number, 1), *simple, *others) if f.value != 1)
        product = self._domain.ring.one
        for f in found:
            product = product * f.value**f.exponent
        return found if product == p else (Factor(p, 1),)

    # -- sines and cosines

    def _simple(self, p: Polynomial) -> tuple[list[Factor], Polynomial]:
        found = []
        for group, joints in enumerate(self._domain.groups):
            for edge in combinations(range(len(joints) + 1), 2):
                for kind in (Kind.SINE, Kind.COSINE):
                    factor, p = self._divided(p, group, (edge[0], edge[1]), kind)
                    found += [factor] if factor else []
        return found, p

    def _divided(self, p: Polynomial, group: int, edge: Edge, kind: Kind) -> tuple[Factor | None, Polynomial]:
        """The power of one sine or cosine that divides ``p``, and the quotient."""
        tree = next((tree for tree in self._bases.trees(group) if edge in tree), None)
        if tree is None or not self._moves_with(p, group):
            return None, p
        joints = self._domain.groups[group]
        bases = {} if tree == self._bases.own(group) else {group: tree}
        joint = joints[tree.index(edge)]
        divide = self._by_sine if kind is Kind.SINE else self._by_cosine
        exponent, read = 0, self._bases.to(p, bases) if bases else p
        while (quotient := divide(read, joint)) is not None:
            exponent, read = exponent + 1, quotient
        if not exponent:
            return None, p
        index = self._bases.sine(joint) if kind is Kind.SINE else self._bases.cosine(joint)
        value = self._bases.back(self._domain.ring.wrap(self._domain.ring.context.gens()[index]), bases)
        return Factor(value, exponent, kind, joints[slice(*edge)]), self._bases.back(read, bases)

    def _moves_with(self, p: Polynomial, group: int) -> bool:
        degrees = p.degrees()
        joints = self._domain.groups[group]
        return any(degrees[i] for j in joints for i in (self._bases.sine(j), self._bases.cosine(j)))

    def _by_sine(self, p: Polynomial, joint: int) -> Polynomial | None:
        generators = self._domain.ring.context.gens()
        s, c = generators[self._bases.sine(joint)], generators[self._bases.cosine(joint)]
        by_sine = p.raw.derivative(self._bases.sine(joint))
        quotient, remainder = divmod(p.raw - s * by_sine, 1 - c**2)
        return None if remainder else self._domain.ring.wrap(by_sine + s * quotient)

    def _by_cosine(self, p: Polynomial, joint: int) -> Polynomial | None:
        quotient, remainder = divmod(p.raw, self._domain.ring.context.gens()[self._bases.cosine(joint)])
        return None if remainder else self._domain.ring.wrap(quotient)

    # -- everything else

    def _others(self, p: Polynomial) -> tuple[Polynomial, list[Factor]]:
        """A rational number and the factors that are no single sine or cosine."""
        ring = self._domain.ring
        if len(p) > MAX_TERMS:
            return ring.one, [Factor(p, 1)]
        found, rest = self._half_angles.factors(p)
        content, parts = rest.raw.factor()
        found += [(ring.wrap(part), int(exponent)) for part, exponent in parts]
        return ring.wrap(ring.context.constant(content)), [Factor(value, exponent) for value, exponent in found]

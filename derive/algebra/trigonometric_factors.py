"""Factors of a polynomial modulo s^2 + c^2 = 1.

Modulo the squares factors are not unique: s^2 = (1 - c)(1 + c). What is taken out first are sines and cosines of the
joint angles and of their sums, whose zeros everybody reads off: s | A(c) + s B(c) exactly where 1 - c^2 divides A,
and c where it divides A and B. The rest is factored in the tangents of the half angles, where factors are unique.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

from derive.algebra.angle_bases import AngleBases
from derive.algebra.contraction import Edge
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.half_angles import HalfAngles
from derive.algebra.ring import Polynomial

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

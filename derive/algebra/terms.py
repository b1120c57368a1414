"""Polynomials as lists of terms in the factors that are printed: contracted sines and cosines, variables, symbols."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import NamedTuple

from derive.algebra.contraction import Contracted, contract
from derive.algebra.domain import Generator, Kind, PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.robot.expression import Expression

Monomial = tuple[tuple[int, int], ...]
"""Pairs (factor, exponent), factors ascending."""

Terms = dict[Monomial, Fraction]


class Factor(NamedTuple):
    """Something that is printed as one factor.

    Attributes:
        kind: What it is.
        joints: The joints (from 0) whose variables it contains: the summed angles of a sine or cosine.
        argument: The expression behind a symbol, root, inverse or constant angle.
    """

    kind: Kind
    joints: tuple[int, ...]
    argument: Expression | None


@dataclass
class FactorTable:
    """Numbers the factors of one domain; the numbering follows first use and is the same in every run.

    Args:
        domain: The domain of the polynomials.
    """

    domain: PolynomialDomain
    factors: list[Factor] = field(default_factory=list)
    _index: dict[Factor, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._plain = [self._plain_factor(g) for g in self.domain.generators]
        place = {(g.kind, g.joint): i for i, g in enumerate(self.domain.generators) if g.joint >= 0}
        self._groups = []
        for group in self.domain.groups:
            sines = [place[Kind.SINE, j] for j in group]
            cosines = [place[Kind.COSINE, j] for j in group]
            sums = len(group) > 1 and len(self.domain.angles[group[1]]) > 1
            self._groups.append((group, tuple(sines + cosines), sums))
        self._in_group = {i for _, places, _ in self._groups for i in places}

    def _plain_factor(self, g: Generator) -> int:
        if g.kind in (Kind.SINE, Kind.COSINE):
            return -1
        joints = (g.joint,) if g.joint >= 0 else ()
        return self.intern(Factor(g.kind, joints, g.argument))

    def intern(self, factor: Factor) -> int:
        """The number of a factor."""
        if factor not in self._index:
            self._index[factor] = len(self.factors)
            self.factors.append(factor)
        return self._index[factor]

    def terms(self, p: Polynomial) -> Terms:
        """The polynomial with every aligned group contracted."""
        rows = [
            ({i: int(e) for i, e in enumerate(exponents) if e}, coefficient)
            for exponents, coefficient in p.sparse_terms()
        ]
        current: list[tuple[dict[int, int], Monomial, Fraction]] = [(row, (), c) for row, c in rows]
        for group, places, sums in self._groups:
            current = self._contract_group(current, group, places, sums)
        result: Terms = {}
        for row, trig, coefficient in current:
            plain = tuple((self._plain[i], e) for i, e in row.items())
            key = tuple(sorted(plain + trig))
            result[key] = result.get(key, Fraction(0)) + coefficient
        return {m: c for m, c in result.items() if c}

    def _contract_group(
        self,
        rows: list[tuple[dict[int, int], Monomial, Fraction]],
        group: tuple[int, ...],
        places: tuple[int, ...],
        sums: bool,
    ) -> list[tuple[dict[int, int], Monomial, Fraction]]:
        """Replace the generators of one group, coefficient by coefficient of everything else."""
        parts: dict[tuple[tuple[tuple[int, int], ...], Monomial], list[tuple[tuple[int, ...], Fraction]]] = {}
        own = set(places)
        result = []
        for row, trig, coefficient in rows:
            if own.isdisjoint(row):
                rest, exponents = row, (0,) * len(places)
            else:
                rest = {i: e for i, e in row.items() if i not in own}
                exponents = tuple(row.get(i, 0) for i in places)
            parts.setdefault((tuple(rest.items()), trig), []).append((exponents, coefficient))
        for (rest_items, trig), items in parts.items():
            if len(items) == 1 and not any(items[0][0]):
                result.append((dict(rest_items), trig, items[0][1]))
                continue
            key = tuple(sorted((e, c.numerator, c.denominator) for e, c in items))
            for term in contract(len(group), sums, key):
                factors = trig + self._trig(group, term)
                result.append((dict(rest_items), factors, Fraction(term.numerator, term.denominator)))
        return result

    def _trig(self, group: tuple[int, ...], term: Contracted) -> Monomial:
        return tuple(
            (self.intern(Factor(Kind.SINE if f.is_sine else Kind.COSINE, group[slice(*f.edge)], None)), f.exponent)
            for f in term.factors
        )


def common_factor(monomials: Iterable[Monomial]) -> Monomial:
    """The greatest monomial that divides all of them."""
    iterator = iter(monomials)
    common = dict(next(iterator))
    for monomial in iterator:
        here = dict(monomial)
        common = {f: min(e, here[f]) for f, e in common.items() if f in here}
        if not common:
            break
    return tuple(sorted(common.items()))


def divide(monomial: Monomial, divisor: Monomial) -> Monomial:
    """monomial / divisor, where it divides."""
    if not divisor:
        return monomial
    rest = dict(monomial)
    for factor, exponent in divisor:
        rest[factor] -= exponent
    return tuple((f, e) for f, e in rest.items() if e)


def project(monomial: Monomial, factors: frozenset[int] | set[int]) -> Monomial:
    """The part of a monomial made of some factors."""
    return tuple((f, e) for f, e in monomial if f in factors)

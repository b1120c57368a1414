"""Polynomials as lists of terms in the factors that are printed: contracted sines and cosines, variables, symbols."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import NamedTuple

from derive.algebra.contraction import Contracted, contract
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Generator, Kind
from derive.algebra.ring import Polynomial, fraction
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


Row = tuple[dict[int, int], Monomial, Fraction]
"""A term on its way: generator exponents, factors already written, coefficient."""


class GroupPlaces(NamedTuple):
    """An aligned group and its generators.

    Attributes:
        joints: The joints, from 0.
        places: Indices of their sines, then of their cosines.
        sums: Whether the generators are sums of angles.
        own: The same indices as a set.
    """

    joints: tuple[int, ...]
    places: tuple[int, ...]
    sums: bool
    own: frozenset[int]

    def may_shorten(self, degrees: tuple[int, ...]) -> bool:
        """Whether contraction can change a polynomial of these degrees at all."""
        if len(self.joints) == 1:
            return degrees[self.places[1]] >= 2
        return any(degrees[i] for i in self.places)


@dataclass
class FactorTable:
    """Numbers the factors of one domain; the numbering depends on the domain alone.

    Args:
        domain: The domain of the polynomials.
    """

    domain: PolynomialDomain
    factors: list[Factor] = field(default_factory=list)
    _index: dict[Factor, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._plain = [self.intern(self._plain_factor(g)) for g in self.domain.generators]
        place = {(g.kind, g.joint): i for i, g in enumerate(self.domain.generators) if g.joint >= 0}
        self._groups = [self._places(group, place) for group in self.domain.groups]
        for group in self.domain.groups:
            self._intern_runs(group)

    def _intern_runs(self, group: tuple[int, ...]) -> None:
        """Number every sum of angles at once, so that the numbers do not depend on what is asked for first."""
        for start in range(len(group)):
            for end in range(start + 1, len(group) + 1):
                self.intern(Factor(Kind.SINE, group[start:end], None))
                self.intern(Factor(Kind.COSINE, group[start:end], None))

    def _places(self, group: tuple[int, ...], place: dict[tuple[Kind, int], int]) -> GroupPlaces:
        places = tuple(place[kind, j] for kind in (Kind.SINE, Kind.COSINE) for j in group)
        sums = len(group) > 1 and len(self.domain.angles[group[1]]) > 1
        return GroupPlaces(group, places, sums, frozenset(places))

    def _plain_factor(self, g: Generator) -> Factor:
        """What a generator prints as when it is left as it is."""
        if g.kind in (Kind.SINE, Kind.COSINE):
            return Factor(g.kind, self.domain.angles[g.joint], None)
        return Factor(g.kind, (g.joint,) if g.joint >= 0 else (), g.argument)

    def intern(self, factor: Factor) -> int:
        """The number of a factor."""
        if factor not in self._index:
            self._index[factor] = len(self.factors)
            self.factors.append(factor)
        return self._index[factor]

    def terms(self, p: Polynomial) -> Terms:
        """The polynomial with every aligned group contracted."""
        degrees = p.degrees()
        rows: list[Row] = [
            ({i: int(e) for i, e in enumerate(exponents) if e}, (), fraction(coefficient))
            for exponents, coefficient in p.raw.terms()
        ]
        for group in self._groups:
            if group.may_shorten(degrees):
                rows = self._contract_group(rows, group)
        result: Terms = {}
        plain = self._plain
        for row, trig, coefficient in rows:
            key = tuple(sorted([(plain[i], e) for i, e in row.items()] + list(trig)))
            result[key] = result.get(key, 0) + coefficient
        return {m: c for m, c in result.items() if c}

    def _contract_group(self, rows: list[Row], group: GroupPlaces) -> list[Row]:
        """Replace the generators of one group, coefficient by coefficient of everything else."""
        parts: dict[object, list[Row]] = {}
        others: list[Row] = []
        for item in rows:
            if group.own.isdisjoint(item[0]):
                others.append(item)
                continue
            rest = tuple(pair for pair in item[0].items() if pair[0] not in group.own)
            parts.setdefault((rest, item[1]), []).append(item)
        result: list[Row] = []
        for item in others:
            # the constant term of a part belongs to it: 1 - c^2 must meet its 1
            parts.get((tuple(item[0].items()), item[1]), result).append(item)
        for part in parts.values():
            result.extend(part if len(part) == 1 else self._contract_part(part, group))
        return result

    def _contract_part(self, part: list[Row], group: GroupPlaces) -> Iterator[Row]:
        """Terms that differ in the generators of one group only."""
        row, trig, _ = part[0]
        rest = {i: e for i, e in row.items() if i not in group.own}
        items = []
        for other, _, coefficient in part:
            exponents = tuple(other.get(i, 0) for i in group.places)
            items.append((exponents, self._own_sign(group, exponents) * coefficient.numerator, coefficient.denominator))
        for term in contract(len(group.joints), group.sums, tuple(sorted(items))):
            coefficient = Fraction(self._run_sign(group.joints, term) * term.numerator, term.denominator)
            yield rest, trig + self._trig(group.joints, term), coefficient

    def _own_sign(self, group: GroupPlaces, exponents: tuple[int, ...]) -> int:
        """The sign that turns sines of single angles into sines of angles counted in the sense of the group."""
        if group.sums:
            return 1
        directions = self.domain.directions
        odd = sum(e for j, e in zip(group.joints, exponents, strict=False) if directions[j] < 0)
        return -1 if odd % 2 else 1

    def _run_sign(self, group: tuple[int, ...], term: Contracted) -> int:
        """The sign that makes the first angle of every sum in a sine positive."""
        odd = sum(f.exponent for f in term.factors if f.is_sine and self.domain.directions[group[f.edge[0]]] < 0)
        return -1 if odd % 2 else 1

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

"""Polynomials as lists of terms in the factors that are printed: contracted sines and cosines, variables, symbols."""

from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import combinations
from typing import NamedTuple

from derive.algebra.contraction import contract
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial, fraction
from derive.robot.expression import Expression

Monomial = tuple[tuple[int, int], ...]  # pairs (factor, exponent), factors ascending
Terms = dict[Monomial, Fraction]


class PrintedFactor(NamedTuple):
    """Something that is printed as one factor."""

    kind: Kind  # what it is
    joints: tuple[int, ...]  # the joints (from 0) whose variables it contains: the summed angles of a sine or cosine
    argument: Expression | None  # the expression behind a symbol, root, inverse or constant angle


# A term on its way: generator exponents, factors already written, coefficient.
Row = tuple[dict[int, int], Monomial, Fraction]


class _Group(NamedTuple):
    """An aligned group and its generators."""

    joints: tuple[int, ...]  # the joints, from 0
    places: tuple[int, ...]  # indices of their sines, then of their cosines
    sums: bool  # whether the generators are sums of angles
    own: frozenset[int]  # the same indices as a set


class FactorTable:
    """Numbers the factors of one domain; the numbering depends on the domain alone."""

    def __init__(self, domain: PolynomialDomain) -> None:
        self.domain = domain
        self.factors: list[PrintedFactor] = []  # what the numbers stand for
        self._index: dict[PrintedFactor, int] = {}
        self._plain = []
        for g in domain.generators:
            if g.kind in (Kind.SINE, Kind.COSINE):
                factor = PrintedFactor(g.kind, domain.angles[g.joint], None)
            else:
                factor = PrintedFactor(g.kind, (g.joint,) if g.joint >= 0 else (), g.argument)
            self._plain.append(self._number(factor))
        self._groups = []
        for joints in domain.groups:
            places = tuple(domain.places[kind, j] for kind in (Kind.SINE, Kind.COSINE) for j in joints)
            self._groups.append(_Group(joints, places, domain.adds_angles(joints), frozenset(places)))
            # every sum of angles at once, so that the numbers do not depend on what is asked for first
            for edge in combinations(range(len(joints) + 1), 2):
                self._number(PrintedFactor(Kind.SINE, joints[slice(*edge)], None))
                self._number(PrintedFactor(Kind.COSINE, joints[slice(*edge)], None))

    def _number(self, factor: PrintedFactor) -> int:
        if factor not in self._index:
            self._index[factor] = len(self.factors)
            self.factors.append(factor)
        return self._index[factor]

    def terms(self, p: Polynomial) -> Terms:
        """A polynomial with every aligned group contracted: c1*c12 + s1*s12 is c2."""
        degrees = p.degrees()
        rows: list[Row] = [
            ({i: int(e) for i, e in enumerate(exponents) if e}, (), fraction(coefficient))
            for exponents, coefficient in p.raw.terms()
        ]
        for group in self._groups:
            # a lone angle is shorter only where 1 - c^2 can become s^2; sums of angles wherever they occur
            if len(group.joints) == 1:
                may_shorten = degrees[group.places[1]] >= 2
            else:
                may_shorten = any(degrees[i] for i in group.places)
            if may_shorten:
                rows = self._contract_group(rows, group)
        result: Terms = {}
        plain = self._plain
        for row, trig, coefficient in rows:
            key = tuple(sorted([(plain[i], e) for i, e in row.items()] + list(trig)))
            result[key] = result.get(key, 0) + coefficient
        return {m: c for m, c in result.items() if c}

    def _contract_group(self, rows: list[Row], group: _Group) -> list[Row]:
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

    def _contract_part(self, part: list[Row], group: _Group) -> Iterator[Row]:
        """Terms that differ in the generators of one group only, contracted with opposed angles turned round."""
        joints = group.joints
        row, trig, _ = part[0]
        rest = {i: e for i, e in row.items() if i not in group.own}
        items = []
        # sin(-q) = -sin q: an odd power of an opposed angle changes the sign of the term
        for other, _, coefficient in part:
            exponents = tuple(other.get(i, 0) for i in group.places)
            sign = 1 if group.sums else self._sign(zip(joints, exponents, strict=False))
            items.append((exponents, sign * coefficient))
        for term in contract(len(joints), group.sums, tuple(sorted(items))):
            sign = self._sign((joints[f.edge[0]], f.exponent) for f in term.factors if f.is_sine)
            written = tuple(
                (
                    self._index[PrintedFactor(Kind.SINE if f.is_sine else Kind.COSINE, joints[slice(*f.edge)], None)],
                    f.exponent,
                )
                for f in term.factors
            )
            yield rest, trig + written, sign * term.coefficient

    def _sign(self, sines: Iterable[tuple[int, int]]) -> int:
        """The sign of a product of powers of sines when the angles that turn against their group are turned round."""
        odd = sum(exponent for joint, exponent in sines if self.domain.directions[joint] < 0)
        return -1 if odd % 2 else 1


def common_factor(monomials: Iterable[Monomial]) -> Monomial:
    """The greatest monomial that divides all of some monomials."""
    iterator = iter(monomials)
    common = dict(next(iterator))
    for monomial in iterator:
        here = dict(monomial)
        common = {f: min(e, here[f]) for f, e in common.items() if f in here}
        if not common:
            break
    return tuple(sorted(common.items()))


def multiply(a: Monomial, b: Monomial) -> Monomial:
    """The product of two monomials."""
    exponents = dict(a)
    for factor, exponent in b:
        exponents[factor] = exponents.get(factor, 0) + exponent
    return tuple(sorted(exponents.items()))


def divide(monomial: Monomial, divisor: Monomial) -> Monomial:
    """The quotient of two monomials."""
    if not divisor:
        return monomial
    rest = dict(monomial)
    for factor, exponent in divisor:
        rest[factor] -= exponent
    return tuple((f, e) for f, e in rest.items() if e)


def project(monomial: Monomial, factors: frozenset[int] | set[int]) -> Monomial:
    """The part of a monomial made of some factors."""
    return tuple((f, e) for f, e in monomial if f in factors)


def partition(terms: Terms, level: frozenset[int]) -> dict[Monomial, Terms]:
    """The terms by their monomials in some factors."""
    parts: dict[Monomial, Terms] = {}
    for monomial, coefficient in terms.items():
        outer = project(monomial, level)
        parts.setdefault(outer, {})[divide(monomial, outer)] = coefficient
    return parts

"""How an expression is written: a tree of sums, products and single terms, with its number of operations.

The terms are those of polynomials in the factors that are printed: contracted sines and cosines, variables, symbols.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import combinations
from math import ceil
from typing import NamedTuple

from flint import Ordering, fmpq, fmpq_mpoly_ctx

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


Row = tuple[dict[int, int], Monomial, Fraction]  # a term on its way: generator exponents, factors written, coefficient


class _Group(NamedTuple):
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
        rows: list[Row] = [({i: int(e) for i, e in enumerate(es) if e}, (), fraction(c)) for es, c in p.raw.terms()]
        for group in self._groups:
            # a lone angle is shorter only where 1 - c^2 can become s^2; sums of angles wherever they occur
            if degrees[group.places[1]] >= 2 if len(group.joints) == 1 else any(degrees[i] for i in group.places):
                rows = self._contract_group(rows, group)
        result: Terms = {}
        for row, trig, coefficient in rows:
            key = tuple(sorted([(self._plain[i], e) for i, e in row.items()] + list(trig)))
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
            kinds = {True: Kind.SINE, False: Kind.COSINE}
            factors = ((PrintedFactor(kinds[f.is_sine], joints[slice(*f.edge)], None), f) for f in term.factors)
            written = tuple((self._index[factor], f.exponent) for factor, f in factors)
            yield rest, trig + written, sign * term.coefficient

    def _sign(self, sines: Iterable[tuple[int, int]]) -> int:
        """The sign of a product of powers of sines when the angles that turn against their group are turned round."""
        return -1 if sum(exponent for joint, exponent in sines if self.domain.directions[joint] < 0) % 2 else 1


def common_factor(monomials: Iterable[Monomial]) -> Monomial:
    """The greatest monomial that divides all of some monomials."""
    iterator = iter(monomials)
    common = dict(next(iterator))
    for monomial in iterator:
        here = dict(monomial)
        if not (common := {f: min(e, here[f]) for f, e in common.items() if f in here}):
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


MAX_TRIED_AS_PRODUCT = 120  # longer sums are not tried as products: the coefficient of a mass that is one is shorter
LARGE_FACTOR = 1000  # from which a factor of a product of decimals gets smaller numbers, see `with_plain_numbers`


@dataclass(frozen=True)
class Term:
    """coefficient * product of powers."""

    coefficient: Fraction
    monomial: Monomial

    @cached_property
    def operations(self) -> int:
        """Multiplications; signs are free."""
        return max(sum(e for _, e in self.monomial) + (abs(self.coefficient) != 1) - 1, 0)


@dataclass(frozen=True)
class Times:
    """coefficient * monomial * product of (inner ** exponent)."""

    coefficient: Fraction
    monomial: Monomial
    inner: tuple[tuple[Plan, int], ...]

    @cached_property
    def operations(self) -> int:
        """Multiplications between the factors and everything inside them."""
        outside = sum(e for _, e in self.monomial) + (abs(self.coefficient) != 1)
        return outside - 1 + sum(exponent + plan.operations for plan, exponent in self.inner)


@dataclass(frozen=True)
class Plus:
    """A sum of two or more parts."""

    parts: tuple[Plan, ...]

    @cached_property
    def operations(self) -> int:
        """Additions and everything inside."""
        return len(self.parts) - 1 + sum(part.operations for part in self.parts)


Plan = Term | Times | Plus
Level = frozenset[int]  # numbers of factors that are collected together
Writer = Callable[[Terms], Plan]


def cheapest(plans: Iterable[Plan]) -> Plan:
    """The plan with the fewest operations, of equally cheap ones the first."""
    return min(plans, key=lambda plan: plan.operations)


def flat(terms: Terms) -> Plan:
    """The sum of the terms as they are."""
    if not (parts := tuple(Term(c, m) for m, c in terms.items())):
        return Term(Fraction(0), ())
    return parts[0] if len(parts) == 1 else Plus(parts)


def factored(terms: Terms, inside: Writer, among: Level | None = None) -> Plan:
    """The common factor of all terms taken out."""
    # among: only these factors may come out, such as gravity alone
    common = common_factor(terms) if len(terms) > 1 else ()
    if among is not None:
        common = project(common, among)
    return inside(terms) if not common else _times(common, inside({divide(m, common): c for m, c in terms.items()}))


def grouped(terms: Terms, level: Level, inside: Writer) -> Plan:
    """Collected by the monomials in some factors: ``m1*(...) + m2*(...)``."""
    return joined(_times(outer, inside(rest)) for outer, rest in partition(terms, level).items())


def joined(plans: Iterable[Plan]) -> Plan:
    """The sum of some plans, without a bracket of its own."""
    flattened = [part for plan in plans for part in (plan.parts if isinstance(plan, Plus) else (plan,))]
    return flattened[0] if len(flattened) == 1 else Plus(tuple(flattened))


def nested(terms: Terms, levels: Sequence[Level]) -> Plan:
    """Grouped level by level, joints from the base outwards ``c1*(a2*c2 + a3*c23)``; common factors outside."""
    if len(terms) <= 1:
        return flat(terms)
    if not levels:
        return factored(terms, flat)
    first, rest = levels[0], levels[1:]
    if not any(f in first for m in terms for f, _ in m):  # nothing of this level occurs
        return nested(terms, rest)
    return factored(terms, lambda inner: grouped(inner, first, lambda part: nested(part, rest)))


def product_form(terms: Terms, write: Writer = flat, *, monomials: bool = False) -> Plan | None:
    """The terms as a product with at least two sums in it, (a2*c2 + a3*c23)**2; None where there are fewer."""
    # Sines and cosines are independent symbols here: only what is a product by its form is found.
    if not 2 <= len(terms) <= MAX_TRIED_AS_PRODUCT:
        return None
    names = sorted({f for m in terms for f, _ in m})
    context = fmpq_mpoly_ctx.get([f"x{i}" for i in names], Ordering.lex)
    powers = ((dict(monomial), fmpq(c.numerator, c.denominator)) for monomial, c in terms.items())
    content, factors = context.from_dict({tuple(e.get(f, 0) for f in names): c for e, c in powers}).factor()
    coefficient, sums, outer = fraction(content), [], Monomial()
    # irreducible factors over the rationals: single terms go in front, sums are what makes it a product
    for factor, exponent in factors:
        inner = {tuple((names[i], int(e)) for i, e in enumerate(key) if e): fraction(c) for key, c in factor.terms()}
        if len(inner) > 1:
            sums.append((inner, int(exponent)))
            continue
        ((single, k),) = inner.items()
        coefficient *= k ** int(exponent)
        outer = multiply(outer, tuple((f, e * int(exponent)) for f, e in single))
    if sum(e for _, e in sums) < 2 and not (monomials and outer):
        return None
    parts = []
    for inner, exponent in sums:
        sign = -1 if next(iter(inner.values())) < 0 else 1  # the first term of every sum is positive
        coefficient *= Fraction(sign) ** exponent
        parts.append((write({m: sign * c for m, c in inner.items()}), exponent))
    return Times(coefficient, outer, tuple(parts)) if parts else Term(coefficient, outer)


def with_plain_numbers(plan: Plan) -> Plan:
    """A product of decimals whose sums have numbers of the size that people write."""
    # Factors come out with whole numbers, -4.8e-8*(141 + 10000*d3)*(...). Powers of ten, which leave every digit what
    # it is, are moved between the number in front and the sums, -4.8e-4*(0.0141 + d3)*(...); what stands in front of a
    # single sum alone is multiplied out, -6.768e-6 - 4.8e-4*d3.
    if not isinstance(plan, Times):
        return plan
    coefficient, sums = plan.coefficient, []
    for inner, exponent in plan.inner:
        # the numbers in front of the terms of a sum; of a sum with another one among its terms none
        parts = inner.parts if isinstance(inner, Plus) else ()
        numbers = [part.coefficient for part in parts if not isinstance(part, Plus)]
        numbers = numbers if len(numbers) == len(parts) else []
        largest = max(map(abs, numbers), default=Fraction(1))
        if largest >= LARGE_FACTOR or (largest < 1 and abs(coefficient) != 1):
            # the power of ten of the largest number, from its digits: no logarithm, which may round
            size = Fraction(10) ** (len(str(int(largest))) - 1 if largest >= 1 else -len(str(ceil(1 / largest) - 1)))
            coefficient *= size**exponent
            inner, numbers = _scaled(inner, 1 / size), [number / size for number in numbers]
        sums.append((inner, exponent))
    # behind a monomial a sum with a bare term, 3*a1*(q1 + 2), stays; any other one takes the number into its terms
    bare = not plan.monomial or not any(abs(number) == 1 for number in numbers)
    if len(sums) == 1 and sums[0][1] == 1 and numbers and bare and coefficient.denominator != 1:
        whole = _scaled(sums[0][0], coefficient)
        return Times(Fraction(1), plan.monomial, ((whole, 1),)) if plan.monomial else whole
    return Times(coefficient, plan.monomial, tuple(sums))


def _scaled(plan: Plan, factor: Fraction) -> Plan:
    """A plan times a number, which every term of a sum takes."""
    if isinstance(plan, Plus):
        return Plus(tuple(_scaled(part, factor) for part in plan.parts))
    return replace(plan, coefficient=factor * plan.coefficient)


def _times(monomial: Monomial, inner: Plan) -> Plan:
    """monomial * inner, merged where inner is a single term or a product; a sum of negatives gets its sign outside."""
    if isinstance(inner, Plus):
        if not monomial:
            return inner
        sign = Fraction(-1 if all(not isinstance(part, Plus) and part.coefficient < 0 for part in inner.parts) else 1)
        return Times(sign, monomial, ((_scaled(inner, sign), 1),))
    return replace(inner, monomial=multiply(inner.monomial, monomial))

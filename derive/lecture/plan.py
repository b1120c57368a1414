"""How an expression is written: a tree of sums, products and single terms, with its number of operations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from derive.lecture.terms import Monomial, Terms, common_factor, divide, project


@dataclass(frozen=True)
class Term:
    """coefficient * product of powers."""

    coefficient: Fraction
    monomial: Monomial

    @cached_property
    def operations(self) -> int:
        """Multiplications; signs are free."""
        factors = sum(e for _, e in self.monomial) + (abs(self.coefficient) != 1)
        return max(factors - 1, 0)


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
Level = frozenset[int]
Writer = Callable[[Terms], Plan]


def flat(terms: Terms) -> Plan:
    """The sum of the terms as they are."""
    parts = tuple(Term(c, m) for m, c in terms.items())
    if not parts:
        return Term(Fraction(0), ())
    return parts[0] if len(parts) == 1 else Plus(parts)


def factored(terms: Terms, inside: Writer, among: Level | None = None) -> Plan:
    """The common factor of all terms (of those factors that are in ``among``) taken out, the rest by ``inside``."""
    common = common_factor(terms) if len(terms) > 1 else ()
    if among is not None:
        common = project(common, among)
    if not common:
        return inside(terms)
    return times(common, inside({divide(m, common): c for m, c in terms.items()}))


def times(monomial: Monomial, inner: Plan) -> Plan:
    """monomial * inner, merged where inner is a single term or a product; a sum of negatives gets its sign outside."""
    if isinstance(inner, Plus):
        if not monomial:
            return inner
        sign, plan = _without_sign(inner)
        return Times(sign, monomial, ((plan, 1),))
    merged = dict(inner.monomial)
    for factor, exponent in monomial:
        merged[factor] = merged.get(factor, 0) + exponent
    outer = tuple(sorted(merged.items()))
    if isinstance(inner, Term):
        return Term(inner.coefficient, outer)
    return Times(inner.coefficient, outer, inner.inner)


def _without_sign(plan: Plus) -> tuple[Fraction, Plus]:
    """A sum whose parts are all negative as -1 times a sum of positive ones."""
    if any(_coefficient(part) >= 0 for part in plan.parts):
        return Fraction(1), plan
    return Fraction(-1), Plus(tuple(_negated(part) for part in plan.parts))


def _coefficient(plan: Plan) -> Fraction:
    return Fraction(1) if isinstance(plan, Plus) else plan.coefficient


def _negated(plan: Plan) -> Plan:
    match plan:
        case Term(coefficient, monomial):
            return Term(-coefficient, monomial)
        case Times(coefficient, monomial, inner):
            return Times(-coefficient, monomial, inner)
        case Plus(parts):
            return Plus(tuple(_negated(part) for part in parts))


def plus(parts: Iterable[Plan]) -> Plan:
    """The sum of the parts, sums inside it merged."""
    flattened: list[Plan] = []
    for part in parts:
        flattened.extend(part.parts if isinstance(part, Plus) else (part,))
    return flattened[0] if len(flattened) == 1 else Plus(tuple(flattened))


def grouped(terms: Terms, level: Level, inside: Writer) -> Plan:
    """Collected by the monomials in the factors of ``level``, each coefficient written by ``inside``."""
    return plus([times(outer, inside(rest)) for outer, rest in partition(terms, level).items()])


def partition(terms: Terms, level: Level) -> dict[Monomial, Terms]:
    """The terms by their monomials in the factors of ``level``."""
    parts: dict[Monomial, Terms] = {}
    for monomial, coefficient in terms.items():
        outer = project(monomial, level)
        parts.setdefault(outer, {})[divide(monomial, outer)] = coefficient
    return parts


def nested(terms: Terms, levels: Sequence[Level]) -> Plan:
    """Grouped by the first level, each coefficient by the next one, and so on; common factors outside.

    ``c1*(a2*c2 + a3*c23)`` where the levels are the joints from the base outwards.
    """
    if len(terms) <= 1:
        return flat(terms)
    if not levels:
        return factored(terms, flat)
    present = {f for m in terms for f, _ in m}
    first, rest = levels[0], levels[1:]
    if not present & first:
        return nested(terms, rest)
    return factored(terms, lambda inner: grouped(inner, first, lambda part: nested(part, rest)))

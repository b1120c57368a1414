"""How an expression is written: a tree of sums, products and single terms, with its number of operations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from derive.algebra.terms import Monomial, Terms, common_factor, divide, project


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
    """monomial * (inner)."""

    monomial: Monomial
    inner: Plan

    @cached_property
    def operations(self) -> int:
        """Multiplications of the outer factors and everything inside."""
        return sum(e for _, e in self.monomial) + self.inner.operations


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


def factored(terms: Terms, inside: Writer) -> Plan:
    """The common factor of all terms taken out, the rest written by ``inside``."""
    common = common_factor(terms) if len(terms) > 1 else ()
    if not common:
        return inside(terms)
    return times(common, inside({divide(m, common): c for m, c in terms.items()}))


def times(monomial: Monomial, inner: Plan) -> Plan:
    """monomial * inner, merged where inner is a single term or a product."""
    if not monomial:
        return inner
    if isinstance(inner, Plus):
        return Times(monomial, inner)
    merged = dict(inner.monomial)
    for factor, exponent in monomial:
        merged[factor] = merged.get(factor, 0) + exponent
    outer = tuple(sorted(merged.items()))
    return Term(inner.coefficient, outer) if isinstance(inner, Term) else Times(outer, inner.inner)


def plus(parts: Sequence[Plan]) -> Plan:
    """The sum of the parts, sums inside it merged."""
    flattened: list[Plan] = []
    for part in parts:
        flattened.extend(part.parts if isinstance(part, Plus) else (part,))
    return flattened[0] if len(flattened) == 1 else Plus(tuple(flattened))


def grouped(terms: Terms, level: Level, inside: Writer) -> Plan:
    """Collected by the monomials in the factors of ``level``, each coefficient written by ``inside``."""
    parts: dict[Monomial, Terms] = {}
    for monomial, coefficient in terms.items():
        outer = project(monomial, level)
        parts.setdefault(outer, {})[divide(monomial, outer)] = coefficient
    return plus([times(outer, inside(rest)) for outer, rest in parts.items()])


def nested(terms: Terms, levels: Sequence[Level]) -> Plan:
    """Grouped by the first level, each coefficient by the next one, and so on; common factors outside.

    ``c1*(a2*c2 + a3*c23)`` where the levels are the joints from the base outwards.
    """
    if len(terms) <= 1 or not levels:
        return factored(terms, flat) if not levels else flat(terms)
    present = {f for m in terms for f, _ in m}
    first, rest = levels[0], levels[1:]
    if not present & first:
        return nested(terms, rest)
    return factored(terms, lambda inner: grouped(inner, first, lambda part: nested(part, rest)))

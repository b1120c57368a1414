"""The lecture form: from an exact polynomial to the expression that a teacher writes.

One replaceable stage between `derive.mechanics` and everything that prints. Aligned angle sums and squares are dealt
with in `derive.algebra.contraction`; here candidates are planned by rules, counted, and the cheapest is turned into
SymPy.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from typing import Any

import sympy

from derive.algebra.domain import Kind, PolynomialDomain
from derive.algebra.plan import Level, Plan, Plus, Term, Times, flat, grouped, nested
from derive.algebra.products import ProductBuilder
from derive.algebra.ring import Polynomial
from derive.algebra.terms import FactorTable, Terms

Expr = Any

MAX_NESTED_TERMS = 300
"""Kinematic entries with more terms are written flat: candidates would cost more time than they give sight."""


class LectureForm:
    """Writes the polynomials of one domain.

    Args:
        domain: The domain of the polynomials.
        inertial: Names of masses and moments of inertia, by which dynamics is grouped.
    """

    def __init__(self, domain: PolynomialDomain, inertial: frozenset[str] = frozenset()) -> None:
        self.domain = domain
        self.table = FactorTable(domain)
        self._inertial_names = inertial
        self._products = ProductBuilder(self.table)
        self._dynamic_cache: dict[Polynomial, Expr] = {}

    def kinematic(self, p: Polynomial) -> Expr:
        """Grouped by joints from the base outwards, or expanded where that is cheaper."""
        terms = self.table.terms(p)
        if len(terms) > MAX_NESTED_TERMS:
            return self.sympy(flat(terms))
        candidates = (nested(terms, self._outwards), flat(terms))
        return self.sympy(min(candidates, key=lambda plan: plan.operations))

    def dynamic(self, p: Polynomial) -> Expr:
        """Grouped by inertial parameter, the geometry expanded inside."""
        if p not in self._dynamic_cache:
            self._dynamic_cache[p] = self.sympy(self.dynamic_plan(p))
        return self._dynamic_cache[p]

    def dynamic_plan(self, p: Polynomial) -> Plan:
        """The plan behind `dynamic`."""
        return grouped(self.table.terms(p), self._inertial, flat)

    # -- levels

    @property
    def _outwards(self) -> Sequence[Level]:
        levels: dict[int, set[int]] = {}
        home = {joint: group[0] for group in self.domain.groups for joint in group}
        for index, factor in enumerate(self.table.factors):
            if factor.kind in (Kind.SINE, Kind.COSINE):
                levels.setdefault(home[factor.joints[0]], set()).add(index)
        return [frozenset(levels[joint]) for joint in sorted(levels)]

    @cached_property
    def _inertial(self) -> Level:
        return frozenset(
            index
            for index, factor in enumerate(self.table.factors)
            if factor.kind is Kind.PARAMETER and getattr(factor.argument, "name", "") in self._inertial_names
        )

    # -- SymPy

    def sympy(self, plan: Plan) -> Expr:
        """The plan as a SymPy expression."""
        match plan:
            case Term(coefficient, monomial):
                return self._products.term(coefficient, monomial)
            case Times(monomial, inner):
                return sympy.Mul(self._products.term(Fraction(1), monomial), self.sympy(inner))
            case Plus(parts):
                return sympy.Add(*(self.sympy(part) for part in parts))

    def size(self, p: Polynomial) -> int:
        """Number of terms of the expanded form, before contraction."""
        return len(p)

    def terms(self, p: Polynomial) -> Terms:
        """The contracted terms, for other ways of writing them."""
        return self.table.terms(p)

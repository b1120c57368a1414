"""The lecture form: from an exact polynomial to the expression that a teacher writes.

One replaceable stage between `derive.mechanics` and everything that prints. Aligned angle sums and squares are dealt
with in `derive.algebra.contraction`; here candidates are planned by rules, counted, and the cheapest is turned into
SymPy. Ties go to the rule that comes first.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factoring import product_form
from derive.algebra.generators import Kind
from derive.algebra.plan import Level, Plan, Plus, Term, Times, factored, flat, grouped, nested
from derive.algebra.products import ProductBuilder
from derive.algebra.ring import Polynomial
from derive.algebra.terms import Factor, FactorTable, Monomial, Terms
from derive.robot.style import Style

Expr = Any

MAX_CANDIDATE_TERMS = 300
"""Entries with more terms are grouped by the first rule alone: candidates would cost more time than they give sight."""


@dataclass(frozen=True)
class SymbolRoles:
    """What the symbols of a robot are, as far as grouping goes.

    Attributes:
        inertial: Masses and moments of inertia.
        gravity: Symbols of the acceleration of gravity.
    """

    inertial: frozenset[str] = frozenset()
    gravity: frozenset[str] = frozenset()


class LectureForm:
    """Writes the polynomials of one domain.

    Args:
        domain: The domain of the polynomials.
        roles: What its symbols are.
        style: How expressions are grouped.
    """

    def __init__(
        self, domain: PolynomialDomain, roles: SymbolRoles | None = None, style: Style = Style.COMPACT
    ) -> None:
        self.domain = domain
        self.table = FactorTable(domain)
        self.style = style
        self._roles = roles or SymbolRoles()
        self._products = ProductBuilder(self.table)
        self._dynamic_cache: dict[str, Expr] = {}

    # -- what is written

    def kinematic(self, p: Polynomial) -> Expr:
        """Frames and Jacobians."""
        return self.sympy(self.kinematic_plan(self.table.terms(p)))

    def dynamic(self, p: Polynomial) -> Expr:
        """Inertia, Christoffel symbols, energies."""
        key = p.key()
        if key not in self._dynamic_cache:
            self._dynamic_cache[key] = self.sympy(self.dynamic_plan(self.table.terms(p)))
        return self._dynamic_cache[key]

    def gravity(self, p: Polynomial) -> Expr:
        """Torques of gravity."""
        return self.sympy(self.gravity_plan(self.table.terms(p)))

    def determinant(self, p: Polynomial) -> Expr:
        """Scalars whose zeros matter, as a product wherever they are one."""
        terms = self.table.terms(p)
        return self.sympy(product_form(terms, self.kinematic_plan, monomials=True) or self.kinematic_plan(terms))

    # -- rules

    def kinematic_plan(self, terms: Terms) -> Plan:
        """Nested from the base outwards; or by lengths; or expanded."""
        if self.style is Style.EXPANDED or len(terms) > MAX_CANDIDATE_TERMS:
            return flat(terms)
        if self.style is Style.BY_GEOMETRY:
            return nested(terms, [self._lengths, *self._outwards])
        return _cheapest([nested(terms, [*self._outwards[:1], self._lengths, *self._outwards[1:]]), flat(terms)])

    def dynamic_plan(self, terms: Terms) -> Plan:
        """Grouped by mass and inertia with the geometry expanded inside; or by geometry; or expanded."""
        match self.style:
            case Style.EXPANDED:
                return flat(terms)
            case Style.BY_GEOMETRY:
                return self._by_geometry(terms)
            case Style.COMPACT:
                return grouped(terms, self._inertial, self._geometry_inside)

    def gravity_plan(self, terms: Terms) -> Plan:
        """Grouped by sines and cosines, ``(m1*l1 + m2*a1)*g*c1``; or by geometry; or expanded."""
        match self.style:
            case Style.EXPANDED:
                return flat(terms)
            case Style.BY_GEOMETRY:
                return self._by_geometry(terms)
            case Style.COMPACT:
                return grouped(terms, self._moving | self._gravity, lambda part: factored(part, flat))

    def _by_geometry(self, terms: Terms) -> Plan:
        """``(m1 + m2)*a1**2``: masses and inertias collected for each monomial in everything else."""
        return grouped(terms, self._everything - self._inertial, flat)

    def _geometry_inside(self, terms: Terms) -> Plan:
        """The coefficient of a mass: a product of sums where it is one, else its terms, gravity in front."""
        if len(terms) <= MAX_CANDIDATE_TERMS and (product := product_form(terms)) is not None:
            return _cheapest([product, flat(terms)])
        return factored(terms, flat, self._gravity)

    # -- levels

    @cached_property
    def _outwards(self) -> Sequence[Level]:
        """Sines and cosines group by group from the base outwards."""
        levels: dict[int, set[int]] = {group[0]: set() for group in self.domain.groups}
        home = {joint: group[0] for group in self.domain.groups for joint in group}
        for index, factor in enumerate(self.table.factors):
            if factor.kind in (Kind.SINE, Kind.COSINE):
                levels[home[factor.joints[0]]].add(index)
        return [frozenset(levels[joint]) for joint in sorted(levels)]

    @cached_property
    def _lengths(self) -> Level:
        return self._level(lambda f: f.kind in (Kind.PARAMETER, Kind.VARIABLE))

    @cached_property
    def _inertial(self) -> Level:
        return self._level(lambda f: f.kind is Kind.PARAMETER and _name(f) in self._roles.inertial)

    @cached_property
    def _gravity(self) -> Level:
        return self._level(lambda f: f.kind is Kind.PARAMETER and _name(f) in self._roles.gravity)

    @cached_property
    def _moving(self) -> Level:
        """Sines and cosines of joint angles."""
        return self._level(lambda f: f.kind in (Kind.SINE, Kind.COSINE))

    @cached_property
    def _everything(self) -> Level:
        return self._level(lambda f: True)

    def _level(self, belongs: Callable[[Factor], bool]) -> Level:
        return frozenset(index for index, factor in enumerate(self.table.factors) if belongs(factor))

    # -- SymPy

    def sympy(self, plan: Plan) -> Expr:
        """The plan as a SymPy expression."""
        match plan:
            case Term(coefficient, monomial):
                return self._products.term(coefficient, monomial)
            case Times(coefficient, monomial, inner):
                sums = [self.sympy(part) ** exponent for part, exponent in inner]
                return sympy.Mul(self._products.term(coefficient, monomial), *sums)
            case Plus(parts):
                return sympy.Add(*(self.sympy(part) for part in parts))

    def monomial(self, factors: Monomial) -> Expr:
        """A product of powers."""
        return self._products.term(Fraction(1), factors)

    def write_dynamic(self, terms: Terms) -> Expr:
        """Contracted terms as `dynamic` would write them."""
        return self.sympy(self.dynamic_plan(terms))

    def terms(self, p: Polynomial) -> Terms:
        """The contracted terms, for other ways of writing them."""
        return self.table.terms(p)


def _cheapest(plans: Sequence[Plan]) -> Plan:
    return min(plans, key=lambda plan: plan.operations)


def _name(factor: Factor) -> str:
    return getattr(factor.argument, "name", "")

"""The lecture form: from an exact polynomial to the expression that a teacher writes.

One replaceable stage between the mechanics and everything that prints. Aligned angle sums and squares are dealt with
in `derive.algebra.contraction`; here candidates are planned by rules, counted, and the cheapest is turned into SymPy.
Ties go to the rule that comes first.
"""

from __future__ import annotations

from bisect import insort
from dataclasses import dataclass
from fractions import Fraction
from functools import cmp_to_key
from typing import Any

import sympy
from sympy.core.basic import Basic

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.lecture.plan import Level, Plan, Plus, Term, Times, cheapest, factored, flat, grouped, nested, product_form
from derive.lecture.sympy_conversion import Expr, factor_to_sympy
from derive.lecture.terms import FactorTable, Monomial, Terms
from derive.robot.style import Style

MAX_CANDIDATE_TERMS = 300
"""Entries with more terms are grouped by the first rule alone: candidates would cost more time than they give sight."""

PLAIN = frozenset({Kind.SINE, Kind.COSINE, Kind.VARIABLE, Kind.PARAMETER, Kind.RATE, Kind.ACCELERATION})
"""Factors that SymPy never merges with another or with a number."""

_order = cmp_to_key(Basic.compare)


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

    Attributes:
        table: The numbers of the printed factors.
    """

    def __init__(
        self, domain: PolynomialDomain, roles: SymbolRoles | None = None, style: Style = Style.COMPACT
    ) -> None:
        self.domain = domain
        self.table = FactorTable(domain)
        self.style = style
        self._products = ProductBuilder(self.table)
        self._dynamic_cache: dict[str, Expr] = {}
        roles, factors = roles or SymbolRoles(), list(enumerate(self.table.factors))
        symbols = {i: getattr(f.argument, "name", "") for i, f in factors if f.kind is Kind.PARAMETER}
        self._inertial: Level = frozenset(i for i, name in symbols.items() if name in roles.inertial)
        self._gravity: Level = frozenset(i for i, name in symbols.items() if name in roles.gravity)
        self._lengths: Level = frozenset(i for i, f in factors if f.kind in (Kind.PARAMETER, Kind.VARIABLE))
        self._sines: Level = frozenset(i for i, f in factors if f.kind in (Kind.SINE, Kind.COSINE))
        self._not_inertial: Level = frozenset(i for i, _ in factors) - self._inertial
        homes = [frozenset(group) for group in sorted(domain.groups)]
        self._outwards: list[Level] = [
            frozenset(i for i in self._sines if self.table.factors[i].joints[0] in home) for home in homes
        ]
        """Sines and cosines group by group from the base outwards."""

    def kinematic(self, p: Polynomial) -> Expr:
        """An entry of a frame or Jacobian: nested from the base outwards; or by lengths; or expanded.

        Args:
            p: A polynomial of the domain.
        """
        return self.sympy(self._kinematic_plan(self.table.terms(p)))

    def _kinematic_plan(self, terms: Terms) -> Plan:
        outwards = self._outwards
        if self.style is Style.EXPANDED or len(terms) > MAX_CANDIDATE_TERMS:
            return flat(terms)
        if self.style is Style.BY_GEOMETRY:
            return nested(terms, [self._lengths, *outwards])
        return cheapest([nested(terms, [*outwards[:1], self._lengths, *outwards[1:]]), flat(terms)])

    def determinant(self, p: Polynomial) -> Expr:
        """A scalar whose zeros matter, as a product wherever it is one.

        Args:
            p: A polynomial of the domain.
        """
        terms = self.table.terms(p)
        return self.sympy(product_form(terms, self._kinematic_plan, monomials=True) or self._kinematic_plan(terms))

    def dynamic(self, p: Polynomial) -> Expr:
        """An inertia, Christoffel symbol or energy.

        Grouped by mass and inertia with the geometry expanded inside; or by geometry; or expanded.

        Args:
            p: A polynomial of the domain.
        """
        key = p.key()
        if key not in self._dynamic_cache:
            self._dynamic_cache[key] = self.write_dynamic(self.table.terms(p))
        return self._dynamic_cache[key]

    def write_dynamic(self, terms: Terms) -> Expr:
        """Contracted terms as `dynamic` writes them.

        Args:
            terms: A sum in the factors of `table`.
        """
        match self.style:
            case Style.EXPANDED:
                return self.sympy(flat(terms))
            case Style.BY_GEOMETRY:
                return self.sympy(self._by_geometry(terms))
            case Style.COMPACT:
                return self.sympy(grouped(terms, self._inertial, self._geometry_inside))

    def gravity(self, p: Polynomial) -> Expr:
        """A torque of gravity.

        Grouped by sines and cosines, ``(m1*l1 + m2*a1)*g*c1``; or by geometry; or expanded.

        Args:
            p: A polynomial of the domain.
        """
        terms = self.table.terms(p)
        match self.style:
            case Style.EXPANDED:
                return self.sympy(flat(terms))
            case Style.BY_GEOMETRY:
                return self.sympy(self._by_geometry(terms))
            case Style.COMPACT:
                level = self._sines | self._gravity
                return self.sympy(grouped(terms, level, lambda part: factored(part, flat)))

    def _by_geometry(self, terms: Terms) -> Plan:
        """``(m1 + m2)*a1**2``: masses and inertias collected for each monomial in everything else."""
        return grouped(terms, self._not_inertial, flat)

    def _geometry_inside(self, terms: Terms) -> Plan:
        """The coefficient of a mass: a product of sums where it is one, else its terms, gravity in front."""
        if len(terms) <= MAX_CANDIDATE_TERMS and (product := product_form(terms)) is not None:
            return cheapest([product, flat(terms)])
        return factored(terms, flat, self._gravity)

    def sympy(self, plan: Plan) -> Expr:
        """The plan as a SymPy expression.

        Args:
            plan: A plan in the factors of `table`.
        """
        match plan:
            case Term(coefficient, monomial):
                return self._products.term(coefficient, monomial)
            case Times(coefficient, monomial, inner):
                sums = [self.sympy(part) ** exponent for part, exponent in inner]
                return sympy.Mul(self._products.term(coefficient, monomial), *sums)
            case Plus(parts):
                return sympy.Add(*(self.sympy(part) for part in parts))

    def monomial(self, factors: Monomial) -> Expr:
        """A product of powers as a SymPy expression.

        Args:
            factors: A monomial in the factors of `table`.
        """
        return self._products.term(Fraction(1), factors)


class ProductBuilder:
    """Turns monomials over a `FactorTable` into SymPy products.

    SymPy's canonical order of the factors is found once, by insertion; asking SymPy for it again and again takes most
    of the time otherwise.

    Args:
        table: What the factor numbers mean.
    """

    def __init__(self, table: FactorTable) -> None:
        self._table = table
        self._powers: dict[tuple[int, int], Expr] = {}
        self._sorted: list[Any] = []
        self._rank: dict[tuple[int, int], int] = {}
        self._cache: dict[tuple[Fraction, Monomial], Expr] = {}

    def term(self, coefficient: Fraction, monomial: Monomial) -> Expr:
        """coefficient * monomial as SymPy's own product would be.

        Args:
            coefficient: A rational.
            monomial: Pairs (number of a factor, exponent).
        """
        key = (coefficient, monomial)
        if key in self._cache:
            return self._cache[key]
        number = sympy.Rational(coefficient.numerator, coefficient.denominator)
        powers = [self._power(pair) for pair in monomial]
        factors = [self._table.factors[f] for f, _ in monomial]
        if not coefficient or not monomial or any(factor.kind not in PLAIN for factor in factors):
            built = sympy.Mul(number, *powers)
        elif len(powers) == 1 and coefficient == 1:
            built = powers[0]
        else:
            ordered = [self._powers[pair] for pair in sorted(monomial, key=self._rank.__getitem__)]
            built = sympy.Mul._from_args(ordered if coefficient == 1 else [number, *ordered])
        self._cache[key] = built
        return built

    def _power(self, pair: tuple[int, int]) -> Expr:
        if pair not in self._powers:
            factor, exponent = pair
            value = factor_to_sympy(self._table.domain, self._table.factors[factor]) ** exponent
            self._powers[pair] = value
            insort(self._sorted, (_order(value), pair), key=lambda item: item[0])
            self._rank = {p: i for i, (_, p) in enumerate(self._sorted)}
        return self._powers[pair]

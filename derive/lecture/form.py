"""The lecture form: from an exact polynomial to the expression that a teacher writes.

One replaceable stage between `derive.mechanics` and everything that prints. Aligned angle sums and squares are dealt
with in `derive.algebra.contraction`; here candidates are planned by rules, counted, and the cheapest is turned into
SymPy. Ties go to the rule that comes first.

Products of powers as SymPy objects, in SymPy's canonical order without asking it to find that order again.

Product forms: a sum that is a product of sums, such as (a2*c2 + a3*c23)**2.
"""

from __future__ import annotations

from bisect import insort
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, cmp_to_key
from typing import Any

import sympy
from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx
from sympy.core.basic import Basic

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial, fraction
from derive.lecture.plan import Level, Plan, Plus, Term, Times, factored, flat, grouped, nested
from derive.lecture.terms import Factor, FactorTable, Monomial, Terms
from derive.lecture.to_sympy import factor_to_sympy
from derive.robot.style import Style

PLAIN = frozenset({Kind.SINE, Kind.COSINE, Kind.VARIABLE, Kind.PARAMETER, Kind.RATE, Kind.ACCELERATION})
"""Factors that SymPy never merges with another or with a number."""

_order = cmp_to_key(Basic.compare)


class ProductBuilder:
    """Turns monomials over a `FactorTable` into SymPy products.

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
        """coefficient * monomial."""
        key = (coefficient, monomial)
        if key not in self._cache:
            self._cache[key] = self._build(coefficient, monomial)
        return self._cache[key]

    def _build(self, coefficient: Fraction, monomial: Monomial) -> Expr:
        number = sympy.Rational(coefficient.numerator, coefficient.denominator)
        powers = [self._power(pair) for pair in monomial]
        if not coefficient or not monomial or any(self._table.factors[f].kind not in PLAIN for f, _ in monomial):
            return sympy.Mul(number, *powers)
        if len(powers) == 1 and coefficient == 1:
            return powers[0]
        ordered = [self._powers[pair] for pair in sorted(monomial, key=self._rank.__getitem__)]
        return sympy.Mul._from_args(ordered if coefficient == 1 else [number, *ordered])

    def _power(self, pair: tuple[int, int]) -> Expr:
        if pair not in self._powers:
            factor, exponent = pair
            value = factor_to_sympy(self._table.domain, self._table.factors[factor]) ** exponent
            self._powers[pair] = value
            insort(self._sorted, (_order(value), pair), key=lambda item: item[0])
            self._rank = {p: i for i, (_, p) in enumerate(self._sorted)}
        return self._powers[pair]


MAX_TERMS = 120
"""Sums with more terms are not factored."""


def product_form(terms: Terms, write: Callable[[Terms], Plan] = flat, *, monomials: bool = False) -> Plan | None:
    """The terms as a product with at least two sums in it (a square counts as two), or None.

    Sines and cosines are independent symbols here: only what is a product by its form is found.

    Args:
        terms: A sum.
        write: How each factor that is a sum is written.
        monomials: Whether a single sum times a monomial counts too.
    """
    if not 2 <= len(terms) <= MAX_TERMS:
        return None
    names = sorted({f for m in terms for f, _ in m})
    content, factors = _polynomial(terms, names).factor()
    coefficient, sums = fraction(content), []
    monomial: dict[int, int] = {}
    for factor, exponent in factors:
        inner = _terms(factor, names)
        if len(inner) > 1:
            sums.append((inner, int(exponent)))
            continue
        ((single, k),) = inner.items()
        coefficient *= k ** int(exponent)
        for f, e in single:
            monomial[f] = monomial.get(f, 0) + e * int(exponent)
    if sum(e for _, e in sums) < 2 and not (monomials and monomial):
        return None
    parts = []
    for inner, exponent in sums:
        sign = -1 if next(iter(inner.values())) < 0 else 1
        coefficient *= Fraction(sign) ** exponent
        parts.append((write({m: sign * c for m, c in inner.items()}), exponent))
    outer = tuple(sorted(monomial.items()))
    return Times(coefficient, outer, tuple(parts)) if parts else Term(coefficient, outer)


def _polynomial(terms: Terms, names: list[int]) -> fmpq_mpoly:
    context = fmpq_mpoly_ctx.get([f"x{i}" for i in names], Ordering.lex)
    place = {f: i for i, f in enumerate(names)}
    data = {}
    for monomial, c in terms.items():
        exponents = [0] * len(names)
        for f, e in monomial:
            exponents[place[f]] = e
        data[tuple(exponents)] = fmpq(c.numerator, c.denominator)
    return context.from_dict(data)


def _terms(p: fmpq_mpoly, names: list[int]) -> Terms:
    return {tuple((names[i], int(e)) for i, e in enumerate(exponents) if e): fraction(c) for exponents, c in p.terms()}


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

"""The lecture form: from an exact polynomial to the expression that a teacher writes.

One replaceable stage between the mechanics and everything that prints. Aligned angle sums and squares are dealt with
in `derive.algebra.contraction`; here candidates are planned by rules, counted, and the cheapest is turned into SymPy.
Ties go to the rule that comes first.
"""

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from fractions import Fraction
from typing import Self

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.lecture import plan as planning
from derive.lecture.plan import FactorTable, Level, Monomial, Plan, Terms, factored, flat, grouped, joined, project
from derive.lecture.sympy_conversion import Expr, ProductBuilder
from derive.robot.description import Motor
from derive.robot.expression import ZERO, Expression, names
from derive.robot.options import style as options
from derive.robot.options.style import CommonFactors, GravityPlace, Grouping, LengthOrder, Order, ShortSums, Style
from derive.robot.robot import Robot
from derive.robot.rounding import is_given_in_decimals

MOST_SHORT_TERMS = 3  # a kinematic sum with at most so many terms is short, see `ShortSums`
SAVING = 2  # operations that lengths inside a joint's bracket must save, see `LengthOrder.USUAL`
MAX_CANDIDATE_TERMS = 300  # longer entries are grouped by the first rule alone: candidates would cost too much time


@dataclass(frozen=True)
class SymbolRoles:
    """What the symbols of a robot are, as far as grouping goes."""

    inertial: frozenset[str] = frozenset()  # masses and moments of inertia
    gravity: frozenset[str] = frozenset()  # symbols of the acceleration of gravity
    offsets: frozenset[str] = frozenset()  # lengths along joint axes, not those of links
    moments: frozenset[str] = frozenset()  # moments of inertia alone
    point_masses: bool = False  # whether no body has a moment of inertia

    @classmethod
    def of(cls, robot: Robot) -> Self:
        """Symbols by which expressions are grouped; lengths in a moment of inertia are none: m of ``m*l**2/12``."""
        masses: set[str] = set()
        moments: list[Expression] = []
        lengths = {name for joint in robot.joints for cell in (joint.a, joint.d) for name in names(cell)}
        for link in robot.links:
            t, motor = link.inertia, link.motor or Motor()
            lengths.update(name for cell in link.com for name in names(cell))
            masses.update(*(names(cell) for cell in (link.mass, motor.mass)))
            moments += (t.xx, t.yy, t.zz, t.xy, t.xz, t.yz, link.armature, motor.inertia)
        # a moment of inertia with a mass in it, m*l^2/12, is grouped by the mass alone
        plain = [set(names(cell)) for cell in moments if masses.isdisjoint(names(cell))]
        inertias, heavy = frozenset(set().union(*plain) - lengths), frozenset(masses - lengths)
        gravity = frozenset(name for cell in robot.gravity or () for name in names(cell))
        point_masses = robot.has_dynamics and all(cell == ZERO for cell in moments)
        links = {name for joint in robot.joints for name in names(joint.a)}
        offsets = frozenset(name for joint in robot.joints for name in names(joint.d)) - links
        return cls(heavy | inertias, gravity, offsets, inertias, point_masses)


class LectureForm:
    """Writes the polynomials of one domain."""

    def __init__(
        self,
        domain: PolynomialDomain,
        roles: SymbolRoles | None = None,
        style: Style | None = None,
        is_of_short_arm: Callable[[], bool] = lambda: False,
    ) -> None:
        self.domain = domain
        self.table = FactorTable(domain)  # the numbers of the printed factors
        self.style = style or Style()
        self._products = ProductBuilder(self.table)
        self._in_decimals = is_given_in_decimals(domain.robot)
        self._terms: dict[str, Terms] = {}
        self._dynamic_cache: dict[tuple[str, Grouping | None], Expr] = {}
        self.is_of_short_arm = is_of_short_arm  # whether no entry of the arm's T has more than `MOST_SHORT_TERMS`
        roles, factors = roles or SymbolRoles(), list(enumerate(self.table.factors))
        symbols = {i: getattr(f.argument, "name", "") for i, f in factors if f.kind is Kind.PARAMETER}
        self.inertial: Level = frozenset(i for i, name in symbols.items() if name in roles.inertial)
        self._moments: Level = frozenset(i for i, name in symbols.items() if name in roles.moments)
        self._point_masses = roles.point_masses
        self._gravity: Level = frozenset(i for i, name in symbols.items() if name in roles.gravity)
        self._lengths: Level = frozenset(i for i, f in factors if f.kind in (Kind.PARAMETER, Kind.VARIABLE))
        self._offsets = frozenset(i for i, f in factors if f.kind is Kind.VARIABLE or symbols.get(i) in roles.offsets)
        self._sines: Level = frozenset(i for i, f in factors if f.kind in (Kind.SINE, Kind.COSINE))
        self._not_gravity: Level = frozenset(i for i, _ in factors) - self._gravity
        self._not_inertial: Level = frozenset(i for i, _ in factors) - self.inertial
        # sines and cosines group by group from the base outwards
        homes, groups = {i: self.table.factors[i].joints[0] for i in self._sines}, sorted(domain.groups)
        self._outwards: list[Level] = [frozenset(i for i in homes if homes[i] in group) for group in groups]

    def with_style(self, style: Style) -> Self:
        """The form of another style over the same factors."""
        other = copy(self)
        other.style, other._dynamic_cache = style, {}
        return other

    def terms(self, p: Polynomial) -> Terms:
        """A polynomial in the factors that are printed, each one contracted once."""
        if (key := p.key()) not in self._terms:
            self._terms[key] = self.table.terms(p)
        return self._terms[key]

    def kinematic(self, p: Polynomial) -> Expr:
        """An entry of a frame or Jacobian: nested from base or tool, by lengths, or expanded."""
        return self.sympy(self._kinematic_plan(self.terms(p)))

    def _kinematic_plan(self, terms: Terms) -> Plan:
        if len(terms) > MAX_CANDIDATE_TERMS:
            return flat(terms)
        if not any(f in self._lengths for m in terms for f, _ in m):  # an entry of a rotation
            short = self._stays_flat(terms, ShortSums.EXPANDED)
            return flat(terms) if short else self._by_joints(terms, self.style.rotations)
        # an entry of a position
        if self._stays_flat(terms, ShortSums.POSITIONS, ShortSums.EXPANDED):
            return flat(terms)
        match self.style.positions:
            case LengthOrder.USUAL:
                # d6*(c1*(...) + s1*(...)) shows the direction of an offset: kept unless nesting saves operations
                by_base, by_offset = self._by_joints(terms, Order.BASE), self._by_offset(terms)
                saved = by_offset.operations - by_base.operations
                return by_offset if saved < SAVING and self._has_direction(terms) else by_base
            case LengthOrder.OFFSET:
                return self._by_offset(terms)
            case LengthOrder.LENGTH:
                return self._by_length(terms, Order.BASE)
            case LengthOrder.LENGTH_TOOL:
                return self._by_length(terms, Order.TOOL)
            case LengthOrder.LENGTH_EXPANDED:
                return self._by_length(terms, Order.EXPANDED)
            case order:  # the others are called like the orders of rotations, joint by joint
                return self._by_joints(terms, Order(order.value))

    def _has_direction(self, terms: Terms) -> bool:
        """Whether a length multiplies a sum over the brackets of the first joint: ``d6*(c1*(...) + s1*(...))``."""
        first = next((joint for joint in self._outwards if any(f in joint for m in terms for f, _ in m)), frozenset())
        # terms with sines of the first joint, by their length: two monomials in that joint are two brackets
        brackets = planning.partition({m: c for m, c in terms.items() if project(m, first)}, self._lengths)
        return any(len(planning.partition(part, first)) > 1 for part in brackets.values())

    def _by_offset(self, terms: Terms) -> Plan:
        """Each offset in front of the direction that it multiplies; the link lengths nested."""

        def _split(rest: Terms) -> Plan:
            beside = {m: c for m, c in rest.items() if project(m, self._offsets)}
            links = {m: c for m, c in rest.items() if m not in beside}
            plans = [grouped(beside, self._lengths, lambda part: self._by_joints(part, Order.BASE))] if beside else []
            return joined([*plans, *([self._by_joints(links, Order.BASE)] if links else [])])

        return factored(terms, _split)

    def _by_length(self, terms: Terms, inside: Order) -> Plan:
        """Each length in front of what it multiplies, a common sine or cosine in front of all."""
        among = frozenset[int]() if inside is Order.EXPANDED else None

        def _beside(part: Terms) -> Plan:
            short = self._stays_flat(part, ShortSums.POSITIONS, ShortSums.EXPANDED)
            return flat(part) if short else self._by_joints(part, inside)

        return factored(terms, lambda rest: grouped(rest, self._lengths, _beside), among)

    def _by_joints(self, terms: Terms, order: Order) -> Plan:
        """Nested joint by joint, lengths inside the first bracket, if that is no longer than the plain sum."""
        present = {f for m in terms for f, _ in m}
        outwards = [joint for joint in self._outwards if present & joint]
        match order:
            case Order.EXPANDED:
                return flat(terms)
            case Order.BASE_EXPANDED | Order.TOOL_EXPANDED:
                first = outwards[:1] if order is Order.BASE_EXPANDED else outwards[-1:]
                return grouped(terms, first[0], flat) if first else flat(terms)
            case Order.BASE:
                levels = [*outwards[:1], self._lengths, *outwards[1:]]
            case Order.TOOL:
                levels = [*outwards[::-1], self._lengths]
        return planning.cheapest([planning.nested(terms, levels), flat(terms)])

    def _stays_flat(self, terms: Terms, *styles: ShortSums) -> bool:
        """Whether a sum is short and left expanded, in these styles or because the whole arm is short."""
        if len(terms) > MOST_SHORT_TERMS:
            return False
        return self.style.short in styles or (self.style.short is ShortSums.SHORT_ARMS and self.is_of_short_arm())

    def determinant(self, p: Polynomial) -> Expr:
        """A scalar whose zeros matter, as a product wherever it is one."""
        terms = self.terms(p)
        product = planning.product_form(terms, self._kinematic_plan, monomials=True)
        return self.sympy(product or self._kinematic_plan(terms))

    def dynamic(self, p: Polynomial, grouping: Grouping | None = None) -> Expr:
        """An inertia, Christoffel symbol or energy."""
        if (key := (p.key(), grouping)) not in self._dynamic_cache:
            self._dynamic_cache[key] = self.write_dynamic(self.terms(p), grouping)
        return self._dynamic_cache[key]

    def write_dynamic(self, terms: Terms, grouping: Grouping | None = None) -> Expr:
        """Contracted terms as `dynamic` writes them."""
        return self.sympy(self._dynamic_plan(terms, grouping or self.style.inertia))

    def parameter(self, p: Polynomial) -> Expr:
        """A base parameter: by body or by geometry, ``I1 + m1*l1**2 + (m2 + m3)*a1**2``, whichever is shorter."""
        groupings = [self.style.inertia, *([Grouping.GEOMETRY] if self.style.inertia is Grouping.USUAL else [])]
        return self.sympy(planning.cheapest(self._dynamic_plan(self.terms(p), grouping) for grouping in groupings))

    def gravity(self, p: Polynomial) -> Expr:
        """A torque of gravity."""
        return self._with_gravity(p, self.style.gravity, usual=Grouping.FUNCTION)

    def potential(self, p: Polynomial) -> Expr:
        """The potential energy."""
        return self._with_gravity(p, self.style.potential, usual=Grouping.BODY)

    def _with_gravity(self, p: Polynomial, grouping: Grouping, usual: Grouping) -> Expr:
        grouping = usual if grouping is Grouping.USUAL else grouping
        outside = self._gravity if self.style.g is GravityPlace.OUTSIDE else frozenset[int]()
        return self.sympy(factored(self.terms(p), lambda rest: self._dynamic_plan(rest, grouping), outside))

    def _dynamic_plan(self, terms: Terms, grouping: Grouping) -> Plan:
        """A sum in masses and inertias, grouped by body, by geometry, by function of q, or expanded."""
        if grouping is Grouping.BODY:
            return self._by_body(terms)
        by_geometry = grouping is Grouping.GEOMETRY or (grouping is Grouping.USUAL and self._point_masses)
        if self.style.factors is CommonFactors.ALL and by_geometry:
            return factored(terms, lambda rest: self._not_by_body(rest, grouping))
        return self._not_by_body(terms, grouping)

    def _not_by_body(self, terms: Terms, grouping: Grouping) -> Plan:
        """Bodies whose coefficient is a product of sums, ``m3*(a2*c2 + l3*c23)**2``, behind the others' terms."""
        products, rest = list[Plan](), terms
        if self.style.products is not options.Products.EXPANDED:
            rest = Terms()
            for body, part in planning.partition(terms, self.inertial).items():
                whole = _whole(body, part)
                # the squared velocity of a point mass, m (a2 c2 + l3 c23)^2 qd1^2, stays a product
                plan = self._geometry_inside(part) if body else None
                # of two sums or more, a square too, or with sines in front
                if isinstance(plan, planning.Times) and (
                    sum(power for _, power in plan.inner) > 1 or project(plan.monomial, self._sines)
                ):
                    products.append(self._by_body(whole))
                else:
                    rest.update(whole)
        return joined([*([self._grouped_plan(rest, grouping)] if rest else []), *products])

    def _by_body(self, terms: Terms) -> Plan:
        """``m1*l1**2 + m2*(a1**2 + l2**2 + 2*a1*l2*c2)``: geometry collected for each mass and moment of inertia."""
        if self.style.brackets is options.Brackets.LONG and not any(project(m, self._gravity) for m in terms):
            # coefficients of one or two terms stay multiplied out, longer ones get a bracket behind their mass
            bodies = planning.partition(terms, self.inertial)
            short = [flat(_whole(body, part)) for body, part in bodies.items() if len(part) < 3]
            long = [_whole(body, part) for body, part in bodies.items() if len(part) > 2]
            return joined([*short, *(grouped(part, self.inertial, self._geometry_inside) for part in long)])
        return grouped(terms, self.inertial, self._geometry_inside)

    def _usual(self, terms: Terms) -> Plan:
        """By geometry of point masses; by body, but ``(Iy2 - Iz2 - m2*r1**2)*c2*s2`` in one bracket."""
        if self._point_masses:
            return self._by_geometry(terms)
        plans, others = list[Plan](), dict(terms)
        for function, part in planning.partition(terms, self._sines).items():
            # moments of inertia of both signs beside one function of q: the difference of two principal moments
            signs = {coefficient > 0 for m, coefficient in part.items() if project(m, self._moments)}
            if function and len(signs) == 2:
                plans.append(grouped(_whole(function, part), self._sines, flat))
                others = {m: c for m, c in others.items() if project(m, self._sines) != function}
        return joined([*([self._by_body(others)] if others else []), *plans])

    def _grouped_plan(self, terms: Terms, grouping: Grouping) -> Plan:
        """`_dynamic_plan` of what is no product."""
        inside: planning.Writer = flat
        match grouping:
            case Grouping.EXPANDED:
                return flat(terms)
            case Grouping.GEOMETRY:
                return self._by_geometry(terms)
            case Grouping.USUAL:
                return self._usual(terms)
            case Grouping.FUNCTION_BODY:
                inside = self._by_body
            case Grouping.FUNCTION_GEOMETRY:
                inside = self._by_geometry
        # by function of q, and by gravity with it unless it stays inside the terms
        in_terms = self.style.g is GravityPlace.TERM
        level, among = (self._sines, self._not_gravity) if in_terms else (self._sines | self._gravity, None)
        return grouped(terms, level, lambda part: factored(part, inside, among))

    def _by_geometry(self, terms: Terms) -> Plan:
        """``(m1 + m2)*a1**2``: masses and inertias collected for each monomial in everything else."""
        return grouped(terms, self._not_inertial, flat)

    def _geometry_inside(self, terms: Terms) -> Plan:
        """The coefficient of a mass: a product of sums where it is one, else its terms, gravity in front."""
        kept = self.style.products is options.Products.KEPT and len(terms) <= MAX_CANDIDATE_TERMS
        if kept and (product := planning.product_form(terms)) is not None:
            return planning.cheapest([product, flat(terms)])
        gravity = frozenset[int]() if self.style.g is GravityPlace.TERM else self._gravity
        others = {CommonFactors.FUNCTIONS: self._sines, CommonFactors.ALL: self._not_gravity}
        return factored(terms, flat, gravity | others.get(self.style.factors, frozenset()))

    def sympy(self, plan: Plan) -> Expr:
        """The plan as a SymPy expression."""
        match planning.with_plain_numbers(plan) if self._in_decimals else plan:
            case planning.Term(coefficient, monomial):
                return self._products.term(coefficient, monomial)
            case planning.Times(coefficient, monomial, inner):
                sums = [self.sympy(part) ** exponent for part, exponent in inner]
                return sympy.Mul(self._products.term(coefficient, monomial), *sums)
            case planning.Plus(parts):
                return sympy.Add(*(self.sympy(part) for part in parts))

    def monomial(self, factors: Monomial) -> Expr:
        """A product of powers as a SymPy expression."""
        return self._products.term(Fraction(1), factors)


def _whole(factor: Monomial, terms: Terms) -> Terms:
    """A sum multiplied by a monomial."""
    return {planning.multiply(factor, m): c for m, c in terms.items()}

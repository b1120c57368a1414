"""Dynamics as it is printed: entries of B and the Christoffel symbols in the user's symbols.

A short entry is expanded in the user's symbols, contracted, and grouped by masses and moments of inertia. A long one
(a 6R arm with every parameter symbolic) stays grouped by the lumped parameters of its bodies, each written out in the
user's symbols. Equal Christoffel symbols of an entry of C are collected: ``h*(qd1 + qd2)``; names for them, ``h``, are
given in `derive.model.model`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from math import lcm

import sympy

from derive.algebra.ring import Polynomial
from derive.lecture.form import LectureForm
from derive.lecture.plan import Monomial, Plan, Term, divide, flat, joined, project
from derive.lecture.sympy_conversion import Expr
from derive.mechanics.exact import Dynamics
from derive.mechanics.regressor import coulomb_column
from derive.robot import tree
from derive.robot.description import Link
from derive.robot.expression import Expression
from derive.robot.inertial_parameters import coulomb_parts
from derive.robot.options.style import Grouping, Rates
from derive.robot.robot import Robot

MAX_DYNAMIC_TERMS = 400_000  # budget of one entry of B; beyond it only the generated functions remain


# Which entries are expanded in the user's symbols, by their number of terms: in any case, or where the whole matrix or
# table stays within the last number.
EXPANDED_ENTRY, LONG_ENTRY, WHOLE_QUANTITY = 40, 400, 1500

Combination = dict[Expr, Fraction]  # rates or products of rates, and their rational factors


@dataclass(frozen=True, slots=True)
class RateWriting:
    """How a sum of coefficients times rates is written."""

    rates: Rates  # how the rates are collected
    grouping: Grouping  # what is grouped first in a coefficient
    limit: int  # coefficients with at most so many terms are expanded in the user's symbols


class DynamicForm:
    """Writes the polynomials of `Dynamics`."""

    def __init__(self, dynamics: Dynamics, form: LectureForm) -> None:
        self.dynamics, self.form = dynamics, form
        self._grouped = cache(self._by_lumps)

    @cached_property
    def inertia_limit(self) -> int:
        """Longest entry of B that is written in the user's symbols."""
        b = self.dynamics.inertia_matrix
        return self.limit(b[i][j] for i in range(len(b)) for j in range(i, len(b)))

    def inertia(self, i: int, j: int) -> Expr:
        """B_ij, from 0."""
        return self.entry(self.dynamics.inertia_matrix[i][j], self.inertia_limit)

    def of_part(self, i: int, of_rotor: bool) -> DynamicForm:
        """The same for the part of B of link i without any rotor, or of the rotor of joint i without its armature."""
        domain = self.form.domain
        return DynamicForm(Dynamics(only_body(domain.robot, i, of_rotor), domain, MAX_DYNAMIC_TERMS), self.form)

    def limit(self, entries: Iterable[Polynomial]) -> int:
        """The longest entry that is expanded when a whole quantity is to be written."""
        total = sum(self.dynamics.expanded_size(p) for p in entries)
        return LONG_ENTRY if total <= WHOLE_QUANTITY else EXPANDED_ENTRY

    def entry(self, p: Polynomial, limit: int, grouping: Grouping | None = None) -> Expr:
        """One entry as a SymPy expression."""
        if not p:
            return sympy.S.Zero
        is_short = self.dynamics.expanded_size(p) <= limit
        return self.form.dynamic(self.dynamics.expand(p), grouping) if is_short else self._grouped(p)

    def _by_lumps(self, p: Polynomial) -> Expr:
        """Sum of lumped parameter times trigonometric polynomial, equal ones of the latter written once."""
        parts, rest = self.dynamics.split(p)
        terms = []
        for lump, coefficient in parts:
            scale = coefficient.normalised()[0]
            value = self._lumped(coefficient * (1 / scale))
            if scale != 1:
                value = sympy.Mul(sympy.Rational(scale), value, evaluate=not value.is_Add)
            terms.append(sympy.Mul(self.form.dynamic(lump.value), value))
        if rest:
            terms.append(self.form.dynamic(self.dynamics.domain.ring.project(rest)))
        return sympy.Add(*terms)

    @cached_property
    def _lumped(self) -> Callable[[Polynomial], Expr]:
        """Writes polynomials in lumped parameters."""
        form = LectureForm(self.dynamics.lumped, style=self.form.style)
        return cache(lambda p: form.sympy(flat(form.table.terms(p))))

    def rate_sum(self, pairs: Sequence[tuple[Polynomial, Expr]], writing: RateWriting) -> Expr:
        """sum p * rate, collected as the style says: ``h*(qd1 + qd2)``, or ``h*qd1 + h*qd2``."""
        known = [(p, rate) for p, rate in pairs if p]
        if all(self.dynamics.expanded_size(p) <= writing.limit for p, _ in known):
            if writing.rates is Rates.TERM:
                return self._by_term(known)
            if writing.rates is Rates.GEOMETRY:
                return self._by_geometry(known)
        # Coefficients that are equal or opposite share a bracket of rates.
        groups: dict[object, tuple[Polynomial, list[Expr]]] = {}
        for number, (p, rate) in enumerate(known):
            if not self._collects(p, writing.rates):
                groups[number] = (p, [rate])
            elif (-p).key() in groups:
                groups[(-p).key()][1].append(-rate)
            else:
                groups.setdefault(p.key(), (p, []))[1].append(rate)
        written = []
        for p, rates in groups.values():
            value, rate = self.entry(p, writing.limit, writing.grouping), sympy.Add(*rates)
            factored = sympy.factor_terms(rate) if writing.rates is Rates.FACTORED else rate
            written.append(times_rate(value, factored, writing.rates))
        return sympy.Add(*written)

    def _collects(self, p: Polynomial, rates: Rates) -> bool:
        """Whether the rates of a coefficient stand in one bracket."""
        if rates is Rates.USUAL:
            size = self.dynamics.expanded_size(p)
            return size == 1 or (size <= EXPANDED_ENTRY and len(self.form.terms(self.dynamics.expand(p))) == 1)
        return rates in (Rates.SYMBOL, Rates.FACTORED)

    def _by_term(self, pairs: Sequence[tuple[Polynomial, Expr]]) -> Expr:
        """Every product of lengths once: ``m2*l2**2*(qdd1 + qdd2) + (m1 + m2)*l1**2*qdd1``."""
        form, parts = self.form, []
        # Of each product the bodies with the same combination of rates, up to a number, are added first.
        by_geometry: dict[Monomial, dict[tuple[tuple[Expr, Fraction], ...], list[Plan]]] = {}
        for (body, geometry), rates in self._combinations(pairs).items():
            scale = next(iter(rates.values()))
            # Combinations of rates in whole numbers: 2 qd1 + qd2, with the fraction at the mass.
            whole = lcm(*((value / scale).denominator for value in rates.values()))
            combination = tuple((rate, value * whole / scale) for rate, value in rates.items())
            by_geometry.setdefault(geometry, {}).setdefault(combination, []).append(Term(scale / whole, body))
        for geometry, alike in by_geometry.items():
            for combination, masses in alike.items():
                rate = sympy.Add(*(int(value) * rate for rate, value in combination))
                parts.append(sympy.Mul(form.sympy(joined(masses)), form.monomial(geometry), rate))
        return sympy.Add(*parts)

    def _by_geometry(self, pairs: Sequence[tuple[Polynomial, Expr]]) -> Expr:
        """Every product of lengths once, rates in its bracket: ``a1*l2*c2*((m2 + 2*m3)*qdd1 + (m2/2 + m3)*qdd2)``."""
        by_geometry: dict[Monomial, dict[Expr, list[Plan]]] = {}
        for (body, geometry), rates in self._combinations(pairs).items():
            for rate, value in rates.items():
                by_geometry.setdefault(geometry, {}).setdefault(rate, []).append(Term(value, body))
        write, parts = self.form.sympy, []
        for geometry, inside in by_geometry.items():
            bracket = sympy.Add(*(sympy.Mul(write(joined(masses)), rate) for rate, masses in inside.items()))
            parts.append(sympy.Mul(self.form.monomial(geometry), bracket))
        return sympy.Add(*parts)

    def energy(self, pairs: Sequence[tuple[Polynomial, Expr]]) -> Expr:
        """A sum over rates by bodies: ``m1*l1**2*qd1**2/2 + m2*(a1**2*qd1**2 + l2**2*(qd1 + qd2)**2 + ...)/2``."""
        bodies: dict[Monomial, list[Expr]] = {}
        factored: dict[tuple[tuple[Expr, Fraction], ...], Expr] = {}
        for (body, geometry), rates in self._combinations(pairs).items():
            key = tuple(rates.items())
            if key not in factored:
                # A square of rates where it is one: qd1^2 + 2 qd1 qd2 + qd2^2 = (qd1 + qd2)^2.
                total = sympy.Add(*(sympy.Rational(value) * rate for rate, value in key))
                factored[key] = sympy.factor(total) if len(key) > 1 else total
            bodies.setdefault(body, []).append(self.form.monomial(geometry) * factored[key])
        half = sympy.Rational(1, 2)
        inside = {body: sympy.Add(*(2 * part for part in parts)) for body, parts in bodies.items()}
        return sympy.Add(*(sympy.Mul(half, self.form.monomial(body), value) for body, value in inside.items()))

    def _combinations(self, pairs: Sequence[tuple[Polynomial, Expr]]) -> dict[tuple[Monomial, Monomial], Combination]:
        """What multiplies every product of a mass and of lengths: a combination of rates."""
        found: dict[tuple[Monomial, Monomial], Combination] = {}
        for p, rate in pairs:
            number, product = rate.as_coeff_Mul()
            for monomial, coefficient in self.form.terms(self.dynamics.expand(p)).items():
                # Each monomial is a mass or moment of inertia times lengths, sines and cosines.
                body = project(monomial, self.form.inertial)
                rates = found.setdefault((body, divide(monomial, body)), {})
                rates[product] = rates.get(product, Fraction(0)) + coefficient * Fraction(int(number.p), int(number.q))
        return found


def times_rate(value: Expr, rate: Expr, rates: Rates) -> Expr:
    """value * rate, multiplied out where the style says so."""
    if rates is Rates.EXPANDED and value.is_Add:
        return sympy.Add(*(term * rate for term in value.args))
    return value * rate


def only_body(robot: Robot, i: int, of_rotor: bool) -> Robot:
    """The robot with one body alone, a link or a rotor: every other link massless, no armature."""
    own, bare = tree.bodies(robot)[i - 1], Link()
    body = Link(motor=own.motor) if of_rotor else replace(own, motor=None, armature=bare.armature)
    fixed = (replace(row, link=body if k == i else bare) for k, row in enumerate(robot.fixed, robot.n + 1))
    return replace(robot, links=tuple(body if k == i else bare for k in range(1, robot.n + 1)), fixed=tuple(fixed))


def friction_torque(link: Link, rate: Expr, write: Callable[[Expression], Expr]) -> Expr:
    """Friction of a joint [N m or N], its coefficients each written in some way."""
    dry = (write(cell) * coulomb_column(part, sympy.sign(rate)) for part, cell in coulomb_parts(link).items())
    return sympy.Add(write(link.viscous) * rate, *dry)

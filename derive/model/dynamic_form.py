"""Dynamics as it is printed: entries of B and the Christoffel symbols in the user's symbols.

A short entry is expanded in the user's symbols, contracted, and grouped by masses and moments of inertia. A long one
(a 6R arm with every parameter symbolic) stays grouped by the lumped parameters of its bodies, each written out in the
user's symbols. Equal Christoffel symbols of an entry of C are collected: ``h*(qd1 + qd2)``; names for them, ``h``, are
given in `derive.model.abbreviations`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import sympy

from derive.algebra.ring import Polynomial
from derive.lecture.form import LectureForm
from derive.lecture.plan import flat
from derive.lecture.sympy_conversion import Expr
from derive.model.dynamics import Dynamics
from derive.robot.style import Style


@dataclass(frozen=True, slots=True)
class Budget:
    """Which entries are expanded in the user's symbols, by their number of terms.

    Attributes:
        entry: An entry with at most so many terms is expanded in any case.
        long_entry: So many where the whole quantity stays within ``quantity``.
        quantity: Terms of a whole matrix or table.
    """

    entry: int = 40
    long_entry: int = 400
    quantity: int = 1500


class DynamicForm:
    """Writes the polynomials of `Dynamics`.

    Args:
        dynamics: The closed forms.
        form: The lecture form over the ring of the user's symbols.
        budget: What is expanded.
    """

    def __init__(self, dynamics: Dynamics, form: LectureForm, budget: Budget | None = None) -> None:
        self.dynamics = dynamics
        self.form = form
        self.budget = budget or Budget()
        self._lumped_form = LectureForm(dynamics.lumped, style=form.style)
        self._lumps: dict[int, Expr] = {}
        self._coefficients: dict[object, Expr] = {}
        self._cache: dict[object, Expr] = {}

    # -- entries

    def limit(self, entries: Iterable[Polynomial]) -> int:
        """The longest entry that is expanded when a whole quantity is to be written.

        Args:
            entries: Its entries, in lumped parameters.

        Returns:
            A number of terms.
        """
        total = sum(self.dynamics.expanded_size(p) for p in entries)
        return self.budget.long_entry if total <= self.budget.quantity else self.budget.entry

    def entry(self, p: Polynomial, limit: int) -> Expr:
        """One entry as a SymPy expression.

        Args:
            p: In lumped parameters.
            limit: It is expanded where it has at most so many terms.
        """
        if not p:
            return sympy.S.Zero
        key = (p.key(), self.dynamics.expanded_size(p) <= limit)
        if key not in self._cache:
            self._cache[key] = self.form.dynamic(self.dynamics.expand(p)) if key[1] else self._grouped(p)
        return self._cache[key]

    def _grouped(self, p: Polynomial) -> Expr:
        """Sum of lumped parameter times trigonometric polynomial, equal ones of the latter written once."""
        parts, rest = self.dynamics.split(p)
        terms = []
        for lump, coefficient in parts:
            if lump.generator not in self._lumps:
                self._lumps[lump.generator] = self.form.dynamic(lump.value)
            scale, key = coefficient.normalised()
            if key not in self._coefficients:
                unit = coefficient * (1 / scale)
                self._coefficients[key] = self._lumped_form.sympy(flat(self._lumped_form.table.terms(unit)))
            value = self._coefficients[key]
            if scale != 1:
                factor = sympy.Rational(scale.numerator, scale.denominator)
                value = sympy.Mul(factor, value, evaluate=not value.is_Add)
            terms.append(sympy.Mul(self._lumps[lump.generator], value))
        if rest:
            terms.append(self.form.dynamic(self.dynamics.domain.ring.project(rest)))
        return sympy.Add(*terms)

    # -- sums over rates

    def rate_sum(self, pairs: Sequence[tuple[Polynomial, Expr]], limit: int) -> Expr:
        """sum p * rate, with equal coefficients collected: ``h*(qd1 + qd2)``; multiplied out in the expanded style.

        Args:
            pairs: Coefficients in lumped parameters, and rates or products of rates.
            limit: Coefficients with at most so many terms are expanded.
        """
        if self.form.style is Style.EXPANDED:
            return sympy.Add(*(self.product(p, rate, limit) for p, rate in pairs))
        groups: dict[object, tuple[Polynomial, list[Expr]]] = {}
        for p, rate in pairs:
            if not p:
                continue
            key, opposite = p.key(), (-p).key()
            if opposite in groups:
                groups[opposite][1].append(-rate)
            else:
                groups.setdefault(key, (p, []))[1].append(rate)
        terms = [sympy.Mul(self.entry(p, limit), sympy.Add(*rates)) for p, rates in groups.values()]
        return sympy.Add(*terms)

    def product(self, p: Polynomial, rate: Expr, limit: int) -> Expr:
        """p * rate, multiplied out in the expanded style.

        Args:
            p: In lumped parameters.
            rate: A rate or product of rates.
            limit: p is expanded where it has at most so many terms.
        """
        return times_rate(self.entry(p, limit), rate, self.form.style)


def times_rate(value: Expr, rate: Expr, style: Style) -> Expr:
    """value * rate, multiplied out in the expanded style.

    Args:
        value: What is multiplied.
        rate: A velocity, an acceleration or a product of them.
        style: How expressions are grouped.
    """
    if style is Style.EXPANDED and value.is_Add:
        return sympy.Add(*(term * rate for term in value.args))
    return value * rate

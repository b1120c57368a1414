"""Dynamics with short names for what repeats: h for the Christoffel symbols, a_1, a_2, ... for the constants.

Two ways in which notes print long dynamics. Christoffel names: ``C = [h*qd2, h*(qd1 + qd2); -h*qd1, 0]`` with
``h = -m2*a1*l2*s2``. Dynamic coefficients: ``B_11 = a_1 + 2*a_2*c_2``, one name for each linear combination of
constants. Two values that differ by a rational factor share one name.
"""

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import gcd, lcm

import sympy

from derive.algebra.generators import MOVING
from derive.algebra.ring import Polynomial
from derive.errors import QuantityError, listed
from derive.lecture.plan import Terms, partition
from derive.lecture.sympy_conversion import Expr, Matrix
from derive.model.dynamic_model import DynamicModel
from derive.robot.names import robot_symbols

BY_RATES = ("C", "N", "Bdot", "tau")
BY_CONSTANTS = ("B", "g")

# Exact coefficients, and the rates or products of rates that they are multiplied by.
Pairs = list[tuple[Polynomial, Expr]]


def abbreviate(model: DynamicModel, quantity: str, by: str | None) -> tuple[Matrix, Mapping[Expr, Expr]]:
    """A dynamic quantity with short names, and what the names mean."""
    way = by or ("christoffel" if quantity in BY_RATES else "coefficients")
    allowed = {"christoffel": BY_RATES, "coefficients": (*BY_CONSTANTS, *BY_RATES)}
    if way not in allowed:
        raise QuantityError(f"unknown kind of abbreviations {way!r}", allowed="allowed: christoffel or coefficients")
    if quantity not in allowed[way]:
        found = f"abbreviations by {way} do not apply to {quantity!r}"
        raise QuantityError(found, allowed=f"they apply to {listed(allowed[way])}")
    writer = _ByChristoffel(model) if way == "christoffel" else _ByCoefficients(model)
    n, rows = range(model.n), []
    coefficient = None if quantity in ("B", "g", "tau") else model.rate_coefficient(quantity)
    for i in n:
        row = []
        if coefficient is not None:
            row = [writer.rate_sum([(coefficient(i, j, k), model.qd[k]) for k in n]) for j in n]
        elif quantity != "g":
            row = [writer.constant_part(model.dynamics.inertia_matrix[i][j], model.B[i, j]) for j in n]
        if quantity == "tau":
            accelerated = [entry * qdd for entry, qdd in zip(row, model.qdd, strict=True)]
            row = [*accelerated, writer.rate_sum(model.velocity_pairs(i)), model.friction[i]]
        if quantity in ("g", "tau"):
            row = [sympy.Add(*row, writer.constant_part(model.kinematics.gravity_vector[i], model.g[i]))]
        rows.append(row)
    matrix, definitions, letter = sympy.ImmutableMatrix(rows), writer.names.definitions, writer.names.letter
    if len(definitions) != 1:
        return matrix, definitions
    ((symbol, value),) = definitions.items()
    return matrix.xreplace({symbol: sympy.Symbol(letter)}), {sympy.Symbol(letter): value}


class _Names:
    """Gives names to values, the same one to values that differ by a rational factor."""

    def __init__(self, letters: Sequence[str], model: DynamicModel) -> None:
        # h is taken by a symbol h, and by h1
        stems = {name.rstrip("0123456789") for name in robot_symbols(model.robot)}
        self.letter = next((letter for letter in letters if letter not in stems), "abbreviation_")
        self.definitions: dict[Expr, Expr] = {}  # what the names mean
        self._known: dict[object, Expr] = {}

    def name(self, key: object, value: Callable[[], Expr]) -> Expr:
        if key not in self._known:
            self._known[key] = sympy.Symbol(f"{self.letter}{len(self._known) + 1}")
            self.definitions[self._known[key]] = value()
        return self._known[key]


class _ByChristoffel:
    """Writes sums over rates with names for coefficients, or the Christoffel symbols where these occur."""

    def __init__(self, model: DynamicModel) -> None:
        self.names = _Names(("h", "k", "b", "w", "u"), model)
        self._form, self._limit = model.dynamic_form, model.christoffel_limit
        self._grouping = model.style.christoffel
        self._bases: dict[str, Polynomial] = {}
        n = range(model.n)
        for i, j, k in ((i, j, k) for i in n for j in n for k in n if j <= k):
            p = model.dynamics.christoffel(i, j, k)
            if p:
                self._bases.setdefault(p.normalised()[1], p)

    def constant_part(self, p: Polynomial, written: Expr) -> Expr:
        """An entry of B or g as the model writes it."""
        return written

    def rate_sum(self, pairs: Pairs) -> Expr:
        """Sum of p * rate, each p a multiple of a name, equal names collected: ``h*(qd1 + qd2)``."""
        collected: dict[Expr, list[Expr]] = {}
        for p, rate in pairs:
            if p:
                factor, name = self._named(p)
                collected.setdefault(name, []).append(factor * rate)
        terms = []
        for name, rates in collected.items():
            alike = len({abs(rate.as_coeff_Mul()[0]) for rate in rates}) == 1
            terms.append(sympy.Mul(name, sympy.Add(*rates)) if alike else sympy.Add(*(name * rate for rate in rates)))
        return sympy.Add(*terms)

    def _named(self, p: Polynomial) -> tuple[Expr, Expr]:
        """A rational factor and the name that it multiplies."""
        scale, key = p.normalised()
        base = self._bases.setdefault(key, p)
        name = self.names.name(key, lambda: self._form.entry(base, self._limit, self._grouping))
        return sympy.Rational(scale / base.normalised()[0]), name


class _ByCoefficients:
    """Writes polynomials as sums of named constants times what moves."""

    def __init__(self, model: DynamicModel) -> None:
        self.names = _Names(("a", "p", "k", "w", "u"), model)
        self._model, self._form = model, model.form
        self._bases: dict[object, Fraction] = {}
        self._moving = frozenset(i for i, f in enumerate(model.form.table.factors) if f.kind in MOVING)

    def constant_part(self, p: Polynomial, written: Expr) -> Expr:
        """An entry of B or g with a name for the coefficient of every monomial in sines, cosines and variables."""
        dynamics = self._model.dynamics
        expanded = dynamics.expand(p) if p.ring is dynamics.lumped.ring else p
        parts = partition(self._form.table.terms(expanded), self._moving)
        return sympy.Add(*(self._named(rest) * self._form.monomial(outer) for outer, rest in parts.items()))

    def rate_sum(self, pairs: Pairs) -> Expr:
        """sum p * rate, every p with names for its constants."""
        return sympy.Add(*(self.constant_part(p, None) * rate for p, rate in pairs if p))

    def _named(self, terms: Terms) -> Expr:
        lead = terms[min(terms)]
        if list(terms) == [()]:
            return sympy.Rational(lead)
        # the greatest rational of which all are whole multiples
        numerators, denominators = zip(*((c.numerator, c.denominator) for c in terms.values()), strict=True)
        scale = abs(lead) if len(terms) == 1 else Fraction(gcd(*numerators), lcm(*denominators))
        scale = -scale if lead < 0 else scale
        key = tuple(sorted((m, c / scale) for m, c in terms.items()))
        # decimals stay in the value: a name is the value itself, not what a tiny number multiplies
        base = self._bases.setdefault(key, scale if scale.denominator > 1 else Fraction(1))
        name = self.names.name(key, lambda: self._form.write_dynamic({m: c * base for m, c in key}))
        return sympy.Rational(scale / base) * name

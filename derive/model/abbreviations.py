"""Dynamics with short names for what repeats: h for the Christoffel symbols, a_1, a_2, ... for the constants.

Two ways in which notes print long dynamics. Christoffel names: ``C = [h*qd2, h*(qd1 + qd2); -h*qd1, 0]`` with
``h = -m2*a1*l2*s2``. Dynamic coefficients: ``B_11 = a_1 + 2*a_2*c_2``, one name for each linear combination of
constants. Two values that differ by a rational factor share one name.

Which quantity is written with which names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from math import gcd, lcm
from typing import Any

import sympy

from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.errors import QuantityError
from derive.lecture.form import LectureForm
from derive.lecture.terms import Terms, partition
from derive.model.dynamic_form import DynamicForm
from derive.model.dynamic_model import DynamicModel
from derive.robot.names import robot_symbols

Expr = Any
Matrix = Any


class Names:
    """Gives names to values, the same one to values that differ by a rational factor.

    Args:
        letters: Letters to try; the first that collides with no symbol of the robot is taken.
        taken: Symbols of the robot.
    """

    def __init__(self, letters: Sequence[str], taken: Iterable[str]) -> None:
        symbols = set(taken)
        self.letter = next((x for x in letters if not any(_collides(x, s) for s in symbols)), "abbreviation_")
        self._known: dict[object, int] = {}
        self._values: list[Expr] = []

    def name(self, key: object, value: Callable[[], Expr]) -> Expr:
        """The symbol of a value, which is written only when it is new."""
        if key not in self._known:
            self._known[key] = len(self._values)
            self._values.append(value())
        return self._symbol(self._known[key] + 1)

    def _symbol(self, number: int) -> Expr:
        return sympy.Symbol(f"{self.letter}{number}")

    def definitions(self) -> dict[Expr, Expr]:
        """Symbol to value, in the order of the names."""
        return {self._symbol(i): value for i, value in enumerate(self._values, start=1)}


def _collides(letter: str, symbol: str) -> bool:
    rest = symbol.removeprefix(letter)
    return symbol.startswith(letter) and (not rest or rest.isdigit())


class ChristoffelNames:
    """Writes sums over rates with names for their coefficients.

    Args:
        form: How the coefficients are written.
        names: Where the names come from.
        limit: Longest coefficient that is expanded, see `DynamicForm`.
    """

    def __init__(self, form: DynamicForm, names: Names, limit: int) -> None:
        self._form = form
        self._names = names
        self._limit = limit
        self._bases: dict[str, Polynomial] = {}

    def offer(self, p: Polynomial) -> None:
        """Let multiples of p be written as multiples of a name for p itself, if they occur."""
        if p:
            self._bases.setdefault(p.normalised()[1], p)

    def rate_sum(self, pairs: Iterable[tuple[Polynomial, Expr]]) -> Expr:
        """sum p * rate, each p a multiple of a name, equal names collected."""
        collected: dict[Expr, list[Expr]] = {}
        for p, rate in pairs:
            if p:
                factor, name = self._named(p)
                collected.setdefault(name, []).append(factor * rate)
        return sympy.Add(*(_product(name, rates) for name, rates in collected.items()))

    def _named(self, p: Polynomial) -> tuple[Expr, Expr]:
        scale, key = p.normalised()
        base = self._bases.setdefault(key, p)
        name = self._names.name(key, lambda: self._form.entry(base, self._limit))
        ratio = scale / base.normalised()[0]
        return sympy.Rational(ratio.numerator, ratio.denominator), name


def _product(name: Expr, rates: list[Expr]) -> Expr:
    """``h*(qd1 + qd2)``, but ``2*h*qd1 + h*qd2``."""
    if len({abs(rate.as_coeff_Mul()[0]) for rate in rates}) == 1:
        return sympy.Mul(name, sympy.Add(*rates))
    return sympy.Add(*(name * rate for rate in rates))


class CoefficientNames:
    """Writes polynomials as sums of named constants times what moves.

    Args:
        form: How the constants are written.
        names: Where the names come from.
    """

    def __init__(self, form: LectureForm, names: Names) -> None:
        self._form = form
        self._names = names
        kinds = (Kind.SINE, Kind.COSINE, Kind.VARIABLE)
        self._bases: dict[object, Fraction] = {}
        self._moving = frozenset(i for i, f in enumerate(form.table.factors) if f.kind in kinds)

    def write(self, p: Polynomial) -> Expr:
        """The polynomial with a name for the coefficient of every monomial in sines, cosines and variables."""
        parts = partition(self._form.terms(p), self._moving)
        return sympy.Add(*(self._named(rest) * self._form.monomial(outer) for outer, rest in parts.items()))

    def _named(self, terms: Terms) -> Expr:
        lead = terms[min(terms)]
        if list(terms) == [()]:
            return sympy.Rational(lead.numerator, lead.denominator)
        scale = abs(lead) if len(terms) == 1 else _content(terms.values())
        scale = -scale if lead < 0 else scale
        key = tuple(sorted((m, c / scale) for m, c in terms.items()))
        # decimals stay in the value: a name is the value itself, not what a tiny number multiplies
        base = self._bases.setdefault(key, scale if scale.denominator > 1 else Fraction(1))
        name = self._names.name(key, lambda: self._form.write_dynamic({m: c * base for m, c in key}))
        ratio = scale / base
        return sympy.Rational(ratio.numerator, ratio.denominator) * name


def _content(numbers: Iterable[Fraction]) -> Fraction:
    """The greatest rational of which all are whole multiples."""
    values = list(numbers)
    return Fraction(gcd(*(v.numerator for v in values)), lcm(*(v.denominator for v in values)))


RateSum = Callable[[list[tuple[Polynomial, Expr]]], Expr]

BY_RATES = ("C", "N", "Bdot", "tau")
BY_CONSTANTS = ("B", "g")


def abbreviate(model: DynamicModel, quantity: str, by: str | None) -> tuple[Matrix, Mapping[Expr, Expr]]:
    """See `derive.model.model.DynamicModel.abbreviated`."""
    way = by or ("christoffel" if quantity in BY_RATES else "coefficients")
    allowed = {"christoffel": BY_RATES, "coefficients": (*BY_CONSTANTS, *BY_RATES)}
    if way not in allowed:
        raise QuantityError(f"abbreviations by {way!r}", allowed="christoffel or coefficients")
    if quantity not in allowed[way]:
        raise QuantityError(f"abbreviations of {quantity!r} by {way}", allowed=", ".join(allowed[way]))
    writer = _Christoffel(model) if way == "christoffel" else _Coefficients(model)
    return _without_number(writer.matrix(quantity), writer.names.definitions(), writer.names.letter)


def _without_number(
    matrix: Matrix, definitions: Mapping[Expr, Expr], letter: str
) -> tuple[Matrix, Mapping[Expr, Expr]]:
    """A single name needs no number: h, not h1."""
    if len(definitions) != 1:
        return matrix, definitions
    ((symbol, value),) = definitions.items()
    return matrix.xreplace({symbol: sympy.Symbol(letter)}), {sympy.Symbol(letter): value}


class _Writer:
    """A quantity entry by entry; how rate sums and constants are written is up to the kind."""

    names: Names

    def __init__(self, model: DynamicModel) -> None:
        self.model = model

    def rate_sum(self, pairs: list[tuple[Polynomial, Expr]]) -> Expr:
        raise NotImplementedError

    def constant_part(self, p: Polynomial, written: Expr) -> Expr:
        """An entry of B or g: by default as the model writes it."""
        return written

    def matrix(self, quantity: str) -> Matrix:
        n = range(self.model.n)
        match quantity:
            case "B":
                return sympy.ImmutableMatrix([[self._inertia(i, j) for j in n] for i in n])
            case "g":
                return sympy.ImmutableMatrix([self._gravity(i) for i in n])
            case "tau":
                return sympy.ImmutableMatrix([self._torque(i) for i in n])
            case _:
                return sympy.ImmutableMatrix([[self._rates(quantity, i, j) for j in n] for i in n])

    def _inertia(self, i: int, j: int) -> Expr:
        return self.constant_part(self.model.dynamics.inertia_matrix[i][j], self.model.B[i, j])

    def _gravity(self, i: int) -> Expr:
        return self.constant_part(self.model.kinematics.gravity_vector[i], self.model.g[i])

    def _rates(self, quantity: str, i: int, j: int) -> Expr:
        d = self.model.dynamics
        coefficient = {"C": d.christoffel, "N": d.skew, "Bdot": d.derivative}[quantity]
        return self.rate_sum([(coefficient(i, j, k), rate) for k, rate in enumerate(self.model.qd)])

    def _torque(self, i: int) -> Expr:
        qd, n = self.model.qd, self.model.n
        pairs = [
            (self.model.dynamics.christoffel(i, j, k), (1 if j == k else 2) * qd[j] * qd[k])
            for j in range(n)
            for k in range(j, n)
        ]
        accelerated = [self._inertia(i, j) * self.model.qdd[j] for j in range(n)]
        return sympy.Add(*accelerated, self.rate_sum(pairs), self._gravity(i), self.model.friction[i])


class _Christoffel(_Writer):
    def __init__(self, model: DynamicModel) -> None:
        super().__init__(model)
        self.names = Names(("h", "k", "b", "w", "u"), robot_symbols(model.robot))
        self._form = ChristoffelNames(model.dynamic_form, self.names, model.christoffel_limit)
        n = range(model.n)
        for i, j, k in ((i, j, k) for i in n for j in n for k in n if j <= k):
            self._form.offer(model.dynamics.christoffel(i, j, k))

    def rate_sum(self, pairs: list[tuple[Polynomial, Expr]]) -> Expr:
        return self._form.rate_sum(pairs)


class _Coefficients(_Writer):
    def __init__(self, model: DynamicModel) -> None:
        super().__init__(model)
        self.names = Names(("a", "p", "k", "w", "u"), robot_symbols(model.robot))
        self._form = CoefficientNames(model.form, self.names)

    def constant_part(self, p: Polynomial, written: Expr) -> Expr:
        return self._form.write(self._expanded(p))

    def rate_sum(self, pairs: list[tuple[Polynomial, Expr]]) -> Expr:
        return sympy.Add(*(self._form.write(self._expanded(p)) * rate for p, rate in pairs if p))

    def _expanded(self, p: Polynomial) -> Polynomial:
        dynamics = self.model.dynamics
        return dynamics.expand(p) if p.ring is dynamics.lumped.ring else p

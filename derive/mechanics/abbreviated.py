"""Which quantity is written with which names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import sympy

from derive.algebra.ring import Polynomial
from derive.errors import QuantityError
from derive.mechanics.abbreviations import ChristoffelNames, CoefficientNames, Names
from derive.robot.names import robot_symbols

if TYPE_CHECKING:
    from derive.mechanics.model import Model

Expr = Any
Matrix = Any
RateSum = Callable[[list[tuple[Polynomial, Expr]]], Expr]

BY_RATES = ("C", "N", "Bdot", "tau")
BY_CONSTANTS = ("B", "g")


def abbreviate(model: Model, quantity: str, by: str | None) -> tuple[Matrix, Mapping[Expr, Expr]]:
    """See `derive.mechanics.model.Model.abbreviated`."""
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

    def __init__(self, model: Model) -> None:
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
    def __init__(self, model: Model) -> None:
        super().__init__(model)
        self.names = Names(("h", "k", "b", "w", "u"), robot_symbols(model.robot))
        self._form = ChristoffelNames(model.dynamic_form, self.names, model.christoffel_limit)
        n = range(model.n)
        for i, j, k in ((i, j, k) for i in n for j in n for k in n if j <= k):
            self._form.offer(model.dynamics.christoffel(i, j, k))

    def rate_sum(self, pairs: list[tuple[Polynomial, Expr]]) -> Expr:
        return self._form.rate_sum(pairs)


class _Coefficients(_Writer):
    def __init__(self, model: Model) -> None:
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

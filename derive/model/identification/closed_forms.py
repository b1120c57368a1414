"""Regressors and base parameters in closed form, in the robot's own symbols.

The column of a parameter is B qdd + C qd + g of the arm on which that parameter is 1 and all others are 0; friction
columns are qd_i and sign(qd_i).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property

import sympy

from derive.algebra.ring import Polynomial
from derive.lecture.form import LectureForm
from derive.lecture.to_sympy import Expr, Matrix
from derive.mechanics.chain import build_chain
from derive.mechanics.regressor import with_unit_rotors
from derive.model.dynamic_form import times_rate
from derive.model.identification.base_parameters import BaseSet, base_set
from derive.model.identification.parameter_values import grouped_values, standard_values
from derive.model.identification.unit_dynamics import UnitDynamics
from derive.model.kinematic_model import KinematicModel
from derive.robot.inertial_parameters import Parameter, standard_parameters

_HALF = Fraction(1, 2)


class ClosedIdentification:
    """Standard and base parameters of a robot, and the regressors that they are multiplied by.

    Args:
        model: Gives the ring, the symbols and the style.
    """

    def __init__(self, model: KinematicModel) -> None:
        self.model = model
        self._chain = build_chain(with_unit_rotors(model.robot), model.domain)
        self._written: dict[str, Expr] = {}

    @cached_property
    def standard(self) -> tuple[Parameter, ...]:
        """The standard parameters."""
        return standard_parameters(self.model.robot)

    @cached_property
    def base(self) -> BaseSet:
        """The base parameters and the relations behind them."""
        return base_set(self.model.robot)

    @cached_property
    def standard_values(self) -> Matrix:
        """The standard parameters pi, px1."""
        values = standard_values(self.model.robot, self.standard, self.model.domain)
        return sympy.ImmutableMatrix([self.model.form.dynamic(value) for value in values])

    @cached_property
    def base_values(self) -> Matrix:
        """The base parameters beta, bx1."""
        values = grouped_values(self.model.robot, self.base, self.model.domain)
        moved: dict[Parameter, list[Expr]] = {parameter: [] for parameter in self.base.parameters}
        for relation in self.base.relations:
            assert self.base.domain is not None, "relations come with their ring"
            write = LectureForm(self.base.domain).kinematic
            value = values[relation.parameter]
            for parameter, factor in relation.terms:
                if factor.numerator.is_constant:
                    values[parameter] = values[parameter] + factor.numerator.constant_term * value
                else:
                    ratio = write(factor.numerator) / write(factor.denominator)
                    moved[parameter].append(ratio * self.model.form.dynamic(value))
        return sympy.ImmutableMatrix(
            [sympy.Add(self.model.form.dynamic(values[p]), *moved[p]) for p in self.base.parameters]
        )

    @cached_property
    def regressor(self) -> Matrix:
        """The regressor Y of the standard parameters, nxp."""
        return self._matrix(UnitDynamics(self._chain, ends=True), self.standard)

    @cached_property
    def base_regressor(self) -> Matrix:
        """The regressor Y of the base parameters, nxb."""
        return self._matrix(UnitDynamics(self._chain, ends=False), self.base.parameters)

    # -- columns

    def _matrix(self, units: UnitDynamics[Polynomial], parameters: Sequence[Parameter]) -> Matrix:
        columns = [self._column(units, parameter) for parameter in parameters]
        return sympy.ImmutableMatrix(self.model.n, len(columns), lambda i, j: columns[j][i])

    def _column(self, units: UnitDynamics[Polynomial], parameter: Parameter) -> list[Expr]:
        model, n, i = self.model, range(self.model.n), parameter.joint - 1
        if parameter.part in ("b", "f"):
            own = model.qd[i] if parameter.part == "b" else sympy.sign(model.qd[i])
            return [own if k == i else sympy.S.Zero for k in n]
        gravity = [model.form.gravity(p) for p in units.gravity(parameter)]
        gravity += [sympy.S.Zero] * (model.n - len(gravity))
        inertia = {key: p for (a, b), p in units.inertia(parameter).items() for key in ((a, b), (b, a))}
        return [sympy.Add(*self._inertial(inertia, k), gravity[k]) for k in n]

    def _inertial(self, inertia: Mapping[tuple[int, int], Polynomial], i: int) -> Iterator[Expr]:
        """B_ij qdd_j, and c_ijk qd_j qd_k for every pair of joints once; what is missing in B is zero."""
        model, n = self.model, range(self.model.n)

        def _slope(i: int, j: int, k: int) -> Polynomial:
            value = inertia.get((i, j))
            return model.domain.derivative(value, k) if value else model.domain.ring.zero

        for j in n:
            yield times_rate(self._expression(inertia.get((i, j))), model.qdd[j], model.style)
        for j in n:
            for k in range(j, model.n):
                twice = _slope(i, j, k) + _slope(i, k, j) - _slope(j, k, i)
                if twice:
                    rates = model.qd[j] * model.qd[k]
                    value = twice * _HALF if j == k else twice
                    yield times_rate(self._expression(value), rates, model.style)

    def _expression(self, p: Polynomial | None) -> Expr:
        if not p:
            return sympy.S.Zero
        key = p.key()
        if key not in self._written:
            self._written[key] = self.model.form.kinematic(p)
        return self._written[key]

"""Formulations of the functions for identification: regressors, and the numbers of the base parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.algebra.domain import polynomial_expression
from derive.mechanics.chain import build_chain
from derive.mechanics.regressor import Regressor, with_unit_rotors
from derive.model.identification.base_parameters import Coefficient, base_set
from derive.model.identification.parameter_values import ParameterFormulas, base_values
from derive.programs.formulations.choice import Formulation
from derive.programs.formulations.trace import Trace, flat
from derive.programs.program import Column
from derive.programs.tape.scalars import QD, QDD
from derive.programs.tape.value import Value
from derive.robot.inertial_parameters import Parameter, standard_parameters


def regressors(trace: Trace) -> Iterator[Formulation]:
    """Formulations of Y."""
    yield _regressor(trace, standard_parameters(trace.robot), ends=True)


def base_regressors(trace: Trace) -> Iterator[Formulation]:
    """Formulations of Y_b."""
    yield _regressor(trace, base_set(trace.robot).parameters, ends=False)


def base_parameters(trace: Trace) -> Iterator[Formulation]:
    """Formulations of beta."""
    base = base_set(trace.robot)

    def _value(coefficient: Coefficient) -> Value:
        assert base.domain is not None, "relations come with their ring"
        parts = (coefficient.numerator, coefficient.denominator)
        numerator, denominator = (trace.domain.constant(polynomial_expression(p, base.domain)) for p in parts)
        return numerator / denominator

    yield Formulation("grouped from the tip inwards", lambda: base_values(trace.robot, base, trace.domain, _value))


def standard_columns(trace: Trace) -> tuple[Column, ...]:
    """What the columns of Y belong to."""
    parameters = standard_parameters(trace.robot)
    formulas = ParameterFormulas(trace.robot, base_set(trace.robot)).standard(parameters)
    return tuple(Column(p.name, formula) for p, formula in zip(parameters, formulas, strict=True))


def base_columns(trace: Trace) -> tuple[Column, ...]:
    """What the columns of Y_b and the entries of beta belong to."""
    base = base_set(trace.robot)
    formulas = ParameterFormulas(trace.robot, base).base()
    return tuple(Column(p.name, formula) for p, formula in zip(base.parameters, formulas, strict=True))


def _regressor(trace: Trace, parameters: Sequence[Parameter], *, ends: bool) -> Formulation:
    def _values() -> list[Value]:
        chain = build_chain(with_unit_rotors(trace.robot), trace.domain)
        rates, accelerations = trace.arguments(QD), trace.arguments(QDD)
        return flat(Regressor(chain, rates, accelerations, ends=ends, sign=Value.sign).rows(parameters))

    return Formulation("work of unit wrenches on the screws of the joints", _values)

"""Generated functions for identification: regressors, and the numbers of the base parameters."""

from __future__ import annotations

from collections.abc import Sequence

from derive.algebra.domain import polynomial_expression
from derive.mechanics.chain import build_chain
from derive.mechanics.regressor import Regressor
from derive.mechanics.screws import with_unit_rotors
from derive.model.identification.base_parameters import BaseSet, base_set
from derive.model.identification.column_relations import Coefficient
from derive.model.identification.parameter_values import ParameterFormulas, base_values
from derive.programs.program import Column
from derive.programs.tape.scalars import QD, QDD, Q
from derive.programs.tape.value import Value
from derive.programs.trace import Candidate, Specification, Trace, flat
from derive.robot.inertial_parameters import Parameter, has_regressor, standard_parameters


def identification_functions(trace: Trace) -> tuple[Specification, ...]:
    """Regressors and base parameters; none for arms of more joints than `inertial_parameters.MAX_JOINTS`."""
    if not has_regressor(trace.robot):
        return ()
    base, standard = base_set(trace.robot), standard_parameters(trace.robot)
    formulas = ParameterFormulas(trace.robot, base)
    plain, grouped = _columns(standard, formulas.standard(standard)), _columns(base.parameters, formulas.base())
    values = Candidate("grouped from the tip inwards", lambda: _values(trace, base))
    return (
        _regressor(trace, "regressor", standard, plain, ends=True),
        _regressor(trace, "base_regressor", base.parameters, grouped, ends=False),
        Specification("base_parameters", (), (len(base.parameters),), (values,), grouped),
    )


def _columns(parameters: Sequence[Parameter], formulas: Sequence[str]) -> tuple[Column, ...]:
    return tuple(Column(p.name, formula) for p, formula in zip(parameters, formulas, strict=True))


def _regressor(
    trace: Trace, name: str, parameters: Sequence[Parameter], columns: tuple[Column, ...], *, ends: bool
) -> Specification:
    """One of the regressors; its entries share little beyond what the recursion shares, so no search is spent on it."""

    def values() -> list[Value]:
        chain = build_chain(with_unit_rotors(trace.robot), trace.domain)
        rates, gains = trace.arguments(QD), trace.arguments(QDD)
        return flat(Regressor(chain, rates, gains, ends=ends, sign=Value.sign).rows(parameters))

    candidates = (Candidate("work of unit wrenches on the screws of the joints", values),)
    shape = (trace.n, len(parameters))
    return Specification(name, (Q, QD, QDD), shape, candidates, columns, search=False)


def _values(trace: Trace, base: BaseSet) -> list[Value]:
    def value(coefficient: Coefficient) -> Value:
        assert base.domain is not None, "relations come with their ring"
        parts = (coefficient.numerator, coefficient.denominator)
        numerator, denominator = (trace.domain.constant(polynomial_expression(p, base.domain)) for p in parts)
        return numerator / denominator

    return base_values(trace.robot, base, trace.domain, value)

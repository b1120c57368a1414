"""Standard and base parameters as text in the robot's own symbols, for generated files."""

from __future__ import annotations

from collections.abc import Sequence

from derive.algebra.domain import PolynomialDomain
from derive.algebra.to_expression import polynomial_expression
from derive.errors import ExpressionError
from derive.mechanics.base_parameters import BaseSet
from derive.mechanics.column_relations import Coefficient
from derive.mechanics.grouped_values import grouped_values, standard_values
from derive.robot.arithmetic import add, multiply, power
from derive.robot.expression import Expression
from derive.robot.inertial import Parameter
from derive.robot.printer import to_text
from derive.robot.robot import Robot

MAX_TEXT = 1000
"""Longest formula, in characters, that is written."""


class ParameterFormulas:
    """Formulas of a robot's parameters; empty where a cell is outside of what polynomials can hold.

    Args:
        robot: The robot.
        base: Its base parameters.
    """

    def __init__(self, robot: Robot, base: BaseSet) -> None:
        self._robot = robot
        self._base = base
        try:
            self._domain: PolynomialDomain | None = PolynomialDomain(robot, rates=False)
        except (ExpressionError, ZeroDivisionError):
            self._domain = None

    def standard(self, parameters: Sequence[Parameter]) -> list[str]:
        """What the file gives: ``m1*com1``."""
        domain = self._domain
        if domain is None:
            return [""] * len(parameters)
        values = standard_values(self._robot, parameters, domain)
        return [_text(polynomial_expression(value, domain)) for value in values]

    def base(self) -> list[str]:
        """What is grouped: ``Izz1 + a1**2*m2``."""
        domain = self._domain
        if domain is None:
            return [""] * len(self._base.parameters)
        values = grouped_values(self._robot, self._base, domain)
        sums = {p: [polynomial_expression(values[p], domain)] for p in self._base.parameters}
        for relation in self._base.relations:
            moved = polynomial_expression(values[relation.parameter], domain)
            for parameter, factor in relation.terms:
                sums[parameter].append(multiply(self._coefficient(factor), moved))
        return [_text(add(*terms)) for terms in sums.values()]

    def _coefficient(self, factor: Coefficient) -> Expression:
        assert self._base.domain is not None, "relations come with their ring"
        parts = (factor.numerator, factor.denominator)
        numerator, denominator = (polynomial_expression(p, self._base.domain) for p in parts)
        return multiply(numerator, power(denominator, -1))


def _text(formula: Expression) -> str:
    text = to_text(formula)
    return text if len(text) <= MAX_TEXT else ""

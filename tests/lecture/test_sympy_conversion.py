"""Exact trees and printed factors as SymPy objects."""

from __future__ import annotations

import pytest
import sympy

from derive.algebra.domain import PolynomialDomain
from derive.errors import Location
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy, factor_to_sympy
from derive.lecture.terms import FactorTable
from derive.robot.evaluate import evaluate
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.reading.size_limits import FORMULA_LIMITS
from derive.robot.robot import Robot

HERE = Location("<test>")


@pytest.mark.parametrize(
    "text", ["a*(b - 2)/3", "sqrt(a + b)**3", "sin(a + b)*tan(b)", "atan2(a, b) + pi/5", "lambda + I"]
)
def test_there_and_back_is_the_same_number(text: str) -> None:
    tree = parse_expression(text, HERE, functions=FORMULA_FUNCTIONS, limits=FORMULA_LIMITS)
    numbers = {"a": 0.4, "b": 1.7, "lambda": 2.5, "I": 3.5}
    back = expression_from_sympy(expression_to_sympy(tree))
    assert evaluate(back, numbers) == pytest.approx(evaluate(tree, numbers), rel=1e-14)


def test_users_names_are_symbols_and_nothing_else() -> None:
    assert expression_to_sympy(parse_expression("I*E", HERE)) == sympy.Symbol("I") * sympy.Symbol("E")


def test_constant_angles_stay_as_they_are_written() -> None:
    robot = Robot.from_text("name: arm\nconvention: standard\njoints: [{type: revolute, a: a1, alpha: pi/5}]\n")
    domain = PolynomialDomain(robot)
    shown = {str(factor_to_sympy(domain, factor)) for factor in FactorTable(domain).factors}
    assert {"sin(q1)", "cos(q1)", "a1", "sin(pi/5)", "cos(pi/5)"} <= shown

"""SymPy expressions as exact trees: the same number, and what is refused."""

from __future__ import annotations

from fractions import Fraction

import pytest
import sympy

from derive.errors import ExpressionError
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.robot.evaluate import evaluate
from derive.robot.expression import Number

X, Y = sympy.symbols("x y")


@pytest.mark.parametrize(
    "expression",
    [
        X**2 / 3 - Y,
        sympy.sqrt(X + 1) / Y,
        sympy.sin(X) * sympy.cos(Y) + sympy.tan(X),
        sympy.sec(X) + sympy.csc(Y) - sympy.cot(X),
        (X + Y) ** sympy.Rational(-3, 2),
        sympy.atan2(X, Y) + sympy.pi / 7,
        X * 0.25,
    ],
)
def test_the_tree_has_the_value_of_the_expression(expression: sympy.Expr) -> None:
    numbers = {"x": 0.7, "y": 1.9}
    found = evaluate(expression_from_sympy(expression), numbers)
    assert found == pytest.approx(float(expression.subs(numbers)), rel=1e-14)


def test_a_float_is_the_decimal_that_it_prints() -> None:
    assert expression_from_sympy(0.1) == Number(Fraction(1, 10))


@pytest.mark.parametrize(
    "expression",
    [sympy.exp(X), X**Y, X ** sympy.Rational(1, 3), X**99, sympy.oo, sympy.I, sympy.zoo, "x", sympy.eye(2)],
)
def test_anything_else_is_refused(expression: object) -> None:
    with pytest.raises(ExpressionError):
        expression_from_sympy(expression)


def test_shared_parts_stay_shared() -> None:
    part = sympy.sin(X) + Y
    tree = expression_from_sympy(part**2 + sympy.cos(part))
    power, call = sorted(tree.terms, key=lambda term: type(term).__name__, reverse=True)
    assert power.base is call.arguments[0]

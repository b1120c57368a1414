"""Square roots in the ring: whatever the order of the factors, one normal form."""

from __future__ import annotations

import itertools
from functools import reduce

import pytest

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.errors import ExpressionError, Location
from derive.robot.expression import Call, Name
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot

ROBOT = Robot.load("dh-classical-deluca")


def polynomials(*texts: str) -> list[Polynomial]:
    cells = [parse_expression(text, Location("cell")) for text in texts]
    domain = PolynomialDomain(ROBOT, cells)
    return [domain.constant(cell) for cell in cells]


@pytest.mark.parametrize(
    "factors",
    [
        ("sqrt(sin(alpha1))", "sin(alpha1)", "sqrt(sin(alpha1))", "sin(alpha1)"),
        ("sqrt(a1 + sqrt(2)*d1)", "sqrt(2)", "sqrt(a1 + sqrt(2)*d1)", "d1"),
        ("sqrt(1 + sqrt(sin(alpha1)))", "sqrt(sin(alpha1))", "sqrt(1 + sqrt(sin(alpha1)))", "sin(alpha1)"),
    ],
)
def test_a_product_has_one_normal_form(factors: tuple[str, ...]) -> None:
    values = polynomials(*factors)
    products = [reduce(lambda a, b: a * b, order) for order in itertools.permutations(values)]
    assert all(product == products[0] for product in products)


def test_the_square_of_a_root_of_a_sine_is_the_sine() -> None:
    root, sine, cosine = polynomials("sqrt(sin(alpha1))", "sin(alpha1)", "cos(alpha1)")
    assert root * root == sine
    assert root * sine * root == 1 - cosine * cosine


def test_a_function_that_the_ring_does_not_know_is_no_sine() -> None:
    sign = Call("sign", (Name("a1"),))
    with pytest.raises(ExpressionError, match="sign in an algebraic expression"):
        PolynomialDomain(ROBOT, [sign]).constant(sign)

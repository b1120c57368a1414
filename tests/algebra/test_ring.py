"""Exact arithmetic: polynomials are in normal form, and nothing that is equal looks different."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.errors import Location
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot

TEXT = """
name: test-arm
convention: standard
joints:
  - {type: revolute, alpha: 37*pi/180, a: a1}
  - {type: revolute, alpha: al2, d: sqrt(2)/3}
  - {type: prismatic, theta: 0.3, a: 1/(b + 1)}
"""


def domain_for(*cells: str) -> PolynomialDomain:
    return PolynomialDomain(Robot.from_text(TEXT), [parse(cell) for cell in cells])


def parse(cell: str):  # type: ignore[no-untyped-def]
    return parse_expression(cell, Location("cell"))


def zero(*cells: str) -> Polynomial:
    """The sum of the cells, as a polynomial."""
    domain = domain_for(*cells)
    return sum((domain.constant(parse(cell)) for cell in cells), domain.ring.zero)


@pytest.mark.parametrize(
    "cell",
    [
        "sin(q1)**2 + cos(q1)**2 - 1",
        "cos(q1 + q2) - cos(q1)*cos(q2) + sin(q1)*sin(q2)",
        "sin(q1 - q2) - sin(q1)*cos(q2) + cos(q1)*sin(q2)",
        "cos(3*q1) - 4*cos(q1)**3 + 3*cos(q1)",
        "sqrt(2)*sqrt(3) - sqrt(6)",
        "sqrt(8) - 2*sqrt(2)",
        "sqrt(1/2) - sqrt(2)/2",
        "sqrt(a + b)**2 - a - b",
        "(a + b)/(a + b) - 1",
        "a/(a + b) + b/(a + b) - 1",
        "tan(al2)*cos(al2) - sin(al2)",
        "1 + tan(al2)**2 - 1/cos(al2)**2",
        "cos(pi/3) - 1/2",
        "cos(pi/12) - (sqrt(6) + sqrt(2))/4",
        "sin(7*pi/12) - (sqrt(6) + sqrt(2))/4",
        "cos(pi/12)**2 + sin(pi/12)**2 - 1",
        "sin(pi/3) - sqrt(3)/2",
        "sin(5*pi/4) + sqrt(2)/2",
        "cos(37*pi/180)**2 + cos(53*pi/180)**2 - 1",
        "sin(al2/2)*cos(al2/2)*2 - sin(al2)",
        "cos(0.3)**2 + sin(0.3)**2 - 1",
        "cos(q1 + pi/2) + sin(q1)",
        "pi*a - a*pi",
    ],
)
def test_identities_reduce_to_zero(cell: str) -> None:
    assert not zero(cell)


@pytest.mark.parametrize("cell", ["sin(q1)**2 - cos(q1)**2", "sqrt(2) - 1.4142135623730951", "cos(37*pi/180) - 0.7986"])
def test_what_is_not_identical_stays(cell: str) -> None:
    assert zero(cell)


def test_the_normal_form_does_not_depend_on_the_order_of_operations() -> None:
    domain = domain_for("a", "b")
    s = domain.cosine_sine_of(0)[1]
    a, b = domain.ring.generator("a"), domain.ring.generator("b")
    assert (a + b) * s * s == s * (a * s) + b * s * s
    assert hash((a + b) * s) == hash(b * s + s * a)


@given(st.integers(-5, 5), st.fractions(max_denominator=30))
def test_numbers_mix_in_on_either_side(k: int, f: Fraction) -> None:
    x = domain_for("x").ring.generator("x")
    assert k + x == x + k
    assert f * x == x * f
    assert k - x == -(x - k)
    assert (f + x) - f == x


def test_a_budget_of_terms_is_kept() -> None:
    domain = PolynomialDomain(Robot.from_text(TEXT), [parse("a + b")], max_terms=5)
    x = domain.ring.generator("a") + domain.ring.generator("b")
    with pytest.raises(TooManyTerms, match="more than 5 terms"):
        x**6


@pytest.mark.parametrize(("joint", "cell"), [(0, "cos(q1 + q2)"), (1, "sin(q2)**2*q3"), (2, "q3**2*cos(q1)")])
def test_derivatives_are_those_of_calculus(joint: int, cell: str) -> None:
    import sympy

    from derive.lecture.sympy_conversion import expression_to_sympy

    domain = domain_for(cell)
    symbol = sympy.Symbol(f"q{joint + 1}")
    expected = sympy.diff(expression_to_sympy(parse(cell)), symbol)
    derived = domain.derivative(domain.constant(parse(cell)), joint)
    text = str(expected)
    wide = domain_for(cell, text)
    assert wide.ring.project(derived) == wide.constant(parse(text))


@pytest.mark.parametrize(
    "cell",
    [
        "cos(a + b + c + d + e + f)**2 + sin(a + b + c + d + e + f)**2 - 1",
        "sin(1000000*a)**2 + cos(1000000*a)**2 - 1",
        "sin(31*a)**2 + cos(31*a)**2 - 1",
        "cos(q1 + a + b + c + d + e)**2 + sin(q1 + a + b + c + d + e)**2 - 1",
    ],
)
def test_angles_too_long_or_too_many_for_the_addition_theorem_stay_exact(cell: str) -> None:
    assert not zero(cell)

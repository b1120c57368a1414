"""Scalars that are rational as long as they can be, and enclose the truth otherwise."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from operator import mul

import pytest

from derive.errors import ExpressionError, Location
from derive.mechanics.space import exactly
from derive.model.identification.exact_scalars import ExactDomain, as_fraction, is_rational, is_zero, null_space
from derive.robot.expression import Expression
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot


def cell(text: str) -> Expression:
    return parse_expression(text, Location("cell"))


def test_rational_cells_stay_rational_and_others_are_enclosed() -> None:
    with exactly():
        domain = ExactDomain(Robot.load("puma560-corke"))
        product = domain.constant(cell("a2*a3 - 0.4318**2/2"))
        assert is_rational(product)
        assert as_fraction(product) == Fraction("0.4318") * Fraction("0.0203") - Fraction("0.4318") ** 2 / 2
        for text, value in (
            ("sqrt(2)*pi", math.sqrt(2) * math.pi),
            ("sin(1/3)", math.sin(1 / 3)),
        ):
            found = domain.constant(cell(text))
            assert not is_rational(found)
            assert abs(float(found) - value) < 1e-15
        assert is_zero(domain.constant(cell("sin(pi)")))
        with pytest.raises(ExpressionError):
            domain.constant(cell("1/sin(pi)"))


def test_quarter_turns_have_rational_cosines() -> None:
    with exactly():
        domain = ExactDomain(Robot.load("puma560-corke"))
        cosine, sine = domain.cosine_sine(cell("-3*pi/2"))
        assert is_rational(cosine)
        assert (cosine, sine) == (0, 1)
        cosine, sine = domain.cosine_sine(cell("pi/3"))
        assert not is_rational(cosine)
        assert cosine.overlaps(domain.number(Fraction(1, 2)) + 0 * cosine)


def test_symbols_without_numbers_are_named() -> None:
    robot = Robot.load("puma560-corke")
    with pytest.raises(ExpressionError, match="no number for a2, d3, d4, g"):
        ExactDomain(replace(robot, parameters=tuple(pair for pair in robot.parameters if pair[0] == "a3")))


def test_the_null_space_is_what_all_rows_send_to_zero() -> None:
    with exactly():
        domain = ExactDomain(Robot.load("puma560-corke"))
        root = domain.constant(cell("sqrt(2)"))
        rows = [[domain.number(k) for k in (1, 2, 3)] + [root], [domain.number(k) for k in (2, 4, 6)] + [2 * root]]
        basis = null_space(rows, 4)
        assert set(basis) == {1, 2, 3}
        assert all(is_zero(sum(map(mul, row, vector))) for row in rows for vector in basis.values())

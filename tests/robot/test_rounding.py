"""Shown numbers: exact where they are short, rounded in the last place elsewhere, never zero, and read back."""

from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive.errors import Location
from derive.robot.expression import to_text
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from derive.robot.rounding import is_given_in_decimals, number_text, shown

NUMBERS = st.builds(
    lambda p, q, e: Fraction(p, q) * Fraction(10) ** e,
    st.integers(-(10**20), 10**20),
    st.integers(1, 10**12),
    st.integers(-15, 9),
)


def read(text: str) -> Fraction:
    value = parse_expression(text.removeprefix("-"), Location("test")).value
    return -value if text.startswith("-") else value


@pytest.mark.parametrize(
    ("value", "decimals", "text"),
    [
        ("1/2", True, "1/2"), ("-3/4", True, "-3/4"), ("1/2", False, "1/2"), ("0.4318", True, "0.4318"),
        ("23.45", True, "23.45"), ("1/3", True, "1/3"), ("7/16", False, "7/16"), ("7/16", True, "0.4375"),
        ("123456", True, "123456"), ("1234567", True, "1.23457e6"), ("1129213793321/500000000000", True, "2.25843"),
        ("1129213793321/500000000000", False, "2.25843"), ("0.00000012345678", True, "1.23457e-7"),
        ("0.0001", True, "0.0001"), ("0", True, "0"),
    ],
)  # fmt: skip
def test_what_is_exact_and_short_stays_and_the_rest_has_six_digits(value: str, decimals: bool, text: str) -> None:
    assert number_text(Fraction(value), decimals=decimals) == text


@given(NUMBERS, st.booleans(), st.integers(1, 12))
def test_a_rounded_number_is_off_by_half_its_last_digit_at_most(value: Fraction, decimals: bool, digits: int) -> None:
    printed = read(number_text(value, decimals=decimals, digits=digits))
    assert (printed == 0) == (value == 0)
    if value:
        place = Fraction(10) ** (
            Decimal(abs(float(value))).adjusted() + 1 - digits
        )  # a power too large where float rounds
        assert abs(printed - value) <= place / 2


@given(NUMBERS, st.booleans())
def test_all_digits_are_the_number(value: Fraction, decimals: bool) -> None:
    assert read(number_text(value, decimals=decimals, digits=None)) == value


@given(NUMBERS, st.booleans(), st.integers(1, 12))
def test_rounding_again_changes_nothing(value: Fraction, decimals: bool, digits: int) -> None:
    once = Fraction(shown(value, decimals=decimals, digits=digits))
    assert Fraction(shown(once, decimals=decimals, digits=digits)) == once


@pytest.mark.parametrize(("name", "expected"), [("puma560-corke", True), ("scara-perugia", False)])
def test_a_robot_with_decimals_in_its_cells_is_given_in_decimals(name: str, expected: bool) -> None:
    assert is_given_in_decimals(Robot.load(name)) is expected


def test_multiples_of_pi_in_a_formula_stay_fractions() -> None:
    formula = parse_expression("pi/20 + 7*a/20 - 3*b/8/c", Location("test"))
    text = to_text(formula, lambda value: number_text(value, decimals=True))
    assert text == "pi/20 + 0.35*a - 0.375*b/c"

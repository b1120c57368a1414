"""Rationals in print: what is printed is the number, as exactly as the digits allow."""

import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive.handouts.notation.pieces import magnitude
from derive.robot.rounding import DIGITS


@pytest.mark.parametrize(
    ("value", "decimals", "tex"),
    [
        (Fraction(7), False, "7"),
        (Fraction(-1, 2), False, r"\tfrac{1}{2}"),
        (Fraction(1, 2), True, "0.5"),
        (Fraction(1, 3), True, r"\tfrac{1}{3}"),
        (Fraction(4318, 10000), True, "0.4318"),
        (Fraction(12, 10**8), True, r"1.2 \cdot 10^{-7}"),
        (Fraction(10**9), True, "10^{9}"),
    ],
)
def test_numbers_look_as_on_paper(value: Fraction, decimals: bool, tex: str) -> None:
    assert magnitude(value, decimals).tex == tex


@given(st.fractions(max_denominator=10**12), st.booleans())
def test_the_printed_number_is_the_number(value: Fraction, decimals: bool) -> None:
    box = magnitude(value, decimals)
    text = re.sub(r"\\tfrac\{(\d+)\}\{(\d+)\}", r"\1/\2", box.tex)
    mantissa, _, exponent = text.replace("10^{", " \\cdot 10^{").removeprefix(" \\cdot ").partition("10^{")
    number = Fraction(mantissa.removesuffix(" \\cdot ").replace(" \\cdot", "").strip() or "1")
    if exponent:
        number *= Fraction(10) ** int(exponent.rstrip("}"))
    assert abs(number - abs(value)) <= abs(value) / 10 ** (DIGITS - 1)
    assert box.width > 0


@given(st.fractions(max_denominator=10**12), st.booleans())
def test_a_decimal_comma_is_in_braces_and_changes_nothing_else(value: Fraction, decimals: bool) -> None:
    """TeX would put a space behind a bare one."""
    point, comma = magnitude(value, decimals), magnitude(value, decimals, comma=True)
    assert "." not in comma.tex
    assert comma.tex.replace("{,}", ".") == point.tex
    assert comma.width == point.width

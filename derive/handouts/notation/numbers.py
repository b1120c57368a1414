r"""Rationals in print: ``\tfrac{1}{2}``, ``0.4318``, ``1.2 \cdot 10^{-7}``.

A robot given by decimals is printed in decimals, any other in fractions. A number with more than `DIGITS` significant
digits is rounded in print; the sheet states the rule.
"""

from __future__ import annotations

from decimal import Context, Decimal, localcontext
from fractions import Fraction

from derive.handouts.notation.pieces import DOT_WIDTH, SCRIPT, Box, fraction, italic

DIGITS = 6
"""Significant digits printed of a number that has more: a handout is read, the generated code is exact."""

LONGEST_FRACTION = 4
"""Digits of a numerator or denominator that still read as a fraction."""

_DIGIT_WIDTH = 5.0
_TEN_WIDTH = 10.5


def magnitude(value: Fraction, decimals: bool, *, digits: int = DIGITS, small: bool = True) -> Box:
    """The absolute value of a rational number in print.

    Args:
        value: The number.
        decimals: Whether to prefer 0.5 to one half.
        digits: Significant digits to print.
        small: Whether a fraction is set at script size, as in a coefficient.
    """
    value = abs(value)
    numerator, denominator = str(value.numerator), str(value.denominator)
    if value.denominator == 1 and len(numerator) <= digits:
        return italic(numerator)
    short = len(numerator) <= LONGEST_FRACTION and len(denominator) <= LONGEST_FRACTION
    if short and value.denominator != 1 and not (decimals and _has_finitely_many_decimals(value)):
        return fraction(italic(numerator), italic(denominator), small)
    with localcontext(Context(prec=digits)):
        rounded = (Decimal(value.numerator) / Decimal(value.denominator)).normalize()
    exponent = rounded.adjusted()
    if -4 <= exponent <= digits:
        plain = f"{rounded:f}"
        return Box(plain, _DIGIT_WIDTH * len(plain))
    power = f"10^{{{exponent}}}"
    power_width = _TEN_WIDTH + italic(str(exponent)).width * SCRIPT
    mantissa = f"{rounded.scaleb(-exponent).normalize():f}"
    if mantissa == "1":
        return Box(power, power_width)
    return Box(f"{mantissa} \\cdot {power}", _DIGIT_WIDTH * len(mantissa) + DOT_WIDTH + power_width)


def _has_finitely_many_decimals(value: Fraction) -> bool:
    denominator = value.denominator
    for prime in (2, 5):
        while denominator % prime == 0:
            denominator //= prime
    return denominator == 1

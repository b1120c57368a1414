"""How a rational number is shown: exactly where it is short, else rounded to significant digits, and never to zero.

Closed forms, generated code and verdicts hold exact numbers; what is rounded is their print alone, and it says so.
"""

from decimal import ROUND_HALF_UP, Context, Decimal
from fractions import Fraction

from derive.robot.description import Description
from derive.robot.expression import Number, Sum
from derive.robot.names import expressions

DIGITS = 6  # significant digits shown of a number that has more
LONGEST_FRACTION = 4  # digits of a numerator or denominator that still read as a fraction
_QUARTERS = (Fraction(1, 4), Fraction(1, 2), Fraction(3, 4))


def is_given_in_decimals(robot: Description) -> bool:
    """Whether a robot is given by decimals: a cell of its file, or a term of one, is a number that is not whole."""
    terms = (term for cell in expressions(robot) for term in (cell.terms if isinstance(cell, Sum) else (cell,)))
    return any(isinstance(term, Number) and term.value.denominator != 1 for term in terms)


def shown(value: Fraction, *, decimals: bool, digits: int | None = DIGITS) -> Fraction | Decimal:
    """A number as it is shown, with so many significant digits; None for all of them."""
    longest = max(len(str(abs(value.numerator))), len(str(value.denominator)))
    if value.denominator == 1 and (digits is None or longest <= digits):
        return value
    # A decimal ends where the denominator divides a power of ten: it is 2^a 5^b, and a, b are at most its bits.
    is_finite = pow(10, value.denominator.bit_length(), value.denominator) == 0
    short = digits is None or longest <= LONGEST_FRACTION
    if short and value.denominator != 1 and not (decimals and is_finite):
        return value
    places = digits if digits is not None else longest + value.denominator.bit_length()
    context = Context(prec=places, rounding=ROUND_HALF_UP)
    return context.divide(Decimal(value.numerator), Decimal(value.denominator)).normalize(context)


def number_text(value: Fraction, *, decimals: bool, digits: int | None = DIGITS) -> str:
    """A number as text of the cell grammar: ``3/4``, ``0.4318``, ``2.25843``, ``1.5e-7``; all digits for None."""
    found = shown(value, decimals=decimals and abs(value) not in _QUARTERS, digits=digits)
    if isinstance(found, Fraction):
        return str(found)
    return f"{found:f}" if -4 <= found.adjusted() < (digits or DIGITS) else f"{found:e}".replace("e+", "e")

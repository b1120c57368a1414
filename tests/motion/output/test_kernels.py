"""Pieces as tapes give what the pieces give, exactly where these are exact."""

from __future__ import annotations

from fractions import Fraction

import pytest
from sympy import Abs, Integer, Rational, cos, exp, pi, sin, sqrt, tan

from derive.errors import QuantityError
from derive.motion.output.kernels import CLOCK, ROW, kernel_name, kernel_of, row_of
from derive.plans.hermite import TIME, Piece
from derive.plans.profile import Cosine, Curve
from derive.programs.tape.tape import evaluate

ZERO = Integer(0)


def values(piece, t, row, arithmetic):
    return evaluate(kernel_of(piece, "q1").tape, {CLOCK: [t], ROW: row}, arithmetic)


@pytest.mark.parametrize("k", [2, 3, 4])
def test_polynomials_are_exact_in_rationals(k: int) -> None:
    """Against the polynomial that SymPy expands, differentiated by SymPy."""
    ends = tuple(tuple(Rational(7 * i + 3 * end + 1, 5) for i in range(k)) for end in range(2))
    piece = Piece(Rational(1, 3), Rational(5, 4), ends)
    polynomial = piece.in_unit_time()
    row = [Fraction(1, 3), Fraction(5, 4), *(Fraction(int(v.p), int(v.q)) for end in ends for v in end)]
    for u in (Fraction(0), Fraction(2, 7), Fraction(1)):
        found = values(piece, row[0] + u * row[1], row, {"number": Fraction})
        for order, value in enumerate(found):
            wanted = polynomial.eval(Rational(u.numerator, u.denominator)) / piece.duration**order
            assert Rational(value.numerator, value.denominator) == wanted
            polynomial = polynomial.diff() if order < 2 else piece.in_unit_time()


def sympy_arithmetic():
    return {
        "number": lambda value: Rational(value.numerator, value.denominator) if isinstance(value, Fraction) else pi,
        "sin": sin,
        "cos": cos,
        "sqrt": sqrt,
        "less": lambda a, b: int(bool(a < b)),
        "select": lambda case, a, b: a if case else b,
        "absolute": Abs,
    }


@pytest.mark.parametrize("u", [ZERO, Rational(1, 3), Rational(1, 2), Rational(5, 6), Integer(1)])
def test_harmonic_pieces_are_cosines(u: Integer) -> None:
    piece = Cosine(Integer(2), Integer(3), ((Integer(1),), (Integer(5),)))
    found = values(piece, 2 + 3 * u, [2, 3, 1, 5], sympy_arithmetic())
    formula = 1 + 4 * (1 - cos(pi * (TIME - 2) / 3)) / 2
    for order, value in enumerate(found):
        assert (value - formula.diff(TIME, order).subs(TIME, 2 + 3 * u)).equals(0)


def test_curves_are_derived_exactly() -> None:
    formula = sqrt(1 + TIME**2) * tan(TIME / 9) / (2 + sin(TIME)) ** 3
    piece = Curve(ZERO, Integer(5), (formula, formula.diff(TIME), formula.diff(TIME, 2)))
    found = values(piece, Rational(7, 5), [], sympy_arithmetic())
    for value, wanted in zip(found, piece.formulas, strict=True):
        assert abs((value - wanted.subs(TIME, Rational(7, 5))).evalf(40)) < 1e-30


def test_a_formula_that_no_language_has_is_refused() -> None:
    formula = exp(TIME)
    with pytest.raises(QuantityError, match="has no place in generated code"):
        kernel_of(Curve(ZERO, Integer(1), (formula,) * 3), "q1")


def test_rows_begin_with_start_and_duration() -> None:
    piece = Cosine(Integer(2), Rational(1, 2), ((pi,), (ZERO,)))
    assert row_of(piece) == (2.0, 0.5, float(pi), 0.0)
    assert row_of(Curve(ZERO, Integer(5), (TIME,) * 3)) == (0.0, 5.0)
    assert kernel_name(Curve(ZERO, Integer(5), (TIME,) * 3), "q2") == "curve_q2"

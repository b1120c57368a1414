"""Polynomials by their end values."""

from __future__ import annotations

from fractions import Fraction
from math import factorial

import numpy as np
import pytest
from sympy import Integer, Rational, pi

from derive.plans.hermite import Piece, basis, joined, power_coefficients, sampled


def derivative(row: tuple[int, ...], order: int, u: int) -> Fraction:
    """A derivative of a polynomial at 0 or 1, by falling factorials."""
    terms = (
        c * Fraction(factorial(p), factorial(p - order)) * u ** (p - order) for p, c in enumerate(row) if p >= order
    )
    return sum(terms, Fraction(0))


@pytest.mark.parametrize("k", [2, 3, 4])
def test_each_polynomial_has_one_derivative_at_one_end_and_none_of_the_others(k: int) -> None:
    for b, row in enumerate(basis(k)):
        at, order = divmod(b, k)
        for end in (0, 1):
            for other in range(k):
                expected = factorial(order) if (end, other) == (at, order) else 0
                assert derivative(row, other, end) == expected


@pytest.mark.parametrize("k", [2, 3, 4])
def test_values_at_both_ends_are_those_that_were_given_to_the_last_bit(k: int) -> None:
    numbers = np.random.default_rng(k).normal(size=(1, 2 * k))
    for duration in (0.1, 1.7, 3.0):
        for order in range(k):
            start = sampled(numbers, k, np.array([0.0]), np.array([duration]), order)
            end = sampled(numbers, k, np.array([1.0]), np.array([duration]), order)
            assert start == numbers[0, order]
            assert end == numbers[0, k + order]


@pytest.mark.parametrize("k", [2, 3, 4])
def test_samples_powers_and_the_exact_polynomial_agree(k: int) -> None:
    values = tuple(tuple(Rational(3 * i + 7 * end - 4, 5) for i in range(k)) for end in range(2))
    piece = Piece(Integer(1), Rational(3, 2), values)
    numbers = np.array([float(value) for end in values for value in end])
    exact, places = piece.in_unit_time(), np.linspace(0, 1, 7)
    powers = power_coefficients(numbers, k, 1.5)
    rows, durations = np.repeat(numbers[None], 7, axis=0), np.full(7, 1.5)
    for order in range(3):
        found = sampled(rows, k, places, durations, order)
        expected = [float(exact.eval(Rational(i, 6))) / 1.5**order for i in range(7)]
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)
        assert np.polyval(np.polyder(powers, order), places) / 1.5**order == pytest.approx(found, rel=1e-12, abs=1e-12)
        exact = exact.diff()


def test_pieces_between_points_share_their_values() -> None:
    ends = [(Integer(0), pi), (pi / 2, Integer(1)), (Integer(3), Integer(0))]
    first, second = joined(ends, [Integer(0), Integer(2), Integer(3)])
    assert first.values[1] == second.values[0]
    assert (first.end, second.end) == (2, 3)


def test_short_ways_keep_their_digits() -> None:
    """From 1 to 1 + 1e-9 in a hundredth of a second: the way is a difference of positions, not of products of them."""
    numbers = np.array([1.0, 0.0, 0.0, 1.0 + 2.0**-30, 0.0, 0.0])
    u = np.linspace(0, 1, 11)
    wanted = 2.0**-30 * (60 * u - 180 * u**2 + 120 * u**3) / 0.01**2
    found = sampled(np.tile(numbers, (11, 1)), 3, u, np.full(11, 0.01), 2)
    assert found == pytest.approx(wanted, rel=1e-12, abs=1e-16)
    powers = np.poly1d(power_coefficients(numbers, 3, 0.01)).deriv(2)(u) / 0.01**2
    assert powers == pytest.approx(wanted, rel=1e-12, abs=1e-16)

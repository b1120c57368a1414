"""Largest speeds and accelerations."""

from __future__ import annotations

import numpy as np
import pytest
from sympy import Float, Integer, Rational, pi, sqrt

from derive.motion.curves.extremes import peak
from derive.motion.curves.trajectory import Trajectory
from derive.plans.hermite import TIME, Piece, joined
from derive.plans.profile import Curve, spline, via_velocities
from derive.plans.segments import Segment

ZERO = Integer(0)


def test_of_the_report_of_document_004_exactly() -> None:
    """Quintic, 3 s, by pi/2: 5 pi/16 rad/s at 1.5 s, and 5 pi/(9 sqrt 3) rad/s^2 at (3 -+ sqrt 3)/2 s."""
    rest = (ZERO, ZERO)
    pieces = (Piece(ZERO, Integer(3), ((ZERO, *rest), (pi / 2, *rest))),)
    speed, acceleration = peak(pieces, 1), peak(pieces, 2)
    assert (speed.value, speed.time) == (5 * pi / 16, Rational(3, 2))
    assert acceleration.value.equals(5 * pi / (9 * sqrt(3)))
    assert acceleration.time.equals((3 - sqrt(3)) / 2)


@pytest.mark.parametrize("seed", range(12))
def test_no_sample_is_larger_and_one_is_as_large(seed: int) -> None:
    random = np.random.default_rng(seed)
    k = int(random.integers(2, 5))
    values = tuple(tuple(Rational(int(c), 7) for c in random.integers(-9, 9, size=k)) for _ in range(2))
    piece = Piece(Integer(1), Rational(3, 2), values)
    t = np.linspace(1, 2.5, 20001)
    sampled = Trajectory((Segment("", Integer(1), piece.duration, ((piece,),)),))(t)
    for order in (1, 2):
        found = peak((piece,), order)
        largest = float(np.abs(sampled[order]).max())
        assert abs(float(found.value)) == pytest.approx(largest, rel=1e-6, abs=1e-12)
        assert abs(float(found.value)) >= largest * (1 - 1e-12)


def test_mixed_constants_are_found_in_numbers_where_roots_are_no_square_roots() -> None:
    values = ((ZERO, pi, Integer(1), ZERO), (sqrt(2), Integer(0), pi**2, Integer(1)))
    found = peak((Piece(ZERO, Integer(1), values),), 1)
    assert not found.is_exact


def test_the_earliest_of_equal_peaks_is_told() -> None:
    times = [Integer(t) for t in range(3)]
    pieces = spline(times, [ZERO, Integer(1), ZERO])
    assert peak(pieces, 1).time < 1


def test_of_a_formula_at_samples() -> None:
    formula = TIME**3
    curve = Curve(ZERO, Integer(2), (formula, formula.diff(TIME), formula.diff(TIME, 2)))
    found = peak((curve,), 1)
    assert not found.is_exact
    assert float(found.value) == pytest.approx(12)


def test_at_a_square_root_the_value_is_that_of_a_short_remainder() -> None:
    """Long fractions times pi at points that are passed, such as decimal degrees give."""
    times = [Integer(0), Rational(9, 4), Rational(314, 100)]
    positions = [Rational(k, 10**6) * pi / 180 for k in (-50709714, 228931046, 18581321)]
    ends = [(q, v, ZERO, ZERO) for q, v in zip(positions, via_velocities(times, positions), strict=True)]
    first, _ = joined(ends, times)
    derivative = first.in_unit_time().diff()
    found = peak((first,), 1)
    u = (found.time - first.start) / first.duration
    assert float(found.value) == pytest.approx(float(derivative(u).evalf(30)) / float(first.duration), rel=1e-14)


def test_of_a_piece_with_a_float_at_one_end_in_numbers() -> None:
    """From a point in joint variables to a pose."""
    piece = Piece(ZERO, Integer(2), ((pi / 2, ZERO, ZERO), (Float(1.0), ZERO, ZERO)))
    found = peak((piece,), 1)
    assert not found.is_exact
    assert float(found.value) == pytest.approx(15 / 16 * (1 - np.pi / 2), rel=1e-12)
    first = peak((piece,), 2)
    assert float(first.time) == pytest.approx(1 - 1 / np.sqrt(3), rel=1e-9), "the earlier of two that are alike"
    assert float(first.value) < 0

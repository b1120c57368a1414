"""Times by limits."""

from __future__ import annotations

import numpy as np
import pytest
from sympy import Float, Integer, Rational, pi, sqrt

from derive.motion.curves.limits import Limits, placed, proportions, rounded_up, trapezoid_peaks
from derive.plans.hermite import Piece
from derive.plans.profile import CRUISE

ZERO = Integer(0)


def limits(*, speed: object = None, acceleration: object = None) -> Limits:
    return Limits((speed,), (acceleration,), (None,))  # type: ignore[arg-type]


def test_a_motion_is_stretched_by_the_joint_that_needs_most() -> None:
    both = Limits((Integer(2), None), (Integer(3), Integer(8)), (None, None))
    assert both.stretch([Integer(4), Integer(9)], [Integer(3), ZERO]) == 2
    assert both.stretch([Integer(4), Integer(9)], [Integer(3), Integer(72)]) == 3
    assert both.stretch([ZERO, ZERO], [ZERO, ZERO]) == 0


def test_what_nothing_limits_has_no_time() -> None:
    assert Limits((Integer(1), None), (None, None), (None, None)).stretch([ZERO, Integer(1)], [ZERO, ZERO]) is None


@pytest.mark.parametrize("way", [pi, Rational(1, 10), Integer(7)])
def test_a_trapezoid_at_full_limits_takes_the_time_of_books(way: object) -> None:
    """T = D/V + V/A where V is reached, 2 sqrt(D/A) where it is not (Biagiotti and Melchiorri, 3.2)."""
    speed, acceleration = Rational(3, 2), Integer(2)
    found = limits(speed=speed, acceleration=acceleration)
    top, hard = trapezoid_peaks(found.cruise(0, way))  # type: ignore[arg-type]
    reached = speed**2 < acceleration * way  # type: ignore[operator]
    expected = way / speed + speed / acceleration if reached else 2 * sqrt(way / acceleration)  # type: ignore[operator]
    assert (found.stretch([top * way], [hard * way]) - expected).simplify() == 0  # type: ignore[union-attr]


def test_a_trapezoid_with_one_limit_alone() -> None:
    assert limits(acceleration=Integer(2)).cruise(0, Integer(1)) == 2
    assert limits(speed=Integer(2)).cruise(0, Integer(1)) == CRUISE


def test_limits_in_floats_are_infinite_where_there_are_none() -> None:
    speed, acceleration, torque = limits(speed=pi).numbers()
    assert (speed.tolist(), acceleration.tolist(), torque.tolist()) == ([float(pi)], [np.inf], [np.inf])


def test_proportions_are_short_fractions_and_none_is_zero() -> None:
    assert proportions([1.0, 2.0, 0.0, 2 / 3]) == (Rational(1, 2), 1, Rational(1, 100), Rational(1, 3))
    assert proportions([0.0]) == (Rational(1, 100),)


def test_times_are_rounded_up() -> None:
    assert rounded_up(1.0) == 1 + Rational(1, 10**6)
    assert rounded_up(0.1234561) == Rational(123457, 10**6)


def test_a_piece_that_takes_longer_has_the_same_points() -> None:
    piece = Piece(Integer(1), Integer(2), ((Integer(3), Integer(4), Integer(5)), (Float(6), ZERO, Integer(7))))
    moved = placed(piece, Integer(10), Integer(2))
    assert (moved.start, moved.duration) == (12, 4)
    assert moved.values == ((3, 2, Rational(5, 4)), (Float(6), 0, Rational(7, 4)))

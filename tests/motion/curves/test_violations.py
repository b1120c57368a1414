"""What is beyond its bounds, and where most."""

from __future__ import annotations

import numpy as np

from derive.motion.curves.violations import Violation, exceeded, nearby

TIMES = np.array([0.0, 1.0, 2.0, 3.0])
SPEEDS = np.array([[0.0, 1.0], [2.0, -3.0], [2.5, -2.0], [0.0, 0.5]])


def test_each_limit_is_told_where_it_is_exceeded_most() -> None:
    bounds = {"speed": (np.array([-1.0, -1.5]), np.array([1.0, np.inf]))}
    assert exceeded(TIMES, {"speed": SPEEDS}, bounds) == (
        Violation(0, "speed", 2.0, 2.5, 1.0),
        Violation(1, "speed", 1.0, -3.0, -1.5),
    )


def test_of_a_lower_and_an_upper_limit_the_one_that_is_exceeded_more_is_told() -> None:
    bounds = {"speed": (np.array([-np.inf, -2.5]), np.array([np.inf, 0.2]))}
    (found,) = exceeded(TIMES, {"speed": SPEEDS}, bounds)
    assert (found.limit, found.value, found.excess) == (0.2, 1.0, 0.8)


def test_rounding_exceeds_nothing() -> None:
    bounds = {"speed": (np.array([-9.0, -9.0]), np.array([2.5 * (1 - 1e-12), 1.0]))}
    assert exceeded(TIMES, {"speed": SPEEDS}, bounds) == ()


def test_limits_are_near_where_what_moves_is_close_to_them_and_they_fit_the_picture() -> None:
    """Two angles that go up to 2.5 and down to -3 rad/s, and a slide that hardly moves beside its limit."""
    rows = np.hstack([SPEEDS, [[2.0], [2.01], [2.0], [2.0]]])
    low, high = np.array([-4.0, -4.0, -9.0]), np.array([3.0, np.inf, 2.5])
    near = nearby({"speed": rows}, {"speed": (low, high)}, np.array([True, True, False]))
    assert [bound.tolist() for bound in near["speed"]] == [[-np.inf, -4, -np.inf], [3, np.inf, np.inf]]

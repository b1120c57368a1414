"""Laws between two points: profiles and Hermite polynomials."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from sympy import Integer, Rational, pi, sqrt

from derive.motion.curves.limits import peak
from derive.motion.curves.trajectory import Trajectory
from derive.plans.profile import (
    UNIT_PEAKS,
    Cosine,
    Piece,
    Profile,
    power_coefficients,
    rest_to_rest,
    sampled,
    spline,
    trapezoid,
    via_velocities,
)
from derive.plans.segments import Segment

ZERO = Integer(0)


def one_joint(pieces: tuple, duration: object) -> Trajectory:
    return Trajectory((Segment("a -> b", ZERO, duration, (pieces,)),))


@pytest.mark.parametrize("profile", list(UNIT_PEAKS))
def test_peaks_of_a_unit_motion_are_those_of_books(profile: Profile) -> None:
    pieces = rest_to_rest(profile, ZERO, Integer(1), ZERO, Integer(1))
    for order, expected in zip((1, 2), UNIT_PEAKS[profile], strict=True):
        found = peak(pieces, order)
        assert found.is_exact
        assert (found.value - expected).simplify() == 0


@pytest.mark.parametrize("profile", list(UNIT_PEAKS))
def test_a_profile_stands_at_both_ends_and_passes_the_middle_half_way(profile: Profile) -> None:
    motion = one_joint(rest_to_rest(profile, ZERO, Integer(3), Integer(1), pi), Integer(3))
    q, qd, _ = motion(np.array([0.0, 1.5, 3.0]))
    assert q[[0, 2], 0].tolist() == [1.0, float(pi)]
    assert qd[[0, 2], 0].tolist() == [0.0, 0.0]
    assert q[1, 0] == pytest.approx((1 + float(pi)) / 2, rel=1e-15)


def test_harmonic_motion_is_a_cosine() -> None:
    motion = one_joint((Cosine(ZERO, Integer(2), ((Integer(1),), (Integer(4),))),), Integer(2))
    t = np.linspace(0, 2, 41)
    q, qd, qdd = (value[:, 0] for value in motion(t))
    assert q == pytest.approx(1 + 1.5 * (1 - np.cos(np.pi * t / 2)), abs=1e-14)
    assert qd == pytest.approx(1.5 * np.pi / 2 * np.sin(np.pi * t / 2), abs=1e-14)
    assert qdd == pytest.approx(1.5 * (np.pi / 2) ** 2 * np.cos(np.pi * t / 2), abs=1e-14)


@pytest.mark.parametrize("cruise", [Rational(11, 10), Rational(3, 2), Integer(2)])
@pytest.mark.parametrize("way", [pi / 2, Integer(-3)])
def test_a_trapezoid_reaches_its_speed_and_its_end(cruise: object, way: object) -> None:
    speed = cruise * abs(way) / 3
    pieces = trapezoid(ZERO, Integer(3), Integer(1), 1 + way, speed)
    assert len(pieces) == (2 if cruise == 2 else 3)
    assert (abs(peak(pieces, 1).value) - speed).simplify() == 0
    q, qd, qdd = one_joint(pieces, Integer(3))(np.linspace(0, 3, 3001))
    assert q[-1, 0] == pytest.approx(float(1 + way), abs=1e-15)
    assert qd[-1, 0] == 0
    assert np.trapezoid(qd[:, 0], dx=1e-3) == pytest.approx(float(way), rel=1e-6)
    assert np.unique(np.round(np.abs(qdd), 9)).size == len(set(map(abs, np.round(qdd[[0, 1500], 0], 9))))


def test_a_joint_that_does_not_move_stands_and_velocities_at_via_points_are_means() -> None:
    (piece,) = trapezoid(ZERO, Integer(3), Integer(1), Integer(1), ZERO)
    assert peak((piece,), 1).value == 0
    times = [Integer(t) for t in (0, 1, 3, 4)]
    assert via_velocities(times, [ZERO, Integer(2), Integer(4), Integer(1)]) == (0, Rational(3, 2), 0, 0)


def test_the_spline_is_scipys_clamped_one_and_exact() -> None:
    times, positions = [0, 1, 3, Rational(7, 2)], [Integer(0), pi / 2, Integer(1), sqrt(2)]
    pieces = spline([Integer(0) + t for t in times], positions)
    theirs = CubicSpline([float(t) for t in times], [float(p) for p in positions], bc_type="clamped")
    t = np.linspace(0, 3.5, 71)
    ours = Trajectory(tuple(Segment("", piece.start, piece.duration, ((piece,),)) for piece in pieces))(t)
    for order in range(3):
        assert ours[order][:, 0] == pytest.approx(theirs(t, order), abs=1e-12)
    bends = [(piece.in_unit_time().diff().diff(), piece.duration**2) for piece in pieces]
    for (before, t), (after, s) in pairwise(bends):
        assert (before.eval(1) / t - after.eval(0) / s).simplify() == 0


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


def test_short_ways_keep_their_digits() -> None:
    """From 1 to 1 + 1e-9 in a hundredth of a second: the way is a difference of positions, not of products of them."""
    numbers = np.array([1.0, 0.0, 0.0, 1.0 + 2.0**-30, 0.0, 0.0])
    u = np.linspace(0, 1, 11)
    wanted = 2.0**-30 * (60 * u - 180 * u**2 + 120 * u**3) / 0.01**2
    found = sampled(np.tile(numbers, (11, 1)), 3, u, np.full(11, 0.01), 2)
    assert found == pytest.approx(wanted, rel=1e-12, abs=1e-16)
    powers = np.poly1d(power_coefficients(numbers, 3, 0.01)).deriv(2)(u) / 0.01**2
    assert powers == pytest.approx(wanted, rel=1e-12, abs=1e-16)

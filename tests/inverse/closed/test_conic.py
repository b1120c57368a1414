"""Where a conic meets the unit circle."""

from __future__ import annotations

import numpy as np
import pytest

from derive.inverse.closed.conic import line_points
from derive.inverse.closed.fields import FloatField

Array = np.ndarray


def conics_through(angles: Array, random: np.random.Generator) -> list[Array]:
    """Coefficients of a conic through four points of the circle each: two chords, and any multiple of the circle."""
    first, second = (
        [np.cos(0.5 * (a + b)), np.sin(0.5 * (a + b)), -np.cos(0.5 * (a - b))] for a, b in (angles[:2], angles[2:])
    )
    product = np.einsum("i...,j...->ij...", first, second)
    product = product + np.swapaxes(product, 0, 1)
    of_circle = random.normal(size=angles.shape[1])
    diagonal = [product[0, 0] / 2 + of_circle, product[1, 1] / 2 + of_circle, product[2, 2] / 2 - of_circle]
    return [diagonal[0], product[0, 1], diagonal[1], product[0, 2], product[1, 2], diagonal[2]]


def points(coefficients: list[Array]) -> tuple[Array, Array]:
    """Angles of the four points, not a number where there is none, and which are double."""
    found = line_points(FloatField({}), coefficients)
    angles = [np.where(exists, np.arctan2(sine, cosine), np.nan) for cosine, sine, exists, *_ in found]
    return np.array(angles), np.array([double for *_, double, _ in found])


def worst(angles: Array, wanted: Array) -> Array:
    """How far each wanted point is from the nearest that was found, the largest of each conic."""
    apart = np.abs(np.angle(np.exp(1j * (angles[:, None] - wanted[None]))))
    return np.asarray(np.where(np.isnan(apart), np.inf, apart).min(axis=0).max(axis=0))


@pytest.mark.parametrize(("gap", "error"), [(1.0, 1e-11), (1e-3, 1e-10), (0.0, 1e-11)])
def test_two_points_that_are_close_are_as_exact_as_others(gap: float, error: float) -> None:
    random = np.random.default_rng(3)
    a = random.uniform(-3, 3, 500)
    for order in ((0, 1, 2, 3), (0, 2, 1, 3)):
        wanted = np.array([a, a + gap, a + 1.9, a - 1.7])
        angles, double = points(conics_through(wanted[list(order)], random))
        assert worst(angles, wanted).max() < error
        assert double.any(axis=0).all() == (gap == 0)
        assert (np.isfinite(angles).sum(axis=0) == (3 if gap == 0 else 4)).all()


def test_four_right_angles_are_found_wherever_the_lines_are() -> None:
    wanted = np.array([0.0, 0.5, 1.0, -0.5])[:, None] * np.pi
    for order in ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2)):
        angles, _ = points(conics_through(wanted[list(order)], np.random.default_rng(1)))
        assert worst(angles, wanted).max() < 1e-14


def test_random_conics_have_as_many_points_as_their_quartics_have_real_roots() -> None:
    cc, cs, ss, c, s, one = coefficients = list(np.random.default_rng(5).normal(size=(6, 400)))
    ascending = np.array([cc + c + one, 2 * (cs + s), 2 * (one - cc) + 4 * ss, 2 * (s - cs), cc - c + one])
    numbers = [int((abs(np.roots(row[::-1]).imag) < 1e-9).sum()) for row in ascending.T]
    angles, _ = points(coefficients)
    assert np.isfinite(angles).sum(axis=0).tolist() == numbers
    assert set(numbers) == {0, 2, 4}
    x, y = np.cos(angles), np.sin(angles)
    assert np.nanmax(abs(cc * x * x + cs * x * y + ss * y * y + c * x + s * y + one)) < 1e-14


def test_where_four_points_are_one_rounding_is_said_to_decide() -> None:
    touching = [np.array([x]) for x in (2.0, 0.0, 1.0, -2.0, 0.0, 0.0)]  # c^2 + s^2 - 1 + (c - 1)^2
    found = line_points(FloatField({}), touching)
    assert all(np.all(doubt) for *_, doubt in found)
    apart = [np.array([x]) for x in (1.0, 0.0, -1.0, 0.0, 0.0, 0.0)]
    assert not any(np.any(doubt) for *_, doubt in line_points(FloatField({}), apart))

"""Views and faces: an orthographic projection keeps what it must, and hides what is behind."""

import math

import numpy as np
import pytest

from derive.handouts.figure.projection import AZIMUTHS, ELEVATIONS, View, best_view, paint
from derive.handouts.figure.solids import LINK, Faces, prism

VIEWS = [View(a, e, up) for a in (-2.0, 0.3) for e in (0.1, 1.2) for up in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0))]


@pytest.mark.parametrize("view", VIEWS)
def test_lengths_along_the_page_are_kept_and_up_points_up(view: View) -> None:
    right, upwards, toward = view.rows
    assert view.flat(3.0 * right) == pytest.approx((3.0, 0.0), abs=1e-12)
    assert view.flat(2.0 * upwards) == pytest.approx((0.0, 2.0), abs=1e-12)
    assert view.flat(toward) == pytest.approx((0.0, 0.0), abs=1e-12)
    x, y = view.flat(np.array(view.up))
    assert x == pytest.approx(0.0, abs=1e-12)
    assert y == pytest.approx(math.cos(view.elevation))


@pytest.mark.parametrize("view", VIEWS)
def test_faces_seen_from_behind_are_left_out_and_near_ones_come_last(view: View) -> None:
    box = prism(np.zeros(3), np.array((0.0, 0.0, 2.0)), 1.0, LINK, sides=4)
    assert 1 <= len(list(paint(box, view))) <= 3
    _, _, toward = view.rows
    square = np.stack([view.rows[0], view.rows[1], -view.rows[0]])
    far = Faces((square - toward)[None], None, (0.2, 0.2, 0.2))
    near = Faces((square + toward)[None], None, (0.8, 0.8, 0.8))
    assert [path.fill for path in paint([near, far], view)] == [far.color, near.color]


def test_the_best_view_does_not_look_along_the_only_link() -> None:
    for axis in np.eye(3):
        ends = np.stack([np.zeros(3), axis])
        view = best_view(ends, [np.eye(3)], [ends], (0.0, 0.0, 1.0))
        assert round(math.degrees(view.azimuth)) in AZIMUTHS
        assert round(math.degrees(view.elevation)) in ELEVATIONS
        assert np.hypot(*view.flat(axis)) > 0.5

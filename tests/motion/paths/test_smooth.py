"""Paths q(s), and the times and ends of a motion along one."""

from __future__ import annotations

import numpy as np
import pytest
from sympy import Float, Integer, pi

from derive.motion.paths.smooth import INTERVALS, UNIFORM, Nodes, grid_of, one_second, smooth_path

scipy = pytest.importorskip("scipy.interpolate")


def test_the_path_between_two_points_is_straight_and_through_more_it_is_scipys_natural_spline() -> None:
    path = smooth_path(np.array([0.0, 1.0]), np.array([[1.0, 2.0], [3.0, -1.0]]))
    q, slope, bend = path(np.linspace(0, 1, 11))
    assert q == pytest.approx(np.linspace([1, 2], [3, -1], 11), abs=1e-15)
    assert slope == pytest.approx(np.tile([2.0, -3.0], (11, 1)), abs=1e-14)
    assert np.abs(bend).max() < 1e-13
    knots, corners = np.array([0, 0.2, 0.7, 1]), np.array([[0.0, 1], [2, 1], [-1, 1], [3, 1]])
    path, s = smooth_path(knots, corners), np.linspace(0, 1, 101)
    theirs = scipy.CubicSpline(knots, corners, bc_type="natural")
    for order in range(3):
        assert path(s)[order] == pytest.approx(theirs(s, order), abs=1e-11)


def test_a_grid_has_the_knots_and_the_places_where_a_joint_turns_back() -> None:
    knots, corners = np.array([0, 0.5, 1]), np.array([[0.0, 0], [1, 1], [0, 2]])
    path = smooth_path(knots, corners + np.array([[0, 0], [0.2, 0], [0.1, 0]]))
    grid = grid_of(path, knots)
    assert (np.diff(grid) > 0).all()
    assert {0.0, 0.5, 1.0} <= set(grid.tolist())
    assert abs(len(grid) - 2 * INTERVALS - 1) <= 2
    turn = grid[np.abs(path(grid)[1][:, 0]).argmin()]
    assert abs(path(float(turn))[1][0]) < 1e-12
    assert turn != 0.5


def test_s_goes_uniformly() -> None:
    assert UNIFORM(np.array([0.0, 0.25, 1.0]))[0][:, 0].tolist() == [0, 0.25, 1]
    assert UNIFORM(np.array([0.5]))[1].tolist() == [[1.0]]


@pytest.fixture
def nodes() -> Nodes:
    random = np.random.default_rng(3)
    ends = random.normal(size=(4, 2, 3, 2))
    ends[1:, 0, 0], ends[..., 1:, 1] = ends[:-1, 1, 0], 0
    ends[..., 0, 1] = 5
    return Nodes(np.array([0, 0.5, 0.7, 1.5, 2]), ends)


def test_pieces_are_what_the_nodes_say_and_slower_is_the_same_way_in_more_time(nodes: Nodes) -> None:
    first, second = nodes.pieces(1, 4, {4: (pi, Integer(5))})
    assert len(first) == 3
    assert first[-1].values[1][0] == pi  # type: ignore[union-attr]
    assert len(second) == 1
    assert second[0].values[1] == (Float(5), 0, 0)  # type: ignore[union-attr]
    whole = one_second(nodes.pieces(0, 4, {}))
    for place in (0.1, 0.8):
        times = nodes.times[:-1] + place * np.diff(nodes.times)
        for found, expected in zip(whole(times), nodes.inside(np.array([place])), strict=True):
            assert found == pytest.approx(expected[:, 0], rel=1e-9, abs=1e-9)
    u = np.linspace(0, 1, 5)
    fast, slow = nodes.inside(u), nodes.slower(3).inside(u)
    for order in range(3):
        assert slow[order] == pytest.approx(fast[order] / 3**order, abs=1e-12)
    assert nodes.slower(3).times[-1] == 6

"""Rotations, lines and arcs."""

from __future__ import annotations

import numpy as np
import pytest

from derive.motion.paths.poses import Way, rotation_of, rotation_vector


def pose(seed: int) -> np.ndarray:
    random, found = np.random.default_rng(seed), np.eye(4)
    found[:3, :3], found[:3, 3] = rotation_of(random.normal(size=3)), random.normal(size=3)
    return found


@pytest.mark.parametrize("angle", [0, 1e-12, 1e-7, 1e-3, 1, 3, np.pi - 1e-7, np.pi])
def test_a_rotation_is_that_of_its_vector(angle: float) -> None:
    for seed in range(5):
        axis = np.random.default_rng(seed).normal(size=3)
        rotation = rotation_of(angle * axis / np.linalg.norm(axis))
        assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-14)
        assert np.linalg.norm(rotation_vector(rotation)) == pytest.approx(angle, abs=1e-7)
        assert rotation_of(rotation_vector(rotation)) == pytest.approx(rotation, abs=2e-7 if angle > 3.1 else 1e-14)


def test_a_line_goes_straight_from_pose_to_pose() -> None:
    a, b = pose(1), pose(2)
    way = Way.line(a, b)
    assert way.pose(0) == pytest.approx(a, abs=1e-14)
    assert way.pose(1) == pytest.approx(b, abs=1e-14)
    direction = b[:3, 3] - a[:3, 3]
    for s in (0.2, 0.7):
        assert np.linalg.norm(np.cross(way.pose(s)[:3, 3] - a[:3, 3], direction)) < 1e-14


def test_an_arc_goes_through_three_positions_on_a_circle() -> None:
    a, middle, b = pose(3), pose(4), pose(5)
    way = Way.arc(a, middle, b)
    assert way.pose(0) == pytest.approx(a, abs=1e-13)
    assert way.pose(1) == pytest.approx(b, abs=1e-13)
    places = np.array([way.place(s)[0] for s in np.linspace(0, 1, 20001)])
    assert np.linalg.norm(places - middle[:3, 3], axis=1).min() < 1e-3
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert lengths.max() == pytest.approx(lengths.min(), rel=1e-8)


def test_derivatives_of_an_arc_are_those_of_its_place() -> None:
    way, h = Way.arc(pose(3), pose(4), pose(5)), 1e-4
    for s in (0.1, 0.6):
        before, here, after = (way.place(s + d)[0] for d in (-h, 0, h))
        _, tangent, bend = way.place(s)
        assert tangent == pytest.approx((after - before) / (2 * h), rel=1e-5, abs=1e-6)
        assert bend == pytest.approx((after - 2 * here + before) / h**2, rel=1e-4, abs=1e-4)


def test_three_positions_on_one_line_are_no_arc() -> None:
    a, b, middle = pose(1), pose(2), pose(1)
    middle[:3, 3] = (a[:3, 3] + b[:3, 3]) / 2
    with pytest.raises(ValueError, match="on one line"):
        Way.arc(a, middle, b)

"""Critical curves: the exact factors of the determinant, and circles through the nearest and farthest places."""

from __future__ import annotations

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.workspace.critical import boundary_candidates, folds
from derive.workspace.point import Picture
from tests.workspace.arms import CUSPIDAL, HOLED, LIMITED, arm, plane


def test_an_elbow_and_a_shoulder_are_the_two_factors_of_an_anthropomorphic_arm() -> None:
    factors, exact = folds(plane(Robot.load("anthropomorphic-arm"), Picture.SECTION))
    assert exact
    u, v = np.array([0.3, 1.2, -2.0]), np.zeros(3)
    shoulder = np.arctan2(1.0 + 0.8 * np.cos(u), 0.8 * np.sin(u))  # a2 c2 + a3 c23 = 0 with q3 = u
    at_elbow = [np.abs(factor(u, v)).max() for factor in factors]
    at_shoulder = [np.abs(factor(shoulder, u)).max() for factor in factors]
    assert sorted(value < 1e-12 for value in at_elbow) == [False, True]
    assert [a < 1e-12 for a in at_shoulder] == [b >= 1e-12 for b in at_elbow]


@pytest.mark.parametrize("name", ["puma560-corke", "anthropomorphic-arm", "scara-sankyo"])
def test_the_factors_multiply_to_what_the_map_does(name: str) -> None:
    seen = plane(Robot.load(name), Picture.SECTION)
    factors, exact = folds(seen)
    assert exact
    q = seen.point.random(400, seen.joints)
    (rho, _), (first, second) = seen.values(q)
    determinant = rho * (first[0] * second[1] - first[1] * second[0])
    product = np.prod([factor(q[0], q[1]) for factor in factors], axis=0)
    ratio = determinant / product
    assert np.ptp(np.abs(ratio)) <= 1e-6 * np.abs(ratio).max()


def test_candidates_lie_where_the_map_folds_or_a_limit_is() -> None:
    seen = plane(arm(CUSPIDAL), Picture.SECTION)
    ends = boundary_candidates(seen, 200).reshape(-1, 2).T
    many = seen.values(seen.point.random(20_000, seen.joints))[0]
    assert ends[0].max() == pytest.approx(many[0].max(), abs=5e-3)
    assert ends[0].min() >= -1e-2  # but for the crosses that close gaps
    assert len(np.unique(np.round(ends, 12), axis=1).T) > 100


def test_circles_of_a_planar_arm_are_its_hole_and_its_reach() -> None:
    radii = np.hypot(*boundary_candidates(plane(arm(HOLED), Picture.TOP), 200).reshape(-1, 2).T)
    on_circle = [np.abs(radii - wanted) < 1e-4 for wanted in (0.2, 1.8)]
    assert np.all(on_circle[0] | on_circle[1])
    assert all(part.any() for part in on_circle)


def test_limits_of_the_first_joint_turn_the_curves_of_the_others() -> None:
    ends = boundary_candidates(plane(arm(LIMITED), Picture.TOP), 50).reshape(-1, 2)
    for q1 in (0.0, np.pi / 2):
        place = np.array([np.cos(q1) + 0.5 * np.cos(q1 + 2.0), np.sin(q1) + 0.5 * np.sin(q1 + 2.0)])
        assert np.hypot(*(ends - place).T).min() <= 1e-9

"""Positions of the end effector, and critical configurations."""

import numpy as np
import pytest

from derive.workspace.critical import boundary_candidates, folds
from derive.workspace.point import Picture, PlaneMap
from tests.workspace.arms import plane, point


def test_an_elbow_and_a_shoulder_are_the_two_factors_of_an_anthropomorphic_arm() -> None:
    factors, exact = folds(plane("anthropomorphic-arm", Picture.SECTION))
    assert exact
    u, v = np.array([0.3, 1.2, -2.0]), np.zeros(3)
    shoulder = np.arctan2(1.0 + 0.8 * np.cos(u), 0.8 * np.sin(u))  # a2 c2 + a3 c23 = 0 with q3 = u
    at_elbow = [np.abs(factor(u, v)).max() for factor in factors]
    at_shoulder = [np.abs(factor(shoulder, u)).max() for factor in factors]
    assert sorted(value < 1e-12 for value in at_elbow) == [False, True]
    assert [a < 1e-12 for a in at_shoulder] == [b >= 1e-12 for b in at_elbow]


@pytest.mark.parametrize("name", ["puma560-corke", "anthropomorphic-arm", "scara-sankyo"])
def test_the_factors_multiply_to_what_the_map_does(name: str) -> None:
    seen = plane(name, Picture.SECTION)
    factors, exact = folds(seen)
    assert exact
    q = seen.point.random(400, seen.joints)
    (rho, _), (first, second) = seen.values(q)
    determinant = rho * (first[0] * second[1] - first[1] * second[0])
    product = np.prod([factor(q[0], q[1]) for factor in factors], axis=0)
    ratio = determinant / product
    assert np.ptp(np.abs(ratio)) <= 1e-6 * np.abs(ratio).max()


def test_candidates_lie_where_the_map_folds_or_a_limit_is() -> None:
    seen = plane("cuspidal", Picture.SECTION)
    ends = boundary_candidates(seen, 200).reshape(-1, 2).T
    many = seen.values(seen.point.random(20_000, seen.joints))[0]
    assert ends[0].max() == pytest.approx(many[0].max(), abs=5e-3)
    assert ends[0].min() >= -1e-2  # but for the crosses that close gaps
    assert len(np.unique(np.round(ends, 12), axis=1).T) > 100


def test_curves_of_planar_arms_are_their_circles_turned_by_the_limits_of_the_first_joint() -> None:
    radii = np.hypot(*boundary_candidates(plane("holed", Picture.TOP), 200).reshape(-1, 2).T)
    on_circle = [np.abs(radii - wanted) < 1e-4 for wanted in (0.2, 1.8)]
    assert np.all(on_circle[0] | on_circle[1])
    assert all(part.any() for part in on_circle)
    ends = boundary_candidates(plane("limited", Picture.TOP), 50).reshape(-1, 2)
    for q1 in (0.0, np.pi / 2):
        place = np.array([np.cos(q1) + 0.5 * np.cos(q1 + 2.0), np.sin(q1) + 0.5 * np.sin(q1 + 2.0)])
        assert np.hypot(*(ends - place).T).min() <= 1e-9


@pytest.mark.parametrize("name", ["puma560-usp", "stanford-laschi", "skeleton-root", "scara-bajd"])
@pytest.mark.parametrize("picture", Picture)
def test_derivatives_are_those_of_the_positions(name: str, picture: Picture) -> None:
    seen = plane(name, picture)
    q = seen.point.random(20, seen.joints, seed=1)
    slopes = seen.values(q)[1]
    for row in range(len(seen.joints)):
        step = np.zeros_like(q)
        step[row] = 1e-6
        measured = (seen.values(q + step)[0] - seen.values(q - step)[0]) / 2e-6
        assert np.abs(measured - slopes[:, row]).max() <= 1e-7 * seen.point.size


@pytest.mark.parametrize("name", ["kuka-lwr4", "stanford-laschi", "dh-modified-deluca", "human-body"])
def test_positions_are_those_of_the_frames(name: str) -> None:
    """From the tool inwards, vector by vector, and from the base outwards, frame by frame."""
    own = point(name, (0.1, -0.2, 0.3))
    joints = tuple(range(len(own.ranges)))
    q = own.random(10, joints, seed=2)
    seen = PlaneMap(own, Picture.SPACE, joints)
    rotation, origin = own.axis
    for place, configuration in zip(seen.places(q).T, q.T, strict=True):
        end = np.array(own.poses.frames([float(value) for value in configuration])[-1])
        expected = rotation.T @ ((end @ (0.1, -0.2, 0.3, 1.0))[:3] - origin)
        assert np.abs(place - expected).max() <= 1e-12 * own.size
    assert np.abs(seen.places(q) - seen.values(q)[0]).max() <= 1e-12 * own.size


def test_the_first_joint_that_turns_is_the_axis_and_a_turn_about_it_changes_no_section() -> None:
    assert [point(name).turn for name in ("limited", "cylindrical", "skeleton-root", "gantry")] == [0, 1, None, None]
    own = point("kuka-kr5")
    section = PlaneMap(own, Picture.SECTION, own.moving)
    q = own.random(30, own.moving)
    turned = q.copy()
    turned[0] += 1.3
    assert np.abs(section.values(q)[0] - section.values(turned)[0]).max() <= 1e-12


def test_joints_that_do_not_move_the_point_are_left_out_and_ranges_that_are_not_given_marked() -> None:
    assert point("scara-perugia").moving == (0, 1, 2)
    assert plane("scara-perugia", Picture.TOP).joints == (0, 1)
    assert plane("scara-perugia", Picture.SECTION).joints == (1, 2)
    ranges = point("R a: 2, limits: [0, 1] | P").ranges
    assert [(way.lower, way.upper, way.assumed) for way in ranges] == [(0.0, 1.0, False), (0.0, 2.0, True)]
    assert ranges[1].interval == "from 0 to 2 m"


def test_the_nearest_configuration_is_within_the_limits_and_nearest() -> None:
    seen = plane("limited", Picture.TOP)
    targets = np.array([[2.0, 0.3, 0.0], [0.0, 1.0, 0.2]])
    starts = np.repeat(seen.inside(np.array([[0.5], [1.0]])), 3, axis=1)
    q, places, distances = seen.nearest(targets, starts)
    low, high = seen.box
    assert np.all((q >= low) & (q <= high))
    many = seen.values(seen.point.random(40_000, seen.joints))[0]
    best = [np.hypot(*(many - target[:, None])).min() for target in targets.T]
    assert np.hypot(*(targets - places)) == pytest.approx(distances)
    assert np.all(distances <= np.array(best) + 1e-9)
    assert distances == pytest.approx(best, abs=0.01)

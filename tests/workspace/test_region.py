"""Areas from critical curves are the closed forms, and hands make them larger and smaller as spheres do."""

from __future__ import annotations

import math

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.workspace.point import Picture
from derive.workspace.region import (
    Area,
    Measure,
    dexterous,
    enclosing,
    enlarged,
    exact_area,
    is_reached,
)
from tests.workspace.arms import (
    CLOSED,
    CORNERED,
    CUSPIDAL,
    CYLINDRICAL,
    EDGEWISE,
    HOLED,
    LIMITED,
    STRAIGHT,
    TUBE,
    arm,
    plane,
)

shapely = pytest.importorskip("shapely")

SWEPT = math.pi / 4 * (2 * 0.5 * (math.cos(math.pi / 6) - math.cos(2.0)))
"""A quarter turn of the radii from |q2| = 2 to pi/6, r^2 = a1^2 + a2^2 + 2 a1 a2 cos q2."""

CLOSED_FORMS = {
    "annulus": (HOLED, Picture.TOP, math.pi * (1.8**2 - 0.2**2)),
    "limits": (LIMITED, Picture.TOP, SWEPT),
    "cylinder": (CYLINDRICAL, Picture.SECTION, 0.8 * 0.6),
    "sector": (CYLINDRICAL, Picture.TOP, 1.5 * (0.9**2 - 0.3**2)),
}


def assert_measured(measure: Measure, wanted: float) -> None:
    """A measure is right within the error that it states, which is small."""
    assert measure.error <= 2e-2 * wanted
    assert abs(measure.value - wanted) <= measure.error + 1e-9


@pytest.mark.parametrize("case", CLOSED_FORMS.values(), ids=CLOSED_FORMS.keys())
def test_areas_are_the_closed_forms_within_their_error(case: tuple[str, Picture, float]) -> None:
    joints, picture, wanted = case
    assert_measured(exact_area(plane(arm(joints), picture), 60).size, wanted)


def test_a_curve_that_closes_covers_nothing() -> None:
    assert exact_area(plane(arm(CLOSED), Picture.SECTION), 60).region.is_empty


@pytest.mark.parametrize("cells", [50, 100, 150])
def test_straight_curves_that_run_back_bound_an_area_too(cells: int) -> None:
    """However many cells: its places lie within the limits of joint 1 and what the others turn beyond them."""
    region = exact_area(plane(arm(STRAIGHT), Picture.TOP), cells).region
    assert region.area == pytest.approx(0.5687, rel=2e-3)
    assert region.bounds[3] < 0.0


def test_an_arm_that_is_seen_from_its_edge_is_as_wide_as_joint_1_turns() -> None:
    assert exact_area(plane(arm(EDGEWISE), Picture.TOP), 60).size.value == pytest.approx(5.1156, rel=2e-3)


def test_the_hole_around_a_base_is_round() -> None:
    ring = shapely.get_parts(exact_area(plane(arm(HOLED), Picture.TOP), 60).region)[0].interiors[0]
    radii = np.hypot(*np.asarray(ring.coords).T)
    assert np.abs(radii - 0.2).max() <= 5e-4


def test_a_ring_that_is_not_reached_inside_of_a_torus_is_left_out() -> None:
    area = exact_area(plane(arm(TUBE), Picture.SECTION), 60)
    assert [len(part.interiors) for part in shapely.get_parts(area.region)] == [1]
    assert_measured(area.volume, 2.0 * math.pi * 2.0 * math.pi * (1.4**2 - 0.6**2))


def test_volumes_of_spheres_and_cylinders_are_the_closed_forms() -> None:
    sphere = exact_area(plane(Robot.load("anthropomorphic-arm"), Picture.SECTION), 40)
    assert_measured(sphere.volume, 4.0 / 3.0 * math.pi * (1.8**3 - 0.2**3))
    ring = exact_area(plane(Robot.load("spherical-arm"), Picture.SECTION), 40)  # a ball with a bore of radius d2
    assert_measured(ring.volume, 4.0 / 3.0 * math.pi)


@pytest.mark.sweep
def test_cells_that_are_reached_by_few_configurations_are_kept() -> None:
    seen = plane(arm(CORNERED), Picture.TOP)
    x, y = seen.values(seen.point.random(150_000, seen.joints, seed=11))[0]
    region = exact_area(seen, 80).region
    outside = ~shapely.contains_xy(region, x, y)
    assert shapely.distance(region, shapely.points(x[outside], y[outside])).max(initial=0.0) <= 5e-3


def test_every_pose_of_an_arm_with_cusps_lies_inside_and_every_cell_inside_is_reached() -> None:
    seen = plane(arm(CUSPIDAL), Picture.SECTION)
    area = exact_area(seen, 80)
    x, y = seen.values(seen.point.random(100_000, seen.joints, seed=7))[0]
    outside = ~shapely.contains_xy(area.region, x, y)
    away = shapely.distance(area.region, shapely.points(x[outside], y[outside]))
    assert away.max(initial=0.0) <= 5e-3
    left, low, right, high = area.region.bounds
    across, up = (grid.ravel() for grid in np.meshgrid(np.linspace(left, right, 15), np.linspace(low, high, 15)))
    inner = shapely.contains_xy(area.region.buffer(-5e-3), across, up)
    assert inner.sum() > 60
    assert is_reached(seen, np.stack([across[inner], up[inner]])).all()
    outer = ~shapely.contains_xy(area.region.buffer(5e-3), across, up) & (across > 0.0)
    assert outer.sum() > 15
    assert not is_reached(seen, np.stack([across[outer], up[outer]])).any()


def test_a_hand_shrinks_the_outside_and_grows_the_hole_unless_it_is_longer() -> None:
    ring = shapely.Point(0, 0).buffer(2, 256).difference(shapely.Point(0, 0).buffer(0.2, 256))
    small, long = dexterous(ring, 0.1, False), dexterous(ring, 0.6, False)
    assert small.area == pytest.approx(math.pi * (1.9**2 - 0.3**2), rel=1e-3)
    assert long.area == pytest.approx(math.pi * (1.4**2 - 0.8**2 + 0.4**2), rel=1e-3)
    half = ring.intersection(shapely.box(0, -9, 9, 9))
    assert dexterous(half, 0.6, True).area == pytest.approx(long.area / 2, rel=1e-3)
    assert enlarged(half, 0.1, True).area == pytest.approx(math.pi * (2.1**2 - 0.1**2) / 2, rel=1e-3)


def test_circles_that_hold_all_of_an_area_are_centred_near_it() -> None:
    disc = shapely.Point(1, 2).buffer(0.5, 64)
    assert enclosing(disc, 0.4).is_empty
    held = enclosing(disc, 0.8)
    assert held.centroid.distance(shapely.Point(1, 2)) <= 1e-9
    assert held.area == pytest.approx(math.pi * 0.3**2, rel=1e-2)


def test_the_error_of_an_area_is_the_difference_of_its_two_approximations() -> None:
    area = Area(shapely.Point(0, 0).buffer(1, 32), shapely.Point(0, 0).buffer(1, 16))
    assert abs(area.size.value - math.pi) < 0.01 * area.size.error
    assert Measure.of(2.0, 1.7).error == pytest.approx(0.3)

"""Outlines and areas of workspaces."""

from __future__ import annotations

import math

import numpy as np
import pytest

from derive.workspace.point import Picture
from derive.workspace.refinement import refined_area
from derive.workspace.region import Area, Measure, dexterous, enclosing, enlarged, exact_area, is_reached
from tests.random_robots import swept
from tests.workspace.arms import limited_joints, plane

shapely = pytest.importorskip("shapely")

SWEPT = math.pi / 4 * (2 * 0.5 * (math.cos(math.pi / 6) - math.cos(2.0)))
"""A quarter turn of the radii from |q2| = 2 to pi/6, r^2 = a1^2 + a2^2 + 2 a1 a2 cos q2."""

CLOSED_FORMS = [
    ("holed", Picture.TOP, math.pi * (1.8**2 - 0.2**2)),
    ("limited", Picture.TOP, SWEPT),
    ("cylindrical", Picture.SECTION, 0.8 * 0.6),
    ("cylindrical", Picture.TOP, 1.5 * (0.9**2 - 0.3**2)),
]


def assert_measured(measure: Measure, wanted: float) -> None:
    """A measure is right within the error that it states, which is small."""
    assert measure.error <= 2e-2 * wanted
    assert abs(measure.value - wanted) <= measure.error + 1e-9


@pytest.mark.parametrize(("joints", "picture", "wanted"), CLOSED_FORMS)
def test_areas_are_the_closed_forms_within_their_error(joints: str, picture: Picture, wanted: float) -> None:
    assert_measured(exact_area(plane(joints, picture), 60).size, wanted)


def test_curves_that_close_cover_nothing_and_an_edge_is_as_wide_as_joint_1_turns() -> None:
    assert exact_area(plane("closed", Picture.SECTION), 60).region.is_empty
    assert exact_area(plane("edgewise", Picture.TOP), 60).size.value == pytest.approx(5.1156, rel=2e-3)


@pytest.mark.parametrize("cells", [100, *swept(50, 150)])
def test_straight_curves_that_run_back_bound_an_area_too(cells: int) -> None:
    """However many cells: its places lie within the limits of joint 1 and what the others turn beyond them."""
    region = exact_area(plane("straight", Picture.TOP), cells).region
    assert region.area == pytest.approx(0.5687, rel=2e-3)
    assert region.bounds[3] < 0.0


def test_the_hole_around_a_base_is_round_and_a_ring_inside_of_a_torus_left_out() -> None:
    ring = shapely.get_parts(exact_area(plane("holed", Picture.TOP), 60).region)[0].interiors[0]
    radii = np.hypot(*np.asarray(ring.coords).T)
    assert np.abs(radii - 0.2).max() <= 5e-4
    area = exact_area(plane("tube", Picture.SECTION), 60)
    assert [len(part.interiors) for part in shapely.get_parts(area.region)] == [1]
    assert_measured(area.volume, 2.0 * math.pi * 2.0 * math.pi * (1.4**2 - 0.6**2))


def test_volumes_of_spheres_and_cylinders_are_the_closed_forms() -> None:
    sphere = exact_area(plane("anthropomorphic-arm", Picture.SECTION), 40)
    assert_measured(sphere.volume, 4.0 / 3.0 * math.pi * (1.8**3 - 0.2**3))
    ring = exact_area(plane("spherical-arm", Picture.SECTION), 40)  # a ball with a bore of radius d2
    assert_measured(ring.volume, 4.0 / 3.0 * math.pi)


@pytest.mark.sweep
def test_cells_that_are_reached_by_few_configurations_are_kept() -> None:
    seen = plane("cornered", Picture.TOP)
    x, y = seen.values(seen.point.random(150_000, seen.joints, seed=11))[0]
    region = exact_area(seen, 80).region
    outside = ~shapely.contains_xy(region, x, y)
    assert shapely.distance(region, shapely.points(x[outside], y[outside])).max(initial=0.0) <= 5e-3


def test_every_pose_of_an_arm_with_cusps_lies_inside_and_every_cell_inside_is_reached() -> None:
    seen = plane("cuspidal", Picture.SECTION)
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


def test_circles_that_hold_an_area_are_centred_near_it_and_its_error_is_the_difference_of_two_approximations() -> None:
    disc = shapely.Point(1, 2).buffer(0.5, 64)
    assert enclosing(disc, 0.4).is_empty
    held = enclosing(disc, 0.8)
    assert held.centroid.distance(shapely.Point(1, 2)) <= 1e-9
    assert held.area == pytest.approx(math.pi * 0.3**2, rel=1e-2)
    area = Area(shapely.Point(0, 0).buffer(1, 32), shapely.Point(0, 0).buffer(1, 16))
    assert abs(area.size.value - math.pi) < 0.01 * area.size.error
    assert Measure.of(2.0, 1.7).error == pytest.approx(0.3)


pytest.importorskip("contourpy")


@pytest.mark.parametrize(("joints", "picture"), [("limited", Picture.TOP), ("tube", Picture.SECTION)])
def test_two_ways_to_the_same_area_agree(joints: str, picture: Picture) -> None:
    seen = plane(joints, picture)
    followed, exact = refined_area(seen, 40), exact_area(seen, 60)
    assert followed.region.hausdorff_distance(exact.region) <= 0.03 * seen.point.size
    assert followed.size.value == pytest.approx(exact.size.value, rel=5e-3)
    holes = [[len(part.interiors) for part in shapely.get_parts(area.region)] for area in (followed, exact)]
    assert holes[0] == holes[1]


def test_corners_of_a_gantry_are_sharp() -> None:
    seen = plane("gantry", Picture.SIDE)
    area = refined_area(seen, 50)
    left, low, right, high = area.region.bounds
    width, height = np.ptp(seen.values(seen.point.random(5000, seen.joints))[0], axis=1)
    assert (right - left, high - low) == pytest.approx((width, height), rel=0.01)
    assert area.region.area == pytest.approx((right - left) * (high - low), rel=1e-3)


def test_where_one_kind_of_postures_ends_at_a_limit_another_goes_on() -> None:
    """Seen along its axis the arm reaches all of a circle: now with one shoulder, now with the other."""
    seen = plane("puma560-usp", Picture.TOP)
    radii = np.hypot(*np.asarray(refined_area(seen, 60).region.exterior.coords).T)
    values = seen.point.poses.values
    d2, a2, a3, d4, d6 = (float(values[name]) for name in ("d2", "a2", "a3", "d4", "d6"))
    reach = math.hypot(d2, a2 + math.hypot(a3, d4)) + d6
    assert np.abs(radii - reach).max() <= 1e-3 * reach


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(40))
def test_arms_with_limits_have_one_area_in_both_ways(seed: int) -> None:
    seen = plane(limited_joints(np.random.default_rng(seed)), Picture.TOP)
    exact, followed = exact_area(seen, 150), refined_area(seen, 60)
    width = seen.point.size / 60
    assert followed.size.value == pytest.approx(exact.size.value, abs=0.1 * width * exact.region.length)
    for inner, outer in ((exact, followed), (followed, exact)):
        assert inner.region.buffer(-1.5 * width).difference(outer.region).area <= 1e-3 * exact.size.value


@pytest.mark.parametrize(
    ("link", "count", "parts", "least"), [("a: 0.5, limits: [-2, 2]", 4, 30, 0.8), *swept(("a: 1", 10, 12, 0.99))]
)
def test_a_redundant_planar_arm_covers_its_disc(link: str, count: int, parts: int, least: float) -> None:
    """Ten links in a line are as good as never sampled; the search goes on beyond the grid around the samples."""
    reach = count * float(link[3:].split(",")[0])
    joints = ", ".join(f"{{type: revolute, {link}}}" for _ in range(count))
    area = refined_area(plane(f"[{joints}]", Picture.TOP), parts)
    assert area.region.bounds[2] == pytest.approx(reach, abs=5e-4 * reach)
    assert 1.01 * math.pi * reach**2 > area.region.area > least * math.pi * reach**2

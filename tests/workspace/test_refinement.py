"""An area that is followed along its boundary is that of the critical curves."""

from __future__ import annotations

import math

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.workspace.point import Picture
from derive.workspace.refinement import refined_area
from derive.workspace.region import exact_area
from tests.workspace.arms import GANTRY, LIMITED, TUBE, arm, limited_joints, plane

shapely = pytest.importorskip("shapely")
pytest.importorskip("contourpy")


@pytest.mark.parametrize(("joints", "picture"), [(LIMITED, Picture.TOP), (TUBE, Picture.SECTION)])
def test_two_ways_to_the_same_area_agree(joints: str, picture: Picture) -> None:
    seen = plane(arm(joints), picture)
    followed, exact = refined_area(seen, 40), exact_area(seen, 60)
    assert followed.region.hausdorff_distance(exact.region) <= 0.03 * seen.point.size
    assert followed.size.value == pytest.approx(exact.size.value, rel=5e-3)
    holes = [[len(part.interiors) for part in shapely.get_parts(area.region)] for area in (followed, exact)]
    assert holes[0] == holes[1]


def test_corners_of_a_gantry_are_sharp() -> None:
    seen = plane(arm(GANTRY), Picture.SIDE)
    area = refined_area(seen, 50)
    left, low, right, high = area.region.bounds
    width, height = np.ptp(seen.values(seen.point.random(5000, seen.joints))[0], axis=1)
    assert (right - left, high - low) == pytest.approx((width, height), rel=0.01)
    assert area.region.area == pytest.approx((right - left) * (high - low), rel=1e-3)


def test_where_one_kind_of_postures_ends_at_a_limit_another_goes_on() -> None:
    """Seen along its axis the arm reaches all of a circle: now with one shoulder, now with the other."""
    seen = plane(Robot.load("puma560-usp"), Picture.TOP)
    radii = np.hypot(*np.asarray(refined_area(seen, 60).region.exterior.coords).T)
    values = seen.point.poses.values
    d2, a2, a3, d4, d6 = (float(values[name]) for name in ("d2", "a2", "a3", "d4", "d6"))
    reach = math.hypot(d2, a2 + math.hypot(a3, d4)) + d6
    assert np.abs(radii - reach).max() <= 1e-3 * reach


@pytest.mark.sweep
@pytest.mark.parametrize("seed", range(40))
def test_arms_with_limits_have_one_area_in_both_ways(seed: int) -> None:
    seen = plane(arm(limited_joints(np.random.default_rng(seed))), Picture.TOP)
    exact, followed = exact_area(seen, 150), refined_area(seen, 60)
    width = seen.point.size / 60
    assert followed.size.value == pytest.approx(exact.size.value, abs=0.1 * width * exact.region.length)
    for inner, outer in ((exact, followed), (followed, exact)):
        assert inner.region.buffer(-1.5 * width).difference(outer.region).area <= 1e-3 * exact.size.value


def test_a_redundant_planar_arm_covers_its_disc() -> None:
    joints = ", ".join("{type: revolute, a: 0.5, limits: [-2, 2]}" for _ in range(4))
    area = refined_area(plane(arm(f"[{joints}]"), Picture.TOP), 30)
    assert area.region.bounds[2] == pytest.approx(2.0, abs=1e-3)
    assert math.pi * 4.0 > area.region.area > 0.8 * math.pi * 4.0


def test_an_arm_whose_samples_never_stretch_it_covers_its_disc() -> None:
    """Ten links in a line are as good as never sampled; the search goes on beyond the grid around the samples."""
    joints = ", ".join("{type: revolute, a: 1}" for _ in range(10))
    area = refined_area(plane(arm(f"[{joints}]"), Picture.TOP), 12)
    assert area.region.area == pytest.approx(math.pi * 100.0, rel=0.01)

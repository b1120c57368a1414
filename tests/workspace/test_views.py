"""The workspace of a robot: its views, its wrist, what is dexterous, and its plot."""

from __future__ import annotations

import math

import numpy as np
import pytest

from derive.workspace.point import Picture, PlaneMap
from derive.workspace.poses import RobotPoses
from derive.workspace.views import Workspace, find_workspace, find_wrist
from tests.random_robots import swept_catalogue
from tests.workspace.arms import arm, point

shapely = pytest.importorskip("shapely")
pytest.importorskip("matplotlib")


def workspace(name: str) -> Workspace:
    return find_workspace(RobotPoses(arm(name)))


def test_a_complete_wrist_keeps_the_hand_off_the_outside_and_the_hole() -> None:
    # a2 = 1, d4 = 0.8, d6 = 0.6: the hand is longer than the hole
    found = workspace("anthropomorphic-wrist")
    assert [view.picture for view in found.views] == [Picture.SECTION, Picture.TOP]
    section, top = found.views
    assert abs(top.reachable.size.value - math.pi * 2.4**2) <= top.reachable.size.error
    assert section.exact
    assert abs(section.reachable.size.value - math.pi / 2 * 2.4**2) <= section.reachable.size.error
    wanted = math.pi / 2 * (1.2**2 - 0.8**2 + 0.4**2)
    assert abs(section.dexterous.size.value - wanted) <= section.dexterous.size.error
    wanted = 4 / 3 * math.pi * (1.2**3 - 0.8**3 + 0.4**3)
    assert abs(found.dexterous_volume.value - wanted) <= found.dexterous_volume.error


@pytest.mark.parametrize(
    ("name", "hand", "complete", "planar"),
    [
        ("puma560-usp", 0.6, False, False),
        ("stanford-deluca", 0.6, True, False),
        ("spherical-wrist", 1.0, True, False),
        ("scara-perugia", 0.0, True, True),
        ("planar-3r", 0.6, True, True),
    ],
)
def test_wrists_are_found(name: str, hand: float, complete: bool, planar: bool) -> None:
    wrist = find_wrist(point(name))
    assert (wrist.complete, wrist.planar) == (complete, planar)
    assert name.startswith("puma") or wrist.hand == pytest.approx(hand)


def test_a_flat_workspace_has_one_view_and_no_volume() -> None:
    found = workspace("planar-2r-perugia")
    (view,) = found.views
    assert (view.picture, found.volume) == (Picture.TOP, None)
    assert view.dexterous.region.is_empty  # no place is reached in every orientation by two links
    assert [way.variable for way in found.assumed] == ["q1", "q2"]


@pytest.mark.sweep
def test_a_gantry_fills_its_box() -> None:
    found = workspace("gantry")
    assert [view.picture for view in found.views] == [Picture.SIDE, Picture.TOP]
    assert found.volume.value == pytest.approx(1.0 * 2.0 * 0.5, rel=1e-3)


@pytest.mark.parametrize("name", swept_catalogue())
def test_millions_of_poses_lie_in_the_workspace_and_fill_it(name: str) -> None:
    own = point(name)
    for view in workspace(name).views:
        region = view.reachable.region
        if region.is_empty:
            continue
        seen = PlaneMap.of(own, view.picture)
        width, hit = own.size / 40, set[tuple[int, int]]()
        for seed in range(8):
            x, y = seen.values(own.random(250_000, seen.joints, seed + 1))[0]
            outside = ~shapely.contains_xy(region, x, y)
            away = shapely.distance(region, shapely.points(x[outside], y[outside]))
            assert away.max(initial=0.0) <= (1e-3 if view.exact else 5e-3) * own.size
            hit |= set(map(tuple, np.rint(np.stack([x, y], axis=1) / width).astype(int).tolist()))
        if len(seen.joints) <= 3:  # more joints leave the border without samples
            left, low, right, high = (round(bound / width) for bound in region.bounds)
            nodes = np.array([(i, j) for i in range(left, right + 1) for j in range(low, high + 1)])
            deep = shapely.contains_xy(region.buffer(-2.0 * width), *(width * nodes.T))
            assert {tuple(node) for node in nodes[deep].tolist()} <= hit

"""Postures of arms, dexterous places of wrists, and the workspace of a robot as a whole."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

from derive.workspace.point import TURN, Picture, PlaneMap
from derive.workspace.poses import RobotPoses
from derive.workspace.postures import Postures
from derive.workspace.region import Area, by_number, exact_area, formula_area
from derive.workspace.views import Workspace, find_workspace, find_wrist
from tests.random_robots import swept_catalogue
from tests.workspace.arms import arm, plane, point

shapely = pytest.importorskip("shapely")
pytest.importorskip("matplotlib")


@pytest.mark.parametrize(
    ("joints", "picture"), [("holed", Picture.TOP), ("tube", Picture.SECTION)], ids=["planar", "torus"]
)
def test_formulas_and_critical_curves_bound_the_same_area(joints: str, picture: Picture) -> None:
    seen = plane(joints, picture)
    found = Postures.of(seen.point)
    assert found.has_formulas
    area = formula_area(seen, lambda parts: found.curves(seen, parts // 5), lambda places: found.within(seen, places))
    other = exact_area(seen, 100)
    assert area.region.symmetric_difference(other.region).area < 4e-3 * other.region.area


def test_the_cuspidal_arm_has_four_postures_between_its_cusps_and_two_around() -> None:
    seen = plane("cuspidal", Picture.SECTION)
    found = Postures.of(seen.point)
    assert found.are_counted
    assert not found.has_formulas
    parts = by_number(exact_area(seen, 100), lambda places: found.number(seen, places), seen.point.size)
    assert [number for number, _ in parts] == [2, 4]
    inner = parts[1][1]
    assert shapely.contains_xy(inner, 2.5, 0.0)
    assert not shapely.contains_xy(inner, 3.5, 0.0)


def test_slivers_along_a_curve_belong_to_what_is_beside_them() -> None:
    boxes = (shapely.box(0, 0, 1, 1), shapely.box(1, 0, 1.0004, 1), shapely.box(1.0004, 0, 2, 1))
    area = Area(shapely.union_all(boxes), shapely.union_all(boxes), cells=boxes)
    numbers = lambda places: np.where(abs(places[0] - 1.0002) < 2e-4, 3, np.where(places[0] < 1, 2, 4))  # noqa: E731
    parts = by_number(area, numbers, 2.0)
    assert [number for number, _ in parts] == [2, 4]
    assert sum(part.area for _, part in parts) == pytest.approx(2.0, abs=1e-3)


def test_postures_are_those_within_the_limits_and_none_reaches_beyond_the_arm() -> None:
    seen = plane("limited", Picture.TOP)
    found = Postures.of(seen.point)
    assert not found.has_formulas
    q = seen.point.random(200, seen.joints, seed=2)
    assert (found.number(seen, seen.places(q)) == 1).all()  # the elbow bends to one side
    free = plane("[{type: revolute, a: 1}, {type: revolute, a: 0.5}]", Picture.TOP)
    assert (Postures.of(free.point).number(free, seen.places(q)) == 2).all()
    seen = plane("holed", Picture.TOP)
    assert Postures.of(seen.point).number(seen, np.array([[0.1, 1.0, 1.9], [0.0, 0.0, 0.0]])).tolist() == [0, 2, 0]


def test_arms_of_many_joints_are_not_asked_and_hands_that_slide_are_no_wrists() -> None:
    assert Postures.of(point("kuka-lwr4")) is None
    assert find_wrist(point("anthropomorphic-arm")) is None  # its last axes do not meet
    slides = "[{type: revolute, a: 1}, {type: revolute, alpha: pi/2}, {type: prismatic, limits: [0.2, 1]}]"
    assert find_wrist(point(slides)) is None


Limits = tuple[float, float]
FULL, HALF, LESS, BEYOND = (-math.pi, math.pi), (-1.6, 1.6), (-1.5, 1.5), (0.0, math.pi)


def turns_everywhere(*ways: Limits) -> bool:
    """Whether one of both solutions of every orientation, off the places where they are one, is within the limits."""
    a, m, b = np.meshgrid(
        np.linspace(0.01, TURN, 40), np.linspace(0.02, math.pi - 0.02, 9), np.linspace(0.01, TURN, 40)
    )
    within = [
        np.all([(q - low) % TURN <= high - low + 1e-9 for q, (low, high) in zip(own, ways, strict=True)], axis=0)
        for own in ((a, m, b), (a + math.pi, -m, b + math.pi))
    ]
    return bool(np.any(within, axis=0).all())


@pytest.mark.parametrize("ways", [*product((FULL, HALF, LESS), (FULL, BEYOND, LESS), (FULL, HALF))])
def test_a_wrist_is_complete_if_brute_force_finds_every_orientation(ways: tuple[Limits, Limits, Limits]) -> None:
    cells = [
        f"{{type: revolute, alpha: {alpha}, limits: [{low}, {high}]}}"
        for alpha, (low, high) in zip(("-pi/2", "pi/2", "0"), ways, strict=True)
    ]
    found = find_wrist(point(f"[{{type: revolute, a: 1}}, {', '.join(cells)}]"))
    assert found.complete == turns_everywhere(*ways)


def test_limits_of_a_wrist_that_are_assumed_are_told() -> None:
    assert [way.variable for way in find_workspace(RobotPoses(arm("scara-perugia"))).assumed][-1] == "q4"


@pytest.mark.parametrize(
    "limits", [((-1.2, 2.0), (0.3, 2.4)), pytest.param(((-3.0, 3.0), (-2.5, -0.2)), marks=pytest.mark.sweep)]
)
def test_places_are_dexterous_if_all_orientations_are_reached(limits: tuple[Limits, Limits]) -> None:
    """The pose of a planar arm in closed form: both elbows, within the limits."""
    rows = [f"{{type: revolute, a: {a}, limits: [{w[0]}, {w[1]}]}}" for a, w in zip((1, 0.8), limits, strict=True)]
    (view,) = find_workspace(RobotPoses(arm(f"[{', '.join(rows)}, {{type: revolute, a: 0.15}}]"))).views
    x, y = np.random.default_rng(5).uniform(-2.0, 2.0, (2, 4_000, 1))
    hand = np.linspace(0.0, TURN, 180, endpoint=False)
    u, v = x - 0.15 * np.cos(hand), y - 0.15 * np.sin(hand)
    bend = (u**2 + v**2 - 1.64) / 1.6
    reached = np.zeros(u.shape, dtype=bool)
    for q2 in (np.arccos(np.clip(bend, -1.0, 1.0)), -np.arccos(np.clip(bend, -1.0, 1.0))):
        q1 = np.arctan2(v, u) - np.arctan2(0.8 * np.sin(q2), 1.0 + 0.8 * np.cos(q2))
        within = [(q - w[0]) % TURN <= w[1] - w[0] for q, w in zip((q1, q2), limits, strict=True)]
        reached |= (np.abs(bend) <= 1.0) & within[0] & within[1]
    places = shapely.points(np.hstack([x, y]))
    clear = shapely.distance(view.dexterous.region.boundary, places) > 5e-3
    assert (shapely.contains(view.dexterous.region, places) == reached.all(axis=1))[clear].all()
    assert reached.all(axis=1).sum() > 20


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

"""Areas of workspaces, postures of arms, dexterous places of wrists, and the workspace of a robot as a whole."""

import math
from itertools import product

import numpy as np
import pytest

from derive.workspace import region
from derive.workspace.point import TURN, Picture, PlaneMap
from derive.workspace.poses import RobotPoses
from derive.workspace.postures import Postures
from derive.workspace.refinement import refined_area
from derive.workspace.views import Workspace, find_workspace, find_wrist
from tests.random_robots import swept, swept_catalogue
from tests.rows import robot_of_rows
from tests.workspace.arms import arm, limited_joints, plane, point

shapely = pytest.importorskip("shapely")

SWEPT = math.pi / 4 * (2 * 0.5 * (math.cos(math.pi / 6) - math.cos(2.0)))
"""A quarter turn of the radii from |q2| = 2 to pi/6, r^2 = a1^2 + a2^2 + 2 a1 a2 cos q2."""

CLOSED_FORMS = [
    ("holed", Picture.TOP, math.pi * (1.8**2 - 0.2**2)),
    ("limited", Picture.TOP, SWEPT),
    ("cylindrical", Picture.SECTION, 0.8 * 0.6),
    ("cylindrical", Picture.TOP, 1.5 * (0.9**2 - 0.3**2)),
]


def assert_measured(measure: region.Measure, wanted: float) -> None:
    """A measure is right within the error that it states, which is small."""
    assert measure.error <= 2e-2 * wanted
    assert abs(measure.value - wanted) <= measure.error + 1e-9


@pytest.mark.parametrize(("joints", "picture", "wanted"), CLOSED_FORMS)
def test_areas_are_the_closed_forms_within_their_error(joints: str, picture: Picture, wanted: float) -> None:
    assert_measured(region.exact_area(plane(joints, picture), 60).size, wanted)


def test_curves_that_close_cover_nothing_and_an_edge_is_as_wide_as_joint_1_turns() -> None:
    assert region.exact_area(plane("closed", Picture.SECTION), 60).region.is_empty
    assert region.exact_area(plane("edgewise", Picture.TOP), 60).size.value == pytest.approx(5.1156, rel=2e-3)


@pytest.mark.parametrize("cells", [100, *swept(50, 150)])
def test_straight_curves_that_run_back_bound_an_area_too(cells: int) -> None:
    """However many cells: its places lie within the limits of joint 1 and what the others turn beyond them."""
    found = region.exact_area(plane("straight", Picture.TOP), cells).region
    assert found.area == pytest.approx(0.5687, rel=2e-3)
    assert found.bounds[3] < 0.0


def test_the_hole_around_a_base_is_round_and_a_ring_inside_of_a_torus_left_out() -> None:
    ring = shapely.get_parts(region.exact_area(plane("holed", Picture.TOP), 60).region)[0].interiors[0]
    radii = np.hypot(*np.asarray(ring.coords).T)
    assert np.abs(radii - 0.2).max() <= 5e-4
    area = region.exact_area(plane("tube", Picture.SECTION), 60)
    assert [len(part.interiors) for part in shapely.get_parts(area.region)] == [1]
    assert_measured(area.volume, 2.0 * math.pi * 2.0 * math.pi * (1.4**2 - 0.6**2))


def test_volumes_of_spheres_and_cylinders_are_the_closed_forms() -> None:
    sphere = region.exact_area(plane("anthropomorphic-arm", Picture.SECTION), 40)
    assert_measured(sphere.volume, 4.0 / 3.0 * math.pi * (1.8**3 - 0.2**3))
    ring = region.exact_area(plane("spherical-arm", Picture.SECTION), 40)  # a ball with a bore of radius d2
    assert_measured(ring.volume, 4.0 / 3.0 * math.pi)


@pytest.mark.sweep
def test_cells_that_are_reached_by_few_configurations_are_kept() -> None:
    seen = plane("cornered", Picture.TOP)
    x, y = seen.values(seen.point.random(150_000, seen.joints, seed=11))[0]
    found = region.exact_area(seen, 80).region
    outside = ~shapely.contains_xy(found, x, y)
    assert shapely.distance(found, shapely.points(x[outside], y[outside])).max(initial=0.0) <= 5e-3


def test_every_pose_of_an_arm_with_cusps_lies_inside_and_every_cell_inside_is_reached() -> None:
    seen = plane("cuspidal", Picture.SECTION)
    area = region.exact_area(seen, 80)
    x, y = seen.values(seen.point.random(100_000, seen.joints, seed=7))[0]
    outside = ~shapely.contains_xy(area.region, x, y)
    away = shapely.distance(area.region, shapely.points(x[outside], y[outside]))
    assert away.max(initial=0.0) <= 5e-3
    left, low, right, high = area.region.bounds
    across, up = (grid.ravel() for grid in np.meshgrid(np.linspace(left, right, 15), np.linspace(low, high, 15)))
    inner = shapely.contains_xy(area.region.buffer(-5e-3), across, up)
    assert inner.sum() > 60
    assert region.is_reached(seen, np.stack([across[inner], up[inner]])).all()
    outer = ~shapely.contains_xy(area.region.buffer(5e-3), across, up) & (across > 0.0)
    assert outer.sum() > 15
    assert not region.is_reached(seen, np.stack([across[outer], up[outer]])).any()


def test_a_hand_shrinks_the_outside_and_grows_the_hole_unless_it_is_longer() -> None:
    ring = shapely.Point(0, 0).buffer(2, 256).difference(shapely.Point(0, 0).buffer(0.2, 256))
    small, long = region.dexterous(ring, 0.1, False), region.dexterous(ring, 0.6, False)
    assert small.area == pytest.approx(math.pi * (1.9**2 - 0.3**2), rel=1e-3)
    assert long.area == pytest.approx(math.pi * (1.4**2 - 0.8**2 + 0.4**2), rel=1e-3)
    half = ring.intersection(shapely.box(0, -9, 9, 9))
    assert region.dexterous(half, 0.6, True).area == pytest.approx(long.area / 2, rel=1e-3)
    assert region.enlarged(half, 0.1, True).area == pytest.approx(math.pi * (2.1**2 - 0.1**2) / 2, rel=1e-3)


def test_circles_that_hold_an_area_are_centred_near_it_and_its_error_is_the_difference_of_two_approximations() -> None:
    disc = shapely.Point(1, 2).buffer(0.5, 64)
    assert region.enclosing(disc, 0.4).is_empty
    held = region.enclosing(disc, 0.8)
    assert held.centroid.distance(shapely.Point(1, 2)) <= 1e-9
    assert held.area == pytest.approx(math.pi * 0.3**2, rel=1e-2)
    area = region.Area(shapely.Point(0, 0).buffer(1, 32), shapely.Point(0, 0).buffer(1, 16))
    assert abs(area.size.value - math.pi) < 0.01 * area.size.error
    assert region.Area(2.0, 1.7).measured(float).error == pytest.approx(0.3)


pytest.importorskip("contourpy")


@pytest.mark.parametrize(("joints", "picture"), [("limited", Picture.TOP), ("tube", Picture.SECTION)])
def test_two_ways_to_the_same_area_agree(joints: str, picture: Picture) -> None:
    seen = plane(joints, picture)
    followed, exact = refined_area(seen, 40), region.exact_area(seen, 60)
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


@pytest.mark.sweep
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
    exact, followed = region.exact_area(seen, 150), refined_area(seen, 60)
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
    area = refined_area(plane("|".join([f"R {link}"] * count), Picture.TOP), parts)
    assert area.region.bounds[2] == pytest.approx(reach, abs=5e-4 * reach)
    assert 1.01 * math.pi * reach**2 > area.region.area > least * math.pi * reach**2


pytest.importorskip("matplotlib")


@pytest.mark.parametrize(("joints", "picture"), [("holed", Picture.TOP), ("tube", Picture.SECTION)])
def test_formulas_and_critical_curves_bound_the_same_area(joints: str, picture: Picture) -> None:
    seen = plane(joints, picture)
    found = Postures.of(seen.point)
    assert found.has_formulas
    area = region.formula_area(seen, lambda parts: found.curves(seen, parts // 5), lambda q: found.within(seen, q))
    other = region.exact_area(seen, 100)
    assert area.region.symmetric_difference(other.region).area < 4e-3 * other.region.area


def test_the_cuspidal_arm_has_four_postures_between_its_cusps_and_two_around() -> None:
    seen = plane("cuspidal", Picture.SECTION)
    found = Postures.of(seen.point)
    assert found.are_counted
    assert not found.has_formulas
    parts = region.by_number(region.exact_area(seen, 100), lambda places: found.number(seen, places), seen.point.size)
    assert [number for number, _ in parts] == [2, 4]
    inner = parts[1][1]
    assert shapely.contains_xy(inner, 2.5, 0.0)
    assert not shapely.contains_xy(inner, 3.5, 0.0)


def test_slivers_along_a_curve_belong_to_what_is_beside_them() -> None:
    boxes = (shapely.box(0, 0, 1, 1), shapely.box(1, 0, 1.0004, 1), shapely.box(1.0004, 0, 2, 1))
    area = region.Area(shapely.union_all(boxes), shapely.union_all(boxes), cells=boxes)
    numbers = lambda places: np.where(abs(places[0] - 1.0002) < 2e-4, 3, np.where(places[0] < 1, 2, 4))  # noqa: E731
    parts = region.by_number(area, numbers, 2.0)
    assert [number for number, _ in parts] == [2, 4]
    assert sum(part.area for _, part in parts) == pytest.approx(2.0, abs=1e-3)


def test_postures_are_those_within_the_limits_and_none_reaches_beyond_the_arm() -> None:
    seen = plane("limited", Picture.TOP)
    found = Postures.of(seen.point)
    assert not found.has_formulas
    q = seen.point.random(200, seen.joints, seed=2)
    assert (found.number(seen, seen.places(q)) == 1).all()  # the elbow bends to one side
    free = plane("R a: 1 | R a: 0.5", Picture.TOP)
    assert (Postures.of(free.point).number(free, seen.places(q)) == 2).all()
    seen = plane("holed", Picture.TOP)
    assert Postures.of(seen.point).number(seen, np.array([[0.1, 1.0, 1.9], [0.0, 0.0, 0.0]])).tolist() == [0, 2, 0]


def test_arms_of_many_joints_are_not_asked_and_hands_that_slide_are_no_wrists() -> None:
    assert Postures.of(point("kuka-lwr4")) is None
    assert find_wrist(point("anthropomorphic-arm")) is None  # its last axes do not meet
    assert find_wrist(point("R a: 1 | R alpha: pi/2 | P limits: [0.2, 1]")) is None


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
@pytest.mark.first(6)
def test_a_wrist_is_complete_if_brute_force_finds_every_orientation(ways: tuple[Limits, Limits, Limits]) -> None:
    cells = [
        f"R alpha: {alpha}, limits: [{low}, {high}]"
        for alpha, (low, high) in zip(("-pi/2", "pi/2", "0"), ways, strict=True)
    ]
    found = find_wrist(point("|".join(["R a: 1", *cells])))
    assert found.complete == turns_everywhere(*ways)


def test_limits_of_a_wrist_that_are_assumed_are_told() -> None:
    assert [way.variable for way in find_workspace(RobotPoses(arm("scara-perugia"))).assumed][-1] == "q4"


@pytest.mark.parametrize(
    "limits", [((-1.2, 2.0), (0.3, 2.4)), pytest.param(((-3.0, 3.0), (-2.5, -0.2)), marks=pytest.mark.sweep)]
)
def test_places_are_dexterous_if_all_orientations_are_reached(limits: tuple[Limits, Limits]) -> None:
    """The pose of a planar arm in closed form: both elbows, within the limits."""
    rows = [f"R a: {a}, limits: [{w[0]}, {w[1]}]" for a, w in zip((1, 0.8), limits, strict=True)]
    (view,) = find_workspace(RobotPoses(robot_of_rows("|".join([*rows, "R a: 0.15"])))).views
    x, y = np.random.default_rng(5).uniform(-2.0, 2.0, (2, 1_500, 1))
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
        whole = view.reachable.region
        if whole.is_empty:
            continue
        seen = PlaneMap.of(own, view.picture)
        width, hit = own.size / 40, set[tuple[int, int]]()
        for seed in range(8):
            x, y = seen.values(own.random(250_000, seen.joints, seed + 1))[0]
            outside = ~shapely.contains_xy(whole, x, y)
            away = shapely.distance(whole, shapely.points(x[outside], y[outside]))
            assert away.max(initial=0.0) <= (1e-3 if view.exact else 5e-3) * own.size
            hit |= set(map(tuple, np.rint(np.stack([x, y], axis=1) / width).astype(int).tolist()))
        if len(seen.joints) <= 3:  # more joints leave the border without samples
            left, low, right, high = (round(bound / width) for bound in whole.bounds)
            nodes = np.array([(i, j) for i in range(left, right + 1) for j in range(low, high + 1)])
            deep = shapely.contains_xy(whole.buffer(-2.0 * width), *(width * nodes.T))
            assert {tuple(node) for node in nodes[deep].tolist()} <= hit

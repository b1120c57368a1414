"""In how many postures places are reached; boundaries by square roots against those by critical curves."""

from __future__ import annotations

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.workspace.point import ArmPoint, Picture, PlaneMap
from derive.workspace.postures import Postures
from derive.workspace.region import Area, by_number, exact_area, formula_area
from tests.workspace.arms import CUSPIDAL, HOLED, LIMITED, TUBE, arm, plane

shapely = pytest.importorskip("shapely")


def postures(point: ArmPoint) -> Postures:
    """The postures of an arm, which it has."""
    found = Postures.of(point)
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("joints", "picture"), [(HOLED, Picture.TOP), (TUBE, Picture.SECTION)], ids=["planar", "torus"]
)
def test_formulas_and_critical_curves_bound_the_same_area(joints: str, picture: Picture) -> None:
    seen = plane(arm(joints), picture)
    found = postures(seen.point)
    assert found.has_formulas
    area = formula_area(seen, lambda parts: found.curves(seen, parts // 5), lambda places: found.within(seen, places))
    other = exact_area(seen, 100)
    assert area.region.symmetric_difference(other.region).area < 4e-3 * other.region.area


def test_the_cuspidal_arm_has_four_postures_between_its_cusps_and_two_around() -> None:
    seen = plane(arm(CUSPIDAL), Picture.SECTION)
    found = postures(seen.point)
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
    parts = by_number(
        area, lambda places: np.where(abs(places[0] - 1.0002) < 2e-4, 3, np.where(places[0] < 1, 2, 4)), 2.0
    )
    assert [number for number, _ in parts] == [2, 4]
    assert sum(part.area for _, part in parts) == pytest.approx(2.0, abs=1e-3)


def test_postures_are_those_within_the_limits() -> None:
    seen = plane(arm(LIMITED), Picture.TOP)
    found = postures(seen.point)
    assert not found.has_formulas
    q = seen.point.random(200, seen.joints, seed=2)
    assert (found.number(seen, seen.places(q)) == 1).all()  # the elbow bends to one side
    free = plane(arm("[{type: revolute, a: 1}, {type: revolute, a: 0.5}]"), Picture.TOP)
    assert (postures(free.point).number(free, seen.places(q)) == 2).all()


def test_no_posture_reaches_beyond_the_arm() -> None:
    seen = plane(arm(HOLED), Picture.TOP)
    assert postures(seen.point).number(seen, np.array([[0.1, 1.0, 1.9], [0.0, 0.0, 0.0]])).tolist() == [0, 2, 0]


def test_arms_of_many_joints_are_not_asked() -> None:
    seen = plane(Robot.load("kuka-lwr4"), Picture.SECTION)
    assert Postures.of(seen.point) is None
    assert isinstance(PlaneMap.of(seen.point, Picture.TOP), PlaneMap)

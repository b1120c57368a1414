"""Names of the pose as books print them, and configurations at which formulas are tried."""

from __future__ import annotations

import math

import pytest

from derive.api.robots import load
from derive.checking.inverse.poses import PoseNames, places


def test_an_o_is_the_position_unless_columns_stand_beside_it() -> None:
    robot = load("scara-perugia")
    assert PoseNames.of(robot, ["ox", "r11"]).entries == {"ox": (1, 4), "r11": (1, 1)}
    assert PoseNames.of(robot, ["ox", "nx", "px"]).entries["ox"] == (1, 2)
    assert PoseNames.of(robot, ["ox", "sx"]).entries["ox"] == (1, 4)


@pytest.mark.parametrize(
    ("word", "entry"),
    [
        ("p_x", (1, 4)),
        ("T14", (1, 4)),
        ("r_23", (2, 3)),
        ("az", (3, 3)),
        ("s_y", (2, 2)),
        ("nz", (3, 1)),
        ("y", (2, 4)),
    ],
)
def test_entries_have_the_names_of_books(word: str, entry: tuple[int, int]) -> None:
    assert PoseNames.of(load("puma560-corke"), [word]).entries == {word: entry}


def test_the_names_of_the_robot_are_none_of_the_pose() -> None:
    assert not PoseNames.of(load("skeleton-root"), ["Tx"]).entries


def test_the_wrist_of_an_arm_is_where_its_last_axes_meet() -> None:
    names = PoseNames.of(load("stanford-laschi"), ["xc", "pWy", "w_z", "px", "az"])
    assert names.wrist == {"xc": 0, "pWy": 1, "w_z": 2}
    for place in places(names, {}):
        along = place.values["w_z"] - place.pose[2][3]
        assert abs(along) < 1e-12 or math.isclose(abs(along), abs(place.values.get("d6", 0) * place.values["az"]))


def test_an_arm_without_a_wrist_has_no_centre() -> None:
    assert not PoseNames.of(load("thumb"), ["xc"]).meanings


def test_planar_arms_have_an_orientation_and_their_last_joint_as_wrist() -> None:
    names = PoseNames.of(load("planar-3r"), ["phi", "cphi", "x", "pWx"])
    assert names.rows == ("x", "phi")
    for place in places(names, {}):
        values = place.values
        total = values["q1"] + values["q2"] + values["q3"]
        assert abs(math.remainder(values["(phi)"] - total, math.tau)) < 1e-12
        assert math.isclose(values["pWx"], values["x"] - values["a3"] * math.cos(total), abs_tol=1e-12)


def test_negative_slides_need_not_be_given_unless_limits_allow_them() -> None:
    free = places(PoseNames.of(load("spherical-arm"), []), {})
    assert {place.required for place in free} == {True, False}
    assert all(place.required is (place.values["q3"] > 0) for place in free)

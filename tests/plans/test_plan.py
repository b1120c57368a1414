"""Plans as they are written: cells, points, data, schema, loads, pushes, moving bases, and those of the catalogue."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from sympy import Rational, cos, pi, sin

from derive.errors import DeriveError, RobotFileError, UnknownRobotError
from derive.motion.motion import Motion
from derive.motion.torques.base_torques import BaseCurve
from derive.plans.catalogue import new_plan_text, plan_bytes, plan_names, plan_text, waypoints
from derive.plans.cells import PlanCells
from derive.plans.plan import OF_PATHS, plan_from_bytes, remarks_on_loads
from derive.plans.profile import TIME
from derive.plans.schema import PlanFile, plan_json_schema
from derive.plans.segments import Disturbance, Step
from derive.robot.expression import ZERO, number, to_text
from derive.robot.load import catalogue_names
from derive.robot.reading.document import Document, YamlMapping, read_document, read_tree
from derive.robot.reading.structure import model_of
from derive.robot.robot import Robot
from tests.motion.plans import PICK_AND_PLACE, REACH
from tests.motion.wrong_plans import RIGHT, WRONG
from tests.random_robots import chains

PATH = "path: [a, {to: b, time: 1}]\n"
BARE = """\
robot: {name: bare, convention: standard, joints: [{type: revolute, a: 1}]}
points: {a: [0], b: [1], c: [2]}
path: [a, {to: b, time: 1}, {to: c, time: 1}]
"""
CURVES = "robot: planar-2r-perugia\ncurves: {q1: sin(t)}\ntime: 5\n"


def test_a_robot_may_stand_in_the_plan_or_in_a_file_beside_it(tmp_path: Path) -> None:
    robot = "{name: arm, convention: standard, units: {angle: deg}, joints: [{type: revolute, a: 1}]}"
    plan = plan_from_bytes(f"robot: {robot}\npoints: {{a: [0], b: [90]}}\n{PATH}".encode(), "p")
    assert to_text(plan.points["b"].q[0]) == "pi/2"  # type: ignore[index]
    (tmp_path / "mine.yaml").write_text("{name: arm, convention: standard, joints: [{type: revolute, a: 1}]}")
    text = f"robot: mine.yaml\npoints: {{a: [0], b: [1]}}\n{PATH}"
    assert plan_from_bytes(text.encode(), str(tmp_path / "plan.yaml")).robot.name == "arm"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PICK_AND_PLACE.replace("2, 0, 1, 0]", "2, 0, 1]", 1), r"plan.yaml:8:6: .*3 values for 4 joints"),
        (PICK_AND_PLACE.replace("quintic", "quintc"), r"plan.yaml:2:10: profile: found .*did you mean 'quintic'"),
        (PICK_AND_PLACE.replace("scara-matlab", "scara-matlb"), r"plan.yaml:1:8: .*did you mean 'scara-matlab'"),
        (BARE.replace("revolute, a: 1", "prismatic").replace("[1]", "[90 deg]"), r"plan.yaml:2:\d+"),
        (
            BARE.replace("revolute, a: 1", "prismatic").replace("[1]", "[pi/2]"),
            r"2:22: .*'pi/2', for the slide q1",
        ),
        (CURVES.replace("q1", "q9"), r"p?lan.yaml:2:\d+: curves, q9: no joint 'q9'; allowed: q1, q2"),
        (CURVES.replace("sin(t)", "sin(w*t)"), r"the symbol 'w' has no number"),
        (CURVES.replace("time: 5", "sample: 1"), r"<?lan.yaml:2:9: curves: no time; write time: 10"),
        ("[1, 2]", r"this is not a motion plan"),
    ],
)
def test_wrong_plans_and_curves_are_refused_with_their_place(text: str, message: str) -> None:
    with pytest.raises(DeriveError, match=message):
        plan_from_bytes(text.encode(), "plan.yaml")


def cells(text: str) -> PlanCells:
    root = read_tree(text.encode(), "plan.yaml")
    assert isinstance(root, YamlMapping)
    return PlanCells(Document(root, "plan.yaml", "", "the plan"), Robot.load("scara-matlab"))


@pytest.mark.parametrize(("old", "new", "message"), WRONG, ids=[new.strip()[:60] for _, new, _ in WRONG])
def test_a_wrong_plan_is_one_message_when_it_is_loaded(old: str, new: str, message: str) -> None:
    assert old in RIGHT
    text = RIGHT.replace(old, new, 1) if old else RIGHT + new
    with pytest.raises(DeriveError, match=rf"\Aplan.yaml:{re.escape(message)}[^\n]*\Z"):
        Motion.from_text(text, "plan.yaml")


def test_joint_values_have_the_units_of_the_robot_and_numbers_and_formulas_the_time() -> None:
    found = cells("values: {w: 1/3}\nq: [pi/2, 2*w, w, 0]\n")
    assert [to_text(value) for value in found.of_joints(("q",))] == ["pi/2", "2*w", "w", "0"]
    assert found.size(found.plain(("q", 1))) == pytest.approx(2 / 3)
    found.check_used()
    with pytest.raises(DeriveError, match=r"plan.yaml:1:13: values, w: no symbol 'w' in scara-matlab or in a formula"):
        cells("values: {w: 1}").check_used()
    found = cells("x: 2*t")
    assert to_text(found.formula(("x",), found.cells.plain)) == "2*t"
    with pytest.raises(DeriveError, match="the symbol 't' has no number"):
        found.plain(("x",))


PLAN = """\
robot: planar-3r
values: {{a1: 1, a2: 1, a3: 1}}
points: {{a: [0, 0.5, 0.5], b: [0.2, 0.4, 0.6]}}
path: [a, {{to: b, time: 1{more}}}]
"""


@pytest.mark.parametrize(("more", "in_space"), [("", False), (", line: yes", True)])
def test_lines_are_in_space_and_profiles_of_joints_are_not(more: str, in_space: bool) -> None:
    (step,) = Motion.from_text(PLAN.format(more=more)).plan.steps
    assert isinstance(step, Step)
    assert step.in_space is in_space


def test_data_of_a_file_are_the_file_again() -> None:
    keys = yaml.safe_load(PICK_AND_PLACE)
    assert yaml.safe_load(plan_text(keys)) == keys
    assert waypoints([[0], [1]], None)["path"] == ["p0", {"to": "p1", "time": None}]
    keys["points"]["D"] = np.array([np.pi / 2, 0, 3, 0])
    keys["path"][-1]["line"] = False
    keys["title"] = None
    motion, read = Motion.from_dict(keys), Motion.from_text(PICK_AND_PLACE)
    t = np.linspace(0, 15, 301)
    assert np.abs(np.array(motion(t)) - np.array(read(t))).max() < 1e-14
    assert motion.trajectory.segments[0] == read.trajectory.segments[0], "texts of cells stay exact"


def test_configurations_in_an_array_are_gone_through() -> None:
    rows = np.array([[0, 0, 1, 0], [0.3, 0.4, 1.2, 0], [0.5, -0.1, 1, 0.2]])
    motion = Motion.through("scara-matlab", rows, [1, 0.5], profile="septic", via="pass")
    assert motion(np.array([0, 1, 1.5]))[0] == pytest.approx(rows, abs=1e-15)
    assert repr(motion) == "Motion of scara-matlab, 1.5 s: p0 -> p1, p1 -> p2"
    assert Motion.through("scara-matlab", rows, 2).duration == 4
    assert Motion.through("scara-matlab", rows[:2], speed=[1] * 4).duration == pytest.approx(0.4 * 15 / 8)


@pytest.mark.parametrize(("rows", "times"), [([0, 1], 1), ([[0, 0, 0, 0]], 1), ([[0] * 4] * 3, [1, 2, 3])])
def test_rows_or_times_that_do_not_belong_together(rows: list[float], times: object) -> None:
    with pytest.raises(ValueError, match=r"points: two rows|times: one, or 2"):
        Motion.through("scara-matlab", rows, times)  # type: ignore[arg-type]


def test_what_is_no_plan_is_refused_at_its_place() -> None:
    with pytest.raises(RobotFileError, match=r"<plan>:\d+:\d+: .*4 joints"):
        Motion.through("scara-matlab", [[0, 0], [1, 1]], 1)


@pytest.mark.parametrize("name", plan_names())
def test_every_built_in_plan_moves_and_fits_the_schema(name: str) -> None:
    pytest.importorskip("jsonschema").validate(yaml.safe_load(plan_bytes(name)), plan_json_schema())
    motion = Motion.load(name)
    assert motion.plan.title
    assert (np.ptp(motion(motion.times)[0], axis=0) > 0).any()


def test_the_schema_describes_every_key_and_has_no_null() -> None:
    schema: dict[str, Any] = plan_json_schema()
    assert set(schema["properties"]) == set(model_of(PlanFile).model_fields)
    assert all(value.get("description") for value in schema["properties"].values())
    assert '"null"' not in json.dumps(schema)


@pytest.mark.parametrize("text", ["a\0b", "x" * 5000, "\ud800.yaml"])
def test_what_no_file_can_be_called_is_no_plan(text: str) -> None:
    with pytest.raises(UnknownRobotError, match="is neither a file nor a built-in plan"):
        plan_bytes(text)


def test_what_is_neither_a_file_nor_a_plan_is_named_with_what_was_meant() -> None:
    with pytest.raises(UnknownRobotError, match=r"'skeleton-rech' is neither .*did you mean 'skeleton-reach'"):
        plan_bytes("skeleton-rech")
    assert set(plan_names()).isdisjoint(catalogue_names())
    assert {"scara-pick-and-place", "skeleton-reach"} <= set(plan_names())


@pytest.mark.parametrize("name", chains())
def test_a_new_plan_of_any_robot_is_a_plan_within_its_limits(name: str) -> None:
    plan = plan_from_bytes(new_plan_text("mine", Robot.load(name), name).encode(), "mine.yaml")
    assert len(plan.steps) == 2
    assert plan.points["home"].q != plan.points["A"].q


def test_a_new_plan_counts_in_the_units_of_the_robot_file(tmp_path: Path) -> None:
    text = (
        "{name: arm, convention: standard, units: {angle: deg, length: mm}, joints: ["
        "{type: revolute, limits: [10, 60]}, {type: prismatic, limits: [0, 300]}, {type: revolute}]}"
    )
    (tmp_path / "arm.yaml").write_text(text)
    robot = Robot.load(tmp_path / "arm.yaml")
    (tmp_path / "move.yaml").write_text(new_plan_text("move", robot, "arm.yaml"))
    ends = Motion.load(tmp_path / "move.yaml")(np.array([0.0, 2.0]))[0]
    assert ends == pytest.approx(np.array([[np.radians(35), 0, 0], [np.radians(47.5), 0.15, np.pi / 4]]))


def test_pushes_last_for_a_time_and_the_plant_has_numbers_and_a_payload() -> None:
    text = PICK_AND_PLACE + "disturbance: [{joint: q3, torque: -4, end: 2}, {joint: q1, torque: 5, start: 1, end: 2}]\n"
    first, second = plan_from_bytes(text.encode(), "plan.yaml").disturbances
    assert first == Disturbance(2, number(-4), ZERO, number(2))
    assert (second.joint, second.start) == (0, number(1))
    plan = plan_from_bytes((PICK_AND_PLACE + "plant: {a1: 2.1, payload: {mass: 3}}\n").encode(), "plan.yaml")
    assert list(plan.plant) == ["a1"]
    assert plan.plant_payload.mass == number(3)
    short = plan_from_bytes((PICK_AND_PLACE + "plant: {payload: 1/2}\n").encode(), "plan.yaml").plant_payload
    assert short is not None


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("{to: b, time: 1}", "{to: b, time: 1, payload: 2}", "3:37: path entry 2, payload"),
        ("points:", "plant: {payload: 2}\npoints:", "2:8: plant"),
        ("points:", "disturbance: [{joint: q1, torque: 1, end: 2}]\npoints:", "2:14: disturbance"),
    ],
)
def test_what_acts_on_bodies_is_refused_for_a_robot_without_any(old: str, new: str, place: str) -> None:
    with pytest.raises(RobotFileError, match=f"{place}: bare has no dynamics; leave it out, or write links"):
        Motion.from_text(BARE.replace(old, new))


def test_via_stop_of_a_plan_stops_splines_too_and_what_is_about_paths_is_a_part_of_plans() -> None:
    spline = BARE + "profile: spline\n"
    assert Motion.from_text(spline)(1.0)[1][0] > 0.5
    assert Motion.from_text(spline + "via: stop\n")(1.0)[1][0] == pytest.approx(0, abs=1e-12)
    assert set(OF_PATHS) <= set(model_of(PlanFile).model_fields)


LOADED = """\
robot:
  name: arm
  convention: standard
  gravity: [0, 0, -9.81]
  parameters: {i1: 0.2}
  joints: [{type: revolute, a: 1}]
  links: [{mass: 1, inertia: {xx: 0.1, yy: i1, zz: i3}}]
values: {i3: 0.3}
points: {a: [0], b: [1]}
path: [a, {to: b, time: 1, payload: {mass: 1, inertia: [0.1, 0.1, 0.2]}}]
plant: {payload: {mass: 1}}
"""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("i1", "i1", ""),
        ("[0.1, 0.1, 0.2]", "[0, 0, 0.2]", ""),
        ("[0.1, 0.1, 0.2]", "[0.1, 0.1, 0.25]", r"10:\d+: path entry 2, payload, inertia: physically .* 0.05 kg"),
        ("1}}", "1, inertia: [1, 0, 3]}}", r"11:\d+: plant, payload, inertia: physically inconsistent: .* by 2 kg"),
        ("i3: 0.3", "i3: 0.4", r"8:9: with these values links 1, inertia: physically inconsistent: .* by 0.1 kg"),
        ("plant: {", "plant: {i1: 0.6, ", r"11:8: with these plant links 1, inertia: physically .* by 0.2 kg"),
        ("zz: i3", "zz: 0.6", r"7:\d+: links entry 1, inertia: physically inconsistent: .* by 0.3 kg"),
    ],
)
def test_what_no_body_is_is_told_once_with_its_place(old: str, new: str, message: str) -> None:
    text = LOADED.replace(old, new, 1)
    text = text if "i3}" in text else text.replace("values: {i3: 0.3}", "title: numbers")
    told = Motion.from_text(text, "plan.yaml").plan.remarks
    assert len(told) == bool(message)
    assert all(remark.is_of_bodies and re.search(f"plan.yaml:{message}", str(remark)) for remark in told)


def test_a_plan_without_numbers_and_loads_is_told_what_its_robot_is() -> None:
    plan = Motion.load("scara-pick-and-place").plan
    assert plan.remarks == plan.robot.remarks != ()
    document = read_document(LOADED.encode(), "plan.yaml")
    assert list(remarks_on_loads(document, plan.robot, ({}, {}), {})) == []


def test_a_base_is_a_rigid_motion_and_its_rates_are_its_derivatives() -> None:
    base = BaseCurve.of((TIME, TIME**2, sin(TIME)), (TIME / 3, cos(TIME), Rational(1, 5) * TIME))
    t, h = np.linspace(0, 3, 7), 1e-6
    there = base(t, 0)
    assert there[:, :3, :3] @ there[:, :3, :3].transpose(0, 2, 1) == pytest.approx(np.tile(np.eye(3), (7, 1, 1)))
    assert there[:, 3].tolist() == [[0, 0, 0, 1]] * 7
    for order in (1, 2):
        slope = (base(t + h, order - 1) - base(t - h, order - 1)) / (2 * h)
        assert base(t, order) == pytest.approx(slope, abs=1e-8)
    yaw_last = BaseCurve.of((TIME, TIME, TIME), (pi / 2, pi * 0, pi / 2))(np.zeros(1), 0)[0, :3]
    assert yaw_last[:, 1].round(15).tolist() == [0, 0, 1]
    assert yaw_last[:, 0].round(15).tolist() == [0, 1, 0]


def test_on_a_base_that_moves_an_arm_has_torques_which_fastest_motions_do_not_know() -> None:
    text = REACH.replace("skeleton", "scara-matlab").partition("values:")[0]
    motion = Motion.from_text(text)
    assert motion.has_torques
    assert all(len(found.loads) == 4 for found in motion.peaks)
    points = "points: {a: [0, 0, 0, 0], b: [1, 1, 1, 1]}\npath: [a, {to: b}]\n"
    limits = "profile: fastest\nspeed: [1, 1, 1, 1]\nacceleration: [1, 1, 1, 1]\ntorque: [9, 9, 9, 9]\n"
    with pytest.raises(DeriveError, match=r"torques of a fastest motion.*base that moves"):
        _ = Motion.from_text(f"robot: scara-matlab\n{points}{limits}base: {{x: t}}\n").trajectory

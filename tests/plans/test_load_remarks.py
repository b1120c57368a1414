"""Loads, pushes and bases that move, and what is said about them."""

from __future__ import annotations

import re

import numpy as np
import pytest
from sympy import Rational, cos, pi, sin

from derive.errors import DeriveError, RobotFileError
from derive.motion.motion import Motion
from derive.plans.checks import OF_PATHS, remarks_on_loads
from derive.plans.disturbance import Disturbance
from derive.plans.hermite import TIME
from derive.plans.moving_base import BaseCurve
from derive.plans.plan import plan_from_bytes
from derive.plans.schema import PlanFile
from derive.robot.expression import ZERO, number
from derive.robot.reading.document import read_document
from derive.robot.reading.structure import model_of
from tests.motion.plans import PICK_AND_PLACE, REACH


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


BARE = """\
robot: {name: bare, convention: standard, joints: [{type: revolute, a: 1}]}
points: {a: [0], b: [1], c: [2]}
path: [a, {to: b, time: 1}, {to: c, time: 1}]
"""


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


PLAN = """\
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
        (
            "[0.1, 0.1, 0.2]",
            "[0.1, 0.1, 0.25]",
            r"10:\d+: path entry 2, payload, inertia: physically inconsistent: .* 0.05 kg",
        ),
        ("1}}", "1, inertia: [1, 0, 3]}}", r"11:\d+: plant, payload, inertia: physically inconsistent: .* by 2 kg"),
        (
            "i3: 0.3",
            "i3: 0.4",
            r"8:9: with these values links 1, inertia: physically inconsistent: .* by 0.1 kg",
        ),
        (
            "plant: {",
            "plant: {i1: 0.6, ",
            r"11:8: with these plant links 1, inertia: physically inconsistent: .* by 0.2 kg",
        ),
        ("zz: i3", "zz: 0.6", r"7:\d+: links entry 1, inertia: physically inconsistent: .* by 0.3 kg"),
    ],
)
def test_what_no_body_is_is_told_once_with_its_place(old: str, new: str, message: str) -> None:
    text = PLAN.replace(old, new, 1)
    text = text if "i3}" in text else text.replace("values: {i3: 0.3}", "title: numbers")
    told = Motion.from_text(text, "plan.yaml").plan.remarks
    assert len(told) == bool(message)
    assert all(remark.is_of_bodies and re.search(f"plan.yaml:{message}", str(remark)) for remark in told)


def test_a_plan_without_numbers_and_loads_is_told_what_its_robot_is() -> None:
    plan = Motion.load("scara-pick-and-place").plan
    assert plan.remarks == plan.robot.remarks != ()
    document = read_document(PLAN.encode(), "plan.yaml")
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
    with pytest.raises(DeriveError, match=r"torques of a fastest motion.*base that moves") as caught:
        _ = Motion.from_text(f"robot: scara-matlab\n{points}{limits}base: {{x: t}}\n").trajectory
    assert caught.value.exit_status == 2

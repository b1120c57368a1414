"""Bodies of a plan that no body is are told as those of a robot file are."""

from __future__ import annotations

import re

import pytest

from derive.motion.motion import Motion
from derive.plans.checks import remarks_on_loads
from derive.robot.reading.document import read_document

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
        ("[0.1, 0.1, 0.2]", "[0.1, 0.1, 0.25]", r"10:\d+: path entry 2, payload, inertia: no body has it, .* 0.05 kg"),
        (
            "{mass: 1}}",
            "{mass: 1, inertia: [1, 0, 3]}}",
            r"11:\d+: plant, payload, inertia: no body has it, .* is 2 kg",
        ),
        ("i3: 0.3", "i3: 0.4", r"8:9: with these values links 1, inertia: no body has it, .* is 0.1 kg m\^2 larger"),
        ("plant: {", "plant: {i1: 0.6, ", r"11:8: with these plant links 1, inertia: no body has it, .* is 0.2 kg"),
        ("zz: i3", "zz: 0.6", r"7:\d+: links entry 1, inertia: no body has it, .* is 0.3 kg m\^2 larger"),
    ],
)
def test_what_no_body_is_is_told_once_with_its_place(old: str, new: str, message: str) -> None:
    text = PLAN.replace(old, new, 1)
    motion = Motion.from_text(
        text if "i3}" in text else text.replace("values: {i3: 0.3}", "title: numbers"), "plan.yaml"
    )
    told = motion.plan.remarks
    assert len(told) == bool(message)
    assert all(remark.is_of_bodies and re.search(f"plan.yaml:{message}", str(remark)) for remark in told)


def test_a_plan_without_numbers_and_loads_is_told_what_its_robot_is() -> None:
    plan = Motion.load("scara-pick-and-place").plan
    assert plan.remarks == plan.robot.remarks != ()
    document = read_document(PLAN.encode(), "plan.yaml")
    assert list(remarks_on_loads(document, plan.robot, ({}, {}), {})) == []

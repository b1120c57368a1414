"""Disturbances and other numbers of the simulated arm, as plans give them."""

from __future__ import annotations

import re

import pytest

from derive.errors import DeriveError
from derive.plans.disturbance import Disturbance
from derive.plans.plan import plan_from_bytes
from derive.robot.expression import ZERO, number
from tests.motion.plans import PICK_AND_PLACE


def test_a_joint_is_pushed_for_a_time() -> None:
    text = PICK_AND_PLACE + "disturbance: [{joint: q3, torque: -4, end: 2}, {joint: q1, torque: 5, start: 1, end: 2}]\n"
    first, second = plan_from_bytes(text.encode(), "plan.yaml").disturbances
    assert first == Disturbance(2, number(-4), ZERO, number(2))
    assert (second.joint, second.start) == (0, number(1))


def test_the_plant_has_numbers_and_a_payload() -> None:
    plan = plan_from_bytes((PICK_AND_PLACE + "plant: {a1: 2.1, payload: {mass: 3}}\n").encode(), "plan.yaml")
    assert list(plan.plant) == ["a1"]
    assert plan.plant_payload is not None
    assert plan.plant_payload.mass == number(3)
    short = plan_from_bytes((PICK_AND_PLACE + "plant: {payload: 1/2}\n").encode(), "plan.yaml").plant_payload
    assert short is not None


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("disturbance: [{joint: q9, torque: 1, end: 2}]", r"plan.yaml:13:23: .*no joint 'q9'; allowed: q1"),
        ("disturbance: [{joint: q1, torque: 1, start: 3, end: 2}]", r"from 3 to 2 s; allowed: an end after the start"),
        ("disturbance: [{joint: q1, torque: w, end: 2}]", r"the symbol 'w' has no number"),
        ("disturbance: [{joint: q1, torque: 1}]", r"plan.yaml:13:.*end"),
        ("plant: {ms1: 1}", r"plan.yaml:13:\d+: plant, ms1: no symbol 'ms1' in scara-matlab; allowed: .*payload"),
        ("plant: {payload: {mass: -1}}", r"plant, payload, mass: found '-1'; allowed: zero or more"),
    ],
)
def test_wrong_ones_are_refused_with_their_place(line: str, message: str) -> None:
    with pytest.raises(DeriveError) as caught:
        plan_from_bytes((PICK_AND_PLACE + line + "\n").encode(), "plan.yaml")
    assert caught.value.exit_status == 2
    assert re.search(message, str(caught.value)), str(caught.value)

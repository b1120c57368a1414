"""Plans, and what is said about wrong ones."""

from __future__ import annotations

import re

import pytest

from derive.errors import DeriveError
from derive.plans.plan import plan_from_bytes
from derive.robot.expression import to_text
from tests.motion.plans import PICK_AND_PLACE

CURVES = "robot: planar-2r-perugia\ncurves: {q1: sin(t)}\ntime: 5\n"


def refusal(text: str) -> str:
    with pytest.raises(DeriveError) as caught:
        plan_from_bytes(text.encode(), "plan.yaml")
    assert caught.value.exit_status == 2
    return str(caught.value)


def test_points_are_read_in_the_units_of_the_robot() -> None:
    plan = plan_from_bytes(PICK_AND_PLACE.encode(), "plan.yaml")
    assert [to_text(value) for value in plan.points["B"].q or ()] == ["pi/2", "pi/2", "3", "0"]
    assert plan.start == "rest"
    assert [step.to for step in plan.steps] == ["A", "B", "A", "C", "D"]


def test_a_robot_may_stand_in_the_plan() -> None:
    robot = "{name: arm, convention: standard, units: {angle: deg}, joints: [{type: revolute, a: 1}]}"
    plan = plan_from_bytes(
        f"robot: {robot}\npoints: {{a: [0], b: [90]}}\npath: [a, {{to: b, time: 1}}]\n".encode(), "p"
    )
    assert to_text(plan.points["b"].q[0]) == "pi/2"  # type: ignore[index]


def test_a_robot_file_is_looked_for_beside_the_plan(tmp_path: object) -> None:
    from pathlib import Path

    folder = Path(str(tmp_path))
    (folder / "mine.yaml").write_text("{name: arm, convention: standard, joints: [{type: revolute, a: 1}]}")
    text = "robot: mine.yaml\npoints: {a: [0], b: [1]}\npath: [a, {to: b, time: 1}]\n"
    assert plan_from_bytes(text.encode(), str(folder / "plan.yaml")).robot.name == "arm"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("to: A, time: 3", "to: Q, time: 3", r"plan.yaml:10:19: path entry 2, to: unknown point 'Q'; allowed: rest, A"),
        (
            "C: [pi/2, 0, 1, 0]",
            "C: [pi/2, 0, 1]",
            r"plan.yaml:8:6: .*3 values for 4 joints; allowed: one for each of q1",
        ),
        ("to: A, time: 3", "to: A, time: 0", r"plan.yaml:10:28: .*time: found '0'; allowed: a time above zero"),
        ("to: A, time: 3", "to: A, time: -1", r"found '-1'; allowed: a time above zero"),
        ("D: [pi/2", "D: [xx", r"plan.yaml:9:7: .*the symbol 'xx' has no number; write values: \{xx: ...\}"),
        ("kp: 100", "kp: -100", r"plan.yaml:11:37: control, kp: found '-100'; allowed: zero or more"),
        ("kp: 100", "kp: [1, 2]", r"2 gains for 4 joints"),
        ("points:", "pts:", r"plan.yaml:4:1: .*unknown key 'pts'; allowed: robot, .*did you mean 'points'"),
        ("quintic", "quintc", r"plan.yaml:2:10: profile: found 'quintc'; .*did you mean 'quintic'"),
        ("scara-matlab", "scara-matlb", r"plan.yaml:1:8: .*did you mean 'scara-matlab'"),
        ("law: computed-torque", "law: pid", r"control, law: found 'pid'; allowed: 'none', 'pd'"),
        ("friction: smooth", "friction: rough", r"friction: found 'rough'; allowed: 'none', 'smooth' or 'exact'"),
        ("path: [", "curves: {q1: t}\ntime: 1\npath: [", r"both path and curves"),
    ],
)
def test_a_wrong_plan_is_refused_with_its_place(old: str, new: str, message: str) -> None:
    assert old in PICK_AND_PLACE
    assert re.search(message, refusal(PICK_AND_PLACE.replace(old, new, 1)))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (CURVES.replace("q1", "q9"), r"p?lan.yaml:2:\d+: curves, q9: no joint 'q9'; allowed: q1, q2"),
        (CURVES.replace("sin(t)", "sin(w*t)"), r"the symbol 'w' has no number"),
        (CURVES.replace("time: 5", "sample: 1"), r"<?lan.yaml:2:9: curves: no time; write time: 10"),
        ("robot: planar-2r-perugia\n", r"neither path nor curves"),
        ("[1, 2]", r"this is no motion plan"),
    ],
)
def test_wrong_curves_are_refused(text: str, message: str) -> None:
    assert re.search(message, refusal(text))


def test_a_point_outside_the_limits_of_a_joint_names_joint_value_and_limit() -> None:
    robot = "{name: arm, convention: standard, joints: [{type: revolute, a: 1, limits: [-1, pi/3]}]}"
    text = f"robot: {robot}\npoints: {{a: [0], b: [1.2]}}\npath: [a, {{to: b, time: 1}}]\n"
    assert "q1 = 1.2 rad is outside its limits; allowed: -1 to 1.0472 rad" in refusal(text)


def test_degrees_in_a_cell_of_a_slide_are_no_length() -> None:
    robot = "{name: arm, convention: standard, joints: [{type: prismatic}]}"
    text = f"robot: {robot}\npoints: {{a: [0], b: [90 deg]}}\npath: [a, {{to: b, time: 1}}]\n"
    assert re.search(r"<?plan.yaml:2:\d+", refusal(text))

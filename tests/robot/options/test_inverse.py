"""Task and given joints of the inverse kinematics, in a robot file; thresholds of closed forms stand in one place."""

from dataclasses import asdict

import pytest

from derive.errors import QuantityError, RobotFileError
from derive.robot.options.inverse import POSE, ROWS, TASKS, InverseOptions, chosen_given, chosen_task
from derive.robot.options.solution_policy import POLICY
from derive.robot.robot import Robot
from derive.targets.templating import template_folder
from tests.refusals import one_message

ARM = """
name: arm
convention: standard
joints: [{type: revolute, a: 1}, {type: revolute, a: 2}, {type: revolute, a: 3}]
"""


def options(block: str) -> InverseOptions:
    return Robot.from_text(ARM + block).inverse


@pytest.mark.parametrize(
    ("block", "task", "given"),
    [
        ("", POSE, None),
        ("inverse: {task: position}", TASKS["position"], None),
        ("inverse: {task: [phi, y, x]}", ("x", "y", "phi"), None),
        ("inverse: {task: [x, y], given: [q3]}", ("x", "y"), ("q3",)),
        ("inverse: {given: []}", POSE, ()),
    ],
)
def test_a_block_says_the_task_and_the_given_joints(block: str, task: tuple[str, ...], given: object) -> None:
    assert options(block) == InverseOptions(task, given)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("inverse: {task: poses}", "inverse, task: found 'poses'; allowed: 'pose' or 'position'; did you"),
        ("inverse: {task: 'x, y'}", "allowed: 'pose' or 'position'; rows stand in a list: task: [x, y]"),
        ("inverse: {task: [x, w]}", "unknown row of a task 'w'"),
        ("inverse: {task: []}", "a task without rows"),
        ("inverse: {task: [x, x]}", "'x' is in the task already"),
        ("inverse: {task: [x, y, z, phi]}", "a task of 4 coordinates for 3 joints"),
        ("inverse: {task: {x: 1}}", "found a mapping"),
        ("inverse: {given: [q4]}", "'q4' is not a joint variable; allowed: q1, q2, q3"),
        ("inverse: {given: [q1, q1]}", "'q1' is given twice"),
        ("inverse: {given: [q1, q2, q3]}", "all joints are given"),
        ("inverse: {given: q1}", "found the text 'q1'; allowed: a list"),
        ("inverse: {tasks: pose}", "unknown key 'tasks'; allowed: task, given"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(block: str, message: str) -> None:
    with one_message(RobotFileError, r"<text>:5:\d+", message):
        options(block)


def test_rows_of_a_task_are_sorted_and_names_are_those_of_joints() -> None:
    assert chosen_task(["orientation", "x"], 4) == ("x", "orientation")
    assert all(place in {(i, j) for i in (1, 2, 3) for j in (1, 2, 3, 4)} for row in ROWS.values() for place in row)
    assert chosen_given(["b", "a"], ["a", "b", "c"]) == ("a", "b")
    with pytest.raises(QuantityError, match="already"):
        chosen_task(["phi", "orientation"], 6)


def test_the_text_of_a_threshold_is_its_value():
    for name, value in asdict(POLICY).items():
        read = tuple(map(float, POLICY.texts[name].split(", ")))
        assert (read if isinstance(value, tuple) else read[0]) == value
    assert POLICY.texts["orthogonal"] == "1e-6"


def test_no_template_repeats_a_threshold():
    own = [POLICY.texts[name] for name in ("far", "reproduced", "elsewhere", "double")]
    for path in template_folder().rglob("*.jinja"):
        text = path.read_text(encoding="utf-8")
        assert not [value for value in own if value in text], path.name

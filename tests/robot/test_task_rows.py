"""The rows of the Jacobian that belong to a task."""

import pytest

from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows

NATURAL = {
    "planar-2r-perugia": (0, 1),
    "planar-3r": (0, 1, 5),
    "anthropomorphic-arm": (0, 1, 2),
    "scara-sankyo": (0, 1, 2, 5),
    "spherical-wrist": (3, 4, 5),
    "puma560-corke": tuple(range(6)),
    "kuka-lwr4": tuple(range(6)),
}


@pytest.mark.parametrize("name", NATURAL)
def test_a_natural_task_is_what_moves_or_the_position(name: str) -> None:
    robot = Robot.load(name)
    assert task_rows(robot) == NATURAL[name]
    moving = {0, 1, 5} if name.startswith("planar") else {0, 1, 2, 5} if name.startswith("scara") else set(range(6))
    assert {*task_rows(robot, "position"), *task_rows(robot, "orientation")} == moving


@pytest.mark.parametrize(
    ("task", "rows"), [("[x, phi]", (0, 5)), ("position", (0, 1, 2)), ("[x, approach]", (0, 3, 4, 5))]
)
def test_a_task_of_the_file_names_its_rows(task: str, rows: tuple[int, ...]) -> None:
    joints = "joints: [{type: revolute, alpha: pi/2}, {type: revolute, a: 1}, {type: prismatic}]"
    text = f"name: arm\nconvention: standard\n{joints}\ninverse: {{task: {task}}}\n"
    assert task_rows(Robot.from_text(text)) == rows

"""The rows of the Jacobian that belong to a task."""

import random
from itertools import product

import pytest

from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.robot.task_rows import PARTS, task_rows
from derive.verification.oracle import frames
from tests.random_robots import chains, random_robot
from tests.rows import robot_of_rows

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


def test_rows_are_those_of_the_oracle_which_looks_at_axes_at_random() -> None:
    drawn = [random_robot(random.Random(seed), 1 + seed % 4, dynamics=False) for seed in range(150)]
    arms = [(Robot.from_text(robot.text), robot.values) for robot in drawn]
    built_in = map(Robot.load, chains())
    arms += [(robot, dict.fromkeys(free_symbols(robot), 0.7)) for robot in built_in]
    for (robot, values), part in product(arms, ("all", *PARTS)):
        assert list(task_rows(robot, part)) == frames.task_rows(frames.numeric_arm(robot, values), part), robot.name


WRISTS = {("0", ""): (0, 1, 2), ("pi/2", ""): (3, 4, 5), ("0", "al"): (3, 4, 5), ("pi/2", "a2"): (0, 1, 2)}


@pytest.mark.parametrize(("twist", "runtime"), WRISTS)
def test_a_wrist_is_one_for_all_parameters(twist: str, runtime: str) -> None:
    more = f"parameters: {{al: {twist}, a2: 0}}\nruntime: [{runtime}]"
    assert task_rows(robot_of_rows("R alpha: al | R a: a2, alpha: pi/2 | R", more)) == WRISTS[twist, runtime]


@pytest.mark.parametrize(
    ("task", "rows"), [("[x, phi]", (0, 5)), ("position", (0, 1, 2)), ("[x, approach]", (0, 3, 4, 5))]
)
def test_a_task_of_the_file_names_its_rows(task: str, rows: tuple[int, ...]) -> None:
    assert task_rows(robot_of_rows("R alpha: pi/2 | R a: 1 | P", f"inverse: {{task: {task}}}")) == rows

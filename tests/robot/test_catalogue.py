"""The built-in robots load, and say what they are without being loaded."""

import pytest

from derive.robot.evaluate import evaluate
from derive.robot.load import catalogue_names, robot_file_bytes
from derive.robot.names import free_symbols
from derive.robot.robot import Robot

LECTURE_ROBOTS = 24
TREES = {"two-armed-torso", "human-skeleton", "palletiser", "two-finger-gripper"}
LINKAGES = {"delta", "five-bar", "four-bar", "slider-crank"}


def test_all_lecture_robots_and_the_arms_that_the_notes_ask_for_are_there() -> None:
    names = catalogue_names()
    assert len(names) == LECTURE_ROBOTS + 3 + len(TREES | LINKAGES)
    assert {name for name in names if Robot.load(name).is_tree} == TREES | LINKAGES
    assert {"scara-perugia", "puma560-usp", "human-body", "puma560-corke", "kuka-lwr4", "kuka-kr5"} <= set(names)
    assert list(names) == sorted(names)


@pytest.mark.parametrize("name", catalogue_names())
def test_a_built_in_robot_is_called_as_its_file_which_cites_its_source(name: str) -> None:
    robot = Robot.load(name)
    assert (robot.name, robot.source) == (name, name)
    assert robot_file_bytes(name).decode().startswith("# Source: ")


def test_corkes_reflected_inertia_is_the_square_of_the_gear_ratio_times_the_motors() -> None:
    robot = Robot.load("puma560-corke")
    reflected = [evaluate(link.armature, {}) for link in robot.links]
    ratios = (-62.6111, 107.815, -53.7063, 76.0364, 71.923, 76.686)
    rotors = (200e-6, 200e-6, 200e-6, 33e-6, 33e-6, 33e-6)
    assert reflected == pytest.approx([ratio**2 * rotor for ratio, rotor in zip(ratios, rotors, strict=True)])
    assert free_symbols(robot) == ()

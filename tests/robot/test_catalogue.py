"""The built-in robots load, and say what they are without being loaded."""

import pytest

from derive.cli.new import new_robot_text
from derive.errors import RobotFileError, UnknownRobotError
from derive.robot.evaluate import evaluate
from derive.robot.load import catalogue_names, catalogue_text
from derive.robot.names import free_symbols
from derive.robot.robot import Robot

LECTURE_ROBOTS = 24


def test_all_lecture_robots_and_the_arms_that_the_notes_ask_for_are_there() -> None:
    names = catalogue_names()
    assert len(names) == LECTURE_ROBOTS + 3
    assert {"scara-perugia", "puma560-usp", "thumb", "human-body", "puma560-corke", "kuka-lwr4", "kuka-kr5"} <= set(
        names
    )
    assert list(names) == sorted(names)


@pytest.mark.parametrize("name", catalogue_names())
def test_a_built_in_robot_is_called_as_its_file(name: str) -> None:
    robot = Robot.load(name)
    assert (robot.name, robot.source) == (name, name)


@pytest.mark.parametrize("name", catalogue_names())
def test_every_file_cites_its_source(name: str) -> None:
    assert catalogue_text(name).startswith("# Source: ")


def test_corkes_reflected_inertia_is_the_square_of_the_gear_ratio_times_the_motors() -> None:
    robot = Robot.load("puma560-corke")
    reflected = [evaluate(link.armature, {}) for link in robot.links]
    ratios = (-62.6111, 107.815, -53.7063, 76.0364, 71.923, 76.686)
    rotors = (200e-6, 200e-6, 200e-6, 33e-6, 33e-6, 33e-6)
    assert reflected == pytest.approx([ratio**2 * rotor for ratio, rotor in zip(ratios, rotors, strict=True)])
    assert free_symbols(robot) == ()


def test_unknown_catalogue_names_are_refused() -> None:
    with pytest.raises(UnknownRobotError, match="did you mean 'kuka-kr5'"):
        catalogue_text("kuka-kr6")


@pytest.mark.parametrize("joints", [1, 2, 7, 64])
def test_a_new_robot_file_loads_as_it_is(joints: int) -> None:
    robot = Robot.from_text(new_robot_text("my-arm", joints))
    assert (robot.name, robot.n, len(robot.links)) == ("my-arm", joints, joints)
    assert "g" not in free_symbols(robot)


@pytest.mark.parametrize("name", ["", "../x", "Arm", "class", "con", "a" * 65])
def test_a_new_robot_file_is_refused_for_names_that_no_robot_may_have(name: str) -> None:
    with pytest.raises(RobotFileError, match="not a robot name"):
        new_robot_text(name)


@pytest.mark.parametrize("joints", [0, -1, 65])
def test_a_new_robot_file_is_refused_for_impossible_numbers_of_joints(joints: int) -> None:
    with pytest.raises(RobotFileError, match="allowed: 1 to 64"):
        new_robot_text("my-arm", joints)

"""Robots are given by name, path or themselves; joint values as numbers or cells."""

import pickle
import pydoc
from dataclasses import replace
from pathlib import Path

import pytest

import derive
from derive.api.robots import catalogue, load, load_all
from derive.errors import UnknownRobotError
from derive.robot.robot import Robot

DEGREES = "name: arm\nconvention: standard\nunits: {angle: deg, length: mm}\njoints:\n  - {type: revolute, a: 100}\n"


def test_a_robot_is_loaded_by_name_or_path_and_stays_itself(tmp_path: Path) -> None:
    path = tmp_path / "arm.yaml"
    path.write_text(DEGREES)
    arm = load(path)
    assert arm.name == "arm"
    assert load(str(path)) == arm
    assert load(arm) is arm
    assert load("thumb") == Robot.load("thumb")
    assert [robot.name for robot in load_all(None)] == list(catalogue())
    with pytest.raises(UnknownRobotError, match="did you mean 'thumb'"):
        load("thum")


def test_a_robot_of_the_api_equals_the_plain_one_of_the_same_data() -> None:
    plain = Robot.load("thumb")
    arm = load(plain)
    assert type(arm) is derive.Robot
    assert (arm, hash(arm)) == (plain, hash(plain))
    assert plain == arm
    assert arm != load("planar-3r")
    assert plain != load("planar-3r")
    assert pickle.loads(pickle.dumps(arm)) == plain
    assert type(replace(arm, name="other")) is derive.Robot


def test_a_robot_shows_itself_as_its_table() -> None:
    shown = repr(load("scara-perugia"))
    assert shown.splitlines()[1:5] == [
        "i  joint      theta  d   a   alpha  limits",
        "1  revolute   q1     0   a1  0",
        "2  revolute   q2     0   a2  pi",
        "3  prismatic  0      q3  0   0",
    ]
    assert "Fraction" not in shown + repr(load("puma560-corke").joints) + repr(load("puma560-corke").links)


@pytest.mark.parametrize("name", catalogue())
def test_no_robot_shows_a_tree(name: str) -> None:
    robot = load(name)
    assert "Number(" not in repr(robot) + repr(robot.joints) + repr(robot.links)
    fixed = sum(row.row is not None for row in robot.fixed)
    assert len(repr(robot).splitlines()) == robot.n + fixed + bool(robot.ends) + bool(robot.coupled) + 3


def test_help_shows_no_tree_either() -> None:
    assert "Number(" not in pydoc.render_doc(Robot)

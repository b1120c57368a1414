"""A robot as text reads back as the same robot, in the units of its file."""

import random
from dataclasses import fields

import pytest

from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.robot.writer import cell_text, robot_text
from tests.random_robots import robot_text as random_text
from tests.random_robots import seeds


def differing(ours: Robot, theirs: Robot) -> list[str]:
    told = [part.name for part in fields(ours) if part.compare and part.name not in ("digest", "source")]
    return [name for name in told if getattr(ours, name) != getattr(theirs, name)]


@pytest.mark.parametrize("name", catalogue_names())
def test_every_built_in_robot_reads_back(name: str) -> None:
    robot = Robot.load(name)
    assert differing(Robot.from_text(robot_text(robot)), robot) == []


@pytest.mark.parametrize("seed", seeds(40, usual=12))
def test_random_robots_with_any_units_mean_the_same_and_are_written_the_same_again(seed: int) -> None:
    robot = Robot.from_text(random_text(random.Random(seed)))
    again = Robot.from_text(robot_text(robot))
    assert robot_text(again) == robot_text(robot)
    assert [joint.row for joint in again.joints] == [joint.row for joint in robot.joints]
    assert (again.units, again.parameters, again.runtime) == (robot.units, robot.parameters, robot.runtime)


def test_degrees_and_millimetres_are_written_as_they_were() -> None:
    text = """\
name: arm
convention: standard
units: {angle: deg, length: mm}
joints:
  - {type: revolute, q: q1, theta: -q1 + 90, d: 120.5, a: 2*a1 - 30, alpha: beta - 45, limits: [-90, 90]}
  - {type: prismatic, q: q2, theta: -22.5, d: q2 - 10, limits: [0, 250], speed: 100}
tool:
  - [1, 0, 0, -15]
  - [0, cos(beta), -sin(beta), 0]
  - [0, sin(beta), cos(beta), l + 3]
  - [0, 0, 0, 1]
gravity: [0, 0, -g]
links:
  - mass: 1
    friction: {viscous: b, coulomb: [f, 0.3]}
  - mass: 2
    friction: {coulomb: [0, 2*f]}
"""
    assert robot_text(Robot.from_text(text)) == text


def test_a_title_may_hold_anything_and_comments_go_before() -> None:
    robot = Robot.from_text(
        'name: arm\ntitle: "a \\"b\\" \\\\ c\\nd: {e} # f"\nconvention: modified\njoints: [{type: revolute}]\n'
    )
    text = robot_text(robot, ["Whence: notes.", ""])
    assert text.startswith("# Whence: notes.\n#\nname: arm\n")
    again = Robot.from_text(text)
    assert again.title == robot.title == 'a "b" \\ c\nd: {e} # f'
    assert again.comments == ("Whence: notes.", "")


def test_cells_have_all_their_digits() -> None:
    robot = Robot.from_text(
        "name: arm\nconvention: standard\njoints: [{type: revolute, a: 0.12345678901234567, d: 1/3}]\n"
    )
    assert [cell_text(cell) for cell in (robot.joints[0].a, robot.joints[0].d)] == ["0.12345678901234567", "1/3"]

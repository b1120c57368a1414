"""Robot files in the other convention, with the printed regrouping."""

import random
from dataclasses import replace

import pytest

from derive.exchange.convert import converted, moves
from derive.exchange.derivation import derivation_text
from derive.mechanics.convention import convert, has_equal_poses
from derive.robot.description import Convention
from derive.robot.expression import ONE
from derive.robot.robot import Robot
from derive.robot.writer import robot_text
from tests.random_robots import chains, swept, swept_catalogue
from tests.random_robots import robot_text as random_text
from tests.robot.test_writer import differing

ARM = """\
# Source: notes, page 3.
# Second line.
name: arm
title: "An arm"
convention: standard
units: {angle: deg, length: mm}
joints:
  - {type: revolute, alpha: 90, d: d1, limits: [-90, 90], speed: 180, torque: 30}
  - {type: prismatic, theta: 30, d: -q2 + 20, a: 100, alpha: alpha2 + 20, limits: [0, 300], speed: 500}
tool:
  - [0, -1, 0, 50]
  - [1, 0, 0, 0]
  - [0, 0, 1, lt]
  - [0, 0, 0, 1]
links:
  - {mass: 2, com: [0, -10, 0], inertia: {yy: 0.1, zz: 0.2}}
  - mass: 1
    com: [x2 - 100, 0, 5]
    inertia: {xx: 0.1, yz: 0.01}
    motor: {mass: 0.5, inertia: 0.001, ratio: 100}
parameters: {d1: 0.4, g: 9.81, lt: 0.1}
runtime: [lt]
style: by-geometry
handout:
  {parts: [table, kinematics], derivation: steps, language: it, notation: {angle: vartheta, inertia: M}, pages: 7}
figure: {q: [30, 200], values: {alpha2: 0.1, x2: 0.05}}
inverse: {task: [x, y], given: []}
"""
OTHER = {Convention.STANDARD: Convention.MODIFIED, Convention.MODIFIED: Convention.STANDARD}


def without_comments(text: str) -> str:
    return "\n".join(line for line in text.splitlines() if not line.startswith("#"))


@pytest.mark.first(10)
@pytest.mark.parametrize("name", chains())
def test_there_and_back_is_the_same_file_for_every_built_in_robot(name: str) -> None:
    robot = Robot.load(name)
    there = converted(robot, OTHER[robot.convention])
    back = converted(there.robot, robot.convention)
    assert differing(back.robot, robot) == []
    assert without_comments(back.text) == robot_text(robot).rstrip("\n")
    assert set(robot.comments) <= set(there.robot.comments)
    bare = converted(Robot.from_text(without_comments(there.text)), robot.convention)
    assert without_comments(bare.text) == robot_text(robot).rstrip("\n"), "no comment is needed"


@pytest.mark.parametrize("seed", [*range(8), *swept(*range(8, 200))])
def test_there_and_back_is_the_same_table_for_random_robots_with_tools_and_bases(seed: int) -> None:
    robot = Robot.from_text(random_text(random.Random(5000 + seed)))
    back = converted(converted(robot, OTHER[robot.convention]).robot, robot.convention).robot
    assert back.joints == robot.joints


def test_options_units_and_comments_are_kept_and_say_from_what_it_was_made_and_what_leads_back() -> None:
    robot = Robot.from_text(ARM)
    assert differing(Robot.from_text(robot_text(robot)), robot) == []
    there = converted(robot, Convention.MODIFIED, "arm-mdh")
    assert {*differing(there.robot, robot)} == {"name", "convention", "joints", "tool", "links"}
    assert "limits: [-90, 90], speed: 180, torque: 30" in there.text
    assert "alpha: 90, a: 0" not in there.text
    assert "{type: prismatic, q: q2, alpha: 90, theta: 30, d: -q2 + 20, limits: [0, 300], speed: 500}" in there.text
    assert there.robot.comments[-2:] == ("Source: notes, page 3.", "Second line.")
    back = converted(there.robot, Convention.STANDARD, "arm")
    assert differing(back.robot, robot) == []
    assert len(back.robot.comments) == len(there.robot.comments)
    there = converted(robot, Convention.MODIFIED)
    assert there.robot.comments[:2] == (
        f"Converted by derive from the standard table of arm (robot file {robot.digest[:16]}).",
        "Back with a = 0.1 m, alpha = alpha2 + pi/9 rad in the last row.",
    )
    assert there.robot.comments[2].startswith("Converted by derive: the rotor of joint 2 stands 0.02 further along")
    assert moves(there.conversion) == ["Trans(x, 0.1) Rot(x, alpha2 + pi/9) of row 2 is in the tool now"]
    back = converted(there.robot, Convention.STANDARD)
    assert moves(back.conversion) == ["row 2 has Trans(x, 0.1) Rot(x, alpha2 + pi/9) out of the tool"]


@pytest.mark.parametrize("spoilt", ["a = a9", "a = __import__('os')", "a = ", "a = 1/0", "a = 1e400", "a = sqrt(-1)"])
def test_a_comment_that_is_no_factor_of_this_robot_is_passed_over(spoilt: str) -> None:
    text = converted(Robot.from_text(ARM), Convention.MODIFIED).text.replace("a = 0.1", spoilt)
    back = converted(Robot.from_text(text), Convention.STANDARD)
    assert back.conversion.entering.is_one
    assert back.robot.joints[-1].type == "prismatic"


PLANAR = """\
standard: T = (Z_1 X_1) (Z_2 X_2) T_tool
modified: T = (X_0 Z_1) (X_1 Z_2) T'_tool
The factors are the same, the brackets are not: T'_base = T_base X_0^-1; T'_tool = X_2 T_tool.

factor  a   alpha  standard table  modified table
X_0     0   0      base            row 1
X_1     a1  0      row 1           row 2
X_2     a2  0      row 2           tool
"""


def test_a_planar_arm_is_regrouped_as_on_a_blackboard() -> None:
    text = derivation_text(convert(Robot.load("planar-2r-perugia")))
    assert text.partition("\n")[2].startswith(PLANAR)
    assert "\nA'_2 = X_1 Z_2, row 2 of the modified table =\n  c2  -s2  0  a1\n" in text
    assert "\n  link 2: [l2 - a2, 0, 0] is [l2, 0, 0] in the modified frame 2\n" in text
    assert text.endswith("are equal, entry by entry, in exact arithmetic.\n")


@pytest.mark.parametrize("name", swept_catalogue(usual=("skeleton-modified", "human-body", "spherical-wrist")))
def test_products_of_every_built_in_robot_are_equal_up_to_seven_rows(name: str) -> None:
    robot = Robot.load(name)
    conversion = convert(robot)
    if robot.n <= 7:
        assert has_equal_poses(conversion)
    text = derivation_text(conversion)
    assert ("are equal, entry by entry" in text) == (robot.n <= 7)
    assert ("rows are not multiplied out" in text) == (robot.n > 7)


def test_it_is_said_where_numbers_are_printed_shorter_than_they_are() -> None:
    text = "{{name: arm, convention: standard, joints: [{{type: revolute, a: {}}}, {{type: revolute, a: 0.25}}]}}"
    long, short = (Robot.from_text(text.format(length)) for length in ("0.123456789", "0.125"))
    said = "Matrices are printed with 6 significant digits of each number."
    assert said in derivation_text(convert(long))
    assert said not in derivation_text(convert(short))


def test_a_wrong_table_is_not_called_equal() -> None:
    conversion = convert(Robot.load("planar-2r-perugia"))
    wrong = replace(conversion.result.joints[1], a=ONE)
    spoilt = replace(conversion, result=replace(conversion.result, joints=(conversion.result.joints[0], wrong)))
    assert not has_equal_poses(spoilt)
    assert "are DIFFERENT, entry by entry" in derivation_text(spoilt)

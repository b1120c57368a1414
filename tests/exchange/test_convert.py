"""Robot files in the other convention: there and back the same file, up to comments; every option and unit kept."""

from __future__ import annotations

import random
from dataclasses import fields

import pytest

from derive.errors import DeriveError, RobotFileError
from derive.exchange.convert import convention_named, converted, moves
from derive.robot.description import Convention
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.robot.writer import robot_text
from tests.random_robots import robot_text as random_text
from tests.random_robots import seeds

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


def differing(ours: Robot, theirs: Robot) -> list[str]:
    """Data that differ, but for what tells one file from another."""
    told = [part.name for part in fields(ours) if part.compare and part.name not in ("digest", "source")]
    return [name for name in told if getattr(ours, name) != getattr(theirs, name)]


@pytest.mark.parametrize("name", catalogue_names())
def test_there_and_back_is_the_same_file_for_every_built_in_robot(name: str) -> None:
    robot = Robot.load(name)
    there = converted(robot, OTHER[robot.convention])
    back = converted(there.robot, robot.convention)
    assert differing(back.robot, robot) == []
    assert without_comments(back.text) == robot_text(robot).rstrip("\n")
    assert set(robot.comments) <= set(there.robot.comments)
    bare = converted(Robot.from_text(without_comments(there.text)), robot.convention)
    assert without_comments(bare.text) == robot_text(robot).rstrip("\n"), "no comment is needed"


@pytest.mark.parametrize("seed", seeds(200, usual=8))
def test_there_and_back_is_the_same_table_for_random_robots_with_tools_and_bases(seed: int) -> None:
    robot = Robot.from_text(random_text(random.Random(5000 + seed)))
    back = converted(converted(robot, OTHER[robot.convention]).robot, robot.convention).robot
    assert back.joints == robot.joints


def test_options_units_and_comments_are_kept() -> None:
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


def test_comments_say_from_what_it_was_made_and_what_leads_back() -> None:
    robot = Robot.from_text(ARM)
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


@pytest.mark.parametrize("convention", ["modifed", "Craig", "", "sdh\n"])
def test_an_unknown_convention_is_refused_with_those_that_there_are(convention: str) -> None:
    with pytest.raises(DeriveError, match=r"unknown convention .*; allowed: standard \(distal\), modified \(Craig"):
        convention_named(convention)


def test_a_table_that_has_the_convention_already_is_refused() -> None:
    with pytest.raises(DeriveError, match="arm has a standard table already; write --convention modified"):
        converted(Robot.from_text(ARM), Convention.STANDARD)


@pytest.mark.parametrize("name", ["My Arm", "import", "", "a/b"])
def test_a_name_that_no_robot_may_have_is_refused(name: str) -> None:
    with pytest.raises(RobotFileError, match="is not a robot name"):
        converted(Robot.from_text(ARM), Convention.MODIFIED, name)

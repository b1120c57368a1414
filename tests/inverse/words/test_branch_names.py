"""Branches are called what the arm looks like: seen from outside, whatever formula they come from."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from derive.inverse.words.branch_names import Placed, Shape, Word, placed
from derive.mechanics.chain import build_chain
from derive.mechanics.floats import FloatDomain
from derive.model.model import Model
from derive.robot.robot import Robot

NUMBERS = {"a1": 0.5, "a2": 0.4, "a3": 0.3, "d3": 0.15, "d4": 0.4, "d2": 0.15, "d6": 0.1}


def looked_at(robot: Robot, q: list[float]) -> Placed:
    chain = build_chain(replace(robot, links=(), gravity=None), FloatDomain(robot, q, NUMBERS))
    return placed(chain, q, 1)[0]


def words(robot: Robot, q: list[float]) -> set[str | None]:
    return set(Shape(robot, looked_at(robot, [0.3] * robot.n), None).words(looked_at(robot, q)))


def test_of_a_planar_arm_that_reaches_to_the_right_the_elbow_is_above_the_line_to_the_hand() -> None:
    arm = Robot.from_text(
        "name: arm\nconvention: standard\njoints: [{type: revolute, a: a1}, {type: revolute, a: a2}]\n"
    )
    assert Word.ELBOW_UP in words(arm, [math.pi / 4, -math.pi / 2])
    assert Word.ELBOW_DOWN in words(arm, [-math.pi / 4, math.pi / 2])


def test_a_scara_has_its_elbow_to_the_left_or_right_of_the_line_to_the_hand() -> None:
    arm = Robot.load("scara-perugia")
    assert Word.ELBOW_RIGHT in words(arm, [-0.5, 1.0, 0.1, 0.0])
    assert Word.ELBOW_LEFT in words(arm, [0.5, -1.0, 0.1, 0.0])


def test_of_an_articulated_arm_the_elbow_is_up_where_it_is_above_the_wrist_and_the_shoulder() -> None:
    """Upper arm 45 degrees upwards, forearm 45 degrees downwards."""
    arm = Robot.load("puma560-corke")
    assert Word.ELBOW_UP in words(arm, [0.0, math.pi / 4, math.pi, 0.3, 0.4, 0.5])
    assert Word.ELBOW_DOWN in words(arm, [0.0, -math.pi / 4, 0.0, 0.3, 0.4, 0.5])


def test_a_wrist_is_flipped_where_its_middle_joint_turns_backwards() -> None:
    arm = Robot.load("puma560-corke")
    assert Word.WRIST in words(arm, [0.0, math.pi / 4, math.pi, 0.3, 0.4, 0.5])
    assert Word.WRIST_FLIPPED in words(arm, [0.0, math.pi / 4, math.pi, 0.3, -0.4, 0.5])


NAMES = {
    "planar-3r": {"elbow up", "elbow down"},
    "spherical-wrist": {"wrist flipped", "wrist not flipped"},
    "puma560-corke": {
        f"shoulder {shoulder}, elbow {elbow}, wrist {wrist}"
        for shoulder in ("left", "right")
        for elbow in ("up", "down")
        for wrist in ("flipped", "not flipped")
    },
}


@pytest.mark.parametrize("robot", NAMES)
def test_every_branch_has_a_name_of_its_own(robot: str) -> None:
    found = [solution.name for solution in Model(Robot.load(robot)).inverse.solutions]
    assert len(found) == len(set(found))
    assert set(found) == NAMES[robot]

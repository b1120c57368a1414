"""Pose, link frames and Jacobian by the cheapest ways are those of the plain formulas, for fewer operations."""

import random

import numpy as np
import pytest

from derive.mechanics.forward_kinematics import forward_kinematics, jacobian, link_transforms
from derive.programs.build import build_program
from derive.programs.formulations.cheapest_kinematics import cheapest_jacobian, cheapest_links, cheapest_pose
from derive.programs.formulations.trace import Trace, flat
from derive.programs.tape.tape import Operations
from derive.robot.robot import Robot
from tests.programs.parallel_arms import numbers, parallel_arm
from tests.random_robots import random_robot

SQUARE = ["alpha: pi/2", "alpha: -pi/2", "d: d3, alpha: -pi/2", "alpha: pi/2", "d: d5, alpha: pi/2", "alpha: -pi/2", ""]
PUMA = ["alpha: pi/2", "a: a2", "a: a3, d: d3, alpha: -pi/2", "d: d4, alpha: pi/2", "alpha: -pi/2", ""]


def assert_same_kinematics(trace: Trace) -> None:
    chain, stations = trace.chain, trace.stations
    assert stations is not None
    pairs = [
        ([cheapest_pose(stations)], [forward_kinematics(chain)]),
        (cheapest_links(stations), link_transforms(chain)),
    ]
    outputs = [
        tuple([v for frame in frames for v in flat(frame.rows(chain.zero, chain.one))] for frames in pair)
        for pair in pairs
    ]
    outputs.append((flat(cheapest_jacobian(stations)), flat(jacobian(chain))))
    for found, wanted in outputs:
        assert np.abs(numbers(trace, found) - numbers(trace, wanted)).max() < 1e-13 * 4**trace.n


@pytest.mark.parametrize("seed", range(12))
def test_parallel_arms(seed: int) -> None:
    assert_same_kinematics(parallel_arm(seed))


@pytest.mark.parametrize("seed", range(12))
def test_any_arm(seed: int) -> None:
    robot = Robot.from_text(random_robot(random.Random(seed), dynamics=False).text)
    assert_same_kinematics(Trace(robot))


def test_long_arms() -> None:
    assert_same_kinematics(parallel_arm(3, joints=24))


def revolute(joints: list[str], extra: str = "") -> Robot:
    text = "\n".join(f"  - {{type: revolute, {row}}}" for row in joints)
    return Robot.from_text(f"name: arm\nconvention: standard\njoints:\n{text}\n{extra}")


@pytest.mark.parametrize(
    ("joints", "pose", "links", "columns"),
    [(SQUARE, 84, 99, 83), (PUMA, 60, 78, 45), (["a: a1", "a: a2"], 7, 7, 7), (["a: a1"] * 4, 11, 17, 17)],
    ids=["7R", "PUMA", "2R", "4R"],
)
def test_counts(joints: list[str], pose: int, links: int, columns: int) -> None:
    program = build_program(revolute(joints))
    names = ("forward_kinematics", "link_transforms", "jacobian")
    assert [program[name].operations.arithmetic for name in names] == [pose, links, columns]


def test_a_planar_arm_needs_a_sine_and_a_cosine_per_joint() -> None:
    program = build_program(revolute(["a: a1", "a: a2"]))
    assert program["forward_kinematics"].operations == Operations(mul=4, add=3, sin=2, cos=2)


def test_a_tool_that_is_a_rotation_in_six_places_is_taken_as_written() -> None:
    tool = "tool: [[0.8660254, -0.5, 0, 0.2], [0.5, 0.8660254, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
    trace = Trace(revolute(PUMA, tool))
    assert trace.stations is None
    assert build_program(trace.robot)["jacobian"].operations.arithmetic > 0

"""The independent recursion agrees with Pinocchio on random robots, from the text of the robot file on."""

import random

import numpy as np
import pytest
from hypothesis import given, settings

from derive.robot.robot import Robot
from derive.verification.oracle.functions import ANGLES, FUNCTIONS, Oracle
from derive.verification.oracle.rates import distance_from_singularity
from tests.random_robots import RandomRobot, configurations, random_robot, robots
from tests.verification.oracle.pinocchio_reference import Array, Reference, reference

TOLERANCE = 1e-10


def motion(n: int, seed: int = 0) -> dict[str, Array]:
    q, qd, qdd, tau = configurations(random.Random(seed), n, 4)
    return {"q": q, "qd": qd, "qdd": qdd, "tau": 20 * tau}


def relative_error(got: Array, wanted: Array) -> float:
    assert got.shape == wanted.shape
    return float(np.abs(got - wanted).max() / max(1.0, np.abs(wanted).max()))


def check(oracle: Oracle, outside: Reference, arguments: dict[str, Array]) -> None:
    for name in oracle.functions:
        q, *rates = (arguments[argument] for argument in FUNCTIONS[name].arguments)
        distance = distance_from_singularity(oracle.arm, ANGLES[name], q) if name in ANGLES else 1.0
        got, wanted = oracle.evaluate(name, q, *rates), getattr(outside, name)(q, *rates)
        assert relative_error(got, wanted) * distance < TOLERANCE, name


@given(robots())
@settings(max_examples=80, deadline=None)
def test_every_function_agrees_with_pinocchio(robot: RandomRobot) -> None:
    oracle, outside = Oracle.of(Robot.from_text(robot.text), robot.values), reference(robot)
    check(oracle, outside, motion(robot.n))


@given(robots(dynamics=False))
@settings(max_examples=30, deadline=None)
def test_kinematics_agrees_without_dynamics(robot: RandomRobot) -> None:
    oracle, outside = Oracle.of(Robot.from_text(robot.text), robot.values), reference(robot)
    assert set(oracle.functions) <= {name for name, definition in FUNCTIONS.items() if not definition.dynamic}
    check(oracle, outside, motion(robot.n))


@pytest.mark.parametrize("standard", [True, False])
def test_kinematics_agrees_for_64_joints(standard: bool) -> None:
    robot = random_robot(random.Random(64), 64, standard=standard, dynamics=False)
    check(Oracle.of(Robot.from_text(robot.text), robot.values), reference(robot), motion(64))


def test_the_sample_of_robots_covers_the_format() -> None:
    """Else agreement would mean little: every feature occurs often among the first 200 seeds."""
    sample = [random_robot(random.Random(seed)) for seed in range(200)]
    joints = [joint for robot in sample for joint in robot.joints]
    links = [link for robot in sample for link in robot.links]
    text = "\n".join(robot.text for robot in sample)
    assert sum(robot.standard for robot in sample) in range(60, 140)
    assert {robot.n for robot in sample} == set(range(1, 8))
    for feature in (
        [joint for joint in joints if not joint.revolute],
        [joint for joint in joints if joint.sign < 0 and joint.revolute],
        [joint for joint in joints if joint.sign < 0 and not joint.revolute],
        [joint for joint in joints if joint.revolute and joint.theta],
        [link for link in links if link.rotor_inertia],
        [link for link in links if link.ratio < 0],
        [link for link in links if link.armature],
        [link for link in links if link.coulomb],
        [robot for robot in sample if (robot.base != np.eye(4)).any()],
        [robot for robot in sample if (robot.tool != np.eye(4)).any()],
        [robot for robot in sample if robot.gravity[0]],
        [robot for robot in sample if robot.values],
    ):
        assert len(feature) >= 20
    for word in ("deg", "mm", "runtime", "sqrt(", "sin(", "limits", "armature", "viscous"):
        assert text.count(word) >= 20, word


@given(robots())
@settings(max_examples=25, deadline=None)
def test_a_batch_is_its_configurations_one_by_one(robot: RandomRobot) -> None:
    oracle = Oracle.of(Robot.from_text(robot.text), robot.values)
    rng = random.Random(1)
    q, qd, last = (configurations(rng, robot.n, 6).reshape(2, 3, robot.n) for _ in range(3))
    for name in oracle.functions:
        arguments = [q, qd, last][: len(FUNCTIONS[name].arguments)]
        together = oracle.evaluate(name, *arguments)
        alone = oracle.evaluate(name, *(argument[1, 2] for argument in arguments))
        assert relative_error(together[1, 2], alone) < 1e-12

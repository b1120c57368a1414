"""The oracle's own parts against what they are defined by: frames, Jacobians, motions and regressors."""

import numpy as np
import pytest

from derive.model.identification.base_parameters import base_set
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle import frames, newton
from derive.verification.oracle.frames import Array, NumericArm, numeric_arm
from derive.verification.oracle.functions import FUNCTIONS, Oracle
from derive.verification.oracle.identification import Identification

NAMES = ("scara-perugia", "stanford-deluca", "kuka-kr5", "puma560-corke")
STEP = 1e-6


def numbers_for(robot: Robot) -> dict[str, float]:
    return {symbol: 0.3 + 0.1 * place for place, symbol in enumerate(free_symbols(robot))}


def arm_of(name: str) -> NumericArm:
    robot = Robot.load(name)
    return numeric_arm(robot, numbers_for(robot))


def configurations(arm: NumericArm, count: int = 5) -> Array:
    return np.random.default_rng(4).uniform(-1.0, 1.0, (count, arm.n))


@pytest.mark.parametrize("name", NAMES)
def test_motions_of_links_are_differences_of_their_frames(name: str) -> None:
    """Velocities by J qd, accelerations by a second difference along a motion."""
    arm = arm_of(name)
    q, qd, qdd = (scale * configurations(arm) for scale in (1.0, 0.7, -1.3))
    times = np.array([-1.0, 0.0, 1.0]) * 1e-4
    places = [frames.chain_frames(arm, q + qd * t + 0.5 * qdd * t * t)[:, -1, :3, 3] for t in times]
    measured = (places[0] - 2 * places[1] + places[2]) / 1e-8
    chain = frames.chain_frames(arm, q)
    axis, _ = frames.joint_axes(arm, chain)
    last = newton.link_motions(arm, chain, axis, qd, qdd)[-1]
    assert np.allclose(last.acceleration_at(chain[:, -1, :3, 3]), measured, atol=1e-5)


@pytest.mark.parametrize("name", ["scara-perugia", "planar-2r-perugia"])
def test_regressors_give_the_torques_of_newton_and_euler(name: str) -> None:
    robot = Robot.load(name)
    oracle = Oracle.of(robot, numbers_for(robot), base_set(robot).parameters)
    assert isinstance(oracle.identification, Identification)
    q, qd, qdd = (scale * configurations(oracle.arm) for scale in (1.0, 0.7, -1.3))
    base = oracle.evaluate("base_regressor", q, qd, qdd) @ oracle.evaluate("base_parameters")
    assert np.allclose(base, oracle.evaluate("inverse_dynamics", q, qd, qdd), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", ["scara-perugia", "planar-2r-perugia"])
def test_values_have_the_axes_of_their_definitions(name: str) -> None:
    robot = Robot.load(name)
    oracle = Oracle.of(robot, numbers_for(robot), base_set(robot).parameters)
    q = np.zeros(robot.n)
    for function in oracle.functions:
        definition = FUNCTIONS[function]
        assert oracle.evaluate(function, *(q for _ in definition.arguments)).ndim == definition.axes, function

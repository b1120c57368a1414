"""An arm of numbers against the independent recursion: its pose, and the slopes of the pose."""

from __future__ import annotations

import numpy as np

from derive.inverse.numeric.chain import NumericChain
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm

RNG = np.random.default_rng(3)


def oracle_arm(robot, parameters):
    """The oracle's arm; masses and the like do not matter."""
    return numeric_arm(robot, {**dict.fromkeys(free_symbols(robot), 1.0), **parameters})


def test_pose_and_slopes_are_those_of_the_independent_recursion():
    robot = Robot.load("stanford-deluca")
    values = {"d1": 0.4, "d2": 0.15, "d6": 0.26}
    chain, arm = NumericChain.of(robot, values), oracle_arm(robot, values)
    q = RNG.uniform(-2, 2, (3, 6))
    pose, slope = chain.pose_and_jacobian(q)
    assert np.allclose(pose, forward_kinematics(arm, q), atol=1e-14)
    step = 1e-30j * np.eye(6)
    exact = forward_kinematics(arm, q[:, None, :] + step).imag[..., :3, :] / 1e-30
    assert np.allclose(slope, exact, atol=1e-13)

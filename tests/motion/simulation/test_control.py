"""Control laws."""

from __future__ import annotations

import numpy as np
import pytest

from derive.motion.simulation.stages import NEEDS, Controller
from derive.motion.torques.functions import Functions
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

WANTED, QD, QDD = np.array([0.4, -0.7]), np.array([0.2, 0.3]), np.array([-1.0, 2.0])
Q, SPEED = np.array([0.5, -0.4]), np.array([0.1, -0.2])
ARM = """{name: arm, convention: standard, gravity: [0, -9.81, 0],
  joints: [{type: revolute, a: 1}, {type: revolute, a: 1}], links: [{mass: 1}, {mass: 2}]}"""


def torque(law: str) -> np.ndarray:
    functions = Functions(Robot.from_text(ARM), NEEDS[law], {}) if NEEDS[law] else None
    kp, kd = np.array([100.0, 50]), np.array([20.0, 10])
    return Controller(law, kp, kd, lambda _: (WANTED, QD, QDD), functions)(0.0, Q, SPEED)


def test_laws_are_those_of_their_books() -> None:
    oracle = Oracle.of(Robot.from_text(ARM))
    pull = np.array([100.0, 50]) * (WANTED - Q) + np.array([20.0, 10]) * (QD - SPEED)
    assert torque("none").tolist() == [0, 0]
    assert torque("pd") == pytest.approx(pull)
    assert torque("pd-gravity") == pytest.approx(pull + oracle.evaluate("gravity_vector", Q))
    expected = oracle.evaluate("inverse_dynamics", Q, SPEED, QDD + pull)
    assert torque("computed-torque") == pytest.approx(expected)

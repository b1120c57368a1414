"""The example of model predictive control swings its arm up, within its torques and within a minute."""

import time

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.examples.loading import loaded


@pytest.mark.slow
def test_the_arm_swings_up_within_a_minute(capsys: pytest.CaptureFixture[str]) -> None:
    example = loaded("mpc_casadi")
    started = time.process_time()
    assert example.main() == 0
    assert time.process_time() - started < 60
    assert capsys.readouterr().out.startswith("standing after")


def test_the_motors_are_too_weak_to_lift_the_arm() -> None:
    example = loaded("mpc_casadi")
    oracle = Oracle.of(Robot.load(str(example.ROBOT)), {})
    level = oracle.evaluate("gravity_vector", np.zeros((1, 2)))[0]
    assert level[0] > 2 * example.LIMITS[0]

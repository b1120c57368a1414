"""The example of model predictive control swings its arm up, within its torques and within a minute."""

from __future__ import annotations

import importlib.util
import sys
import time
from types import ModuleType

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.places import ROOT

EXAMPLE = ROOT / "examples" / "mpc_casadi.py"


def loaded() -> ModuleType:
    spec = importlib.util.spec_from_file_location("mpc_casadi", EXAMPLE)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_the_arm_swings_up_within_a_minute(capsys: pytest.CaptureFixture[str]) -> None:
    example = loaded()
    started = time.process_time()
    assert example.main() == 0
    assert time.process_time() - started < 60
    assert capsys.readouterr().out.startswith("standing after")


def test_the_motors_are_too_weak_to_lift_the_arm() -> None:
    example = loaded()
    oracle = Oracle.of(Robot.load(str(example.ROBOT)), {})
    level = oracle.evaluate("gravity_vector", np.zeros((1, 2)))[0]
    assert level[0] > 2 * example.LIMITS[0]

"""The examples of motions do what they say; each tells by its status whether its own figures hold."""

import importlib
import sys
import time
from types import ModuleType
from unittest import mock

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.places import ROOT

EXAMPLES = ROOT / "examples"

SAID = {
    "computed_torque": "1.00 s: largest error 2.00e-04 rad",
    "five_bar": "motor 1 moves link 2 by 7.7\\% of link 1",
    "bimanual": "1.00 s: left hand 0.084 mm off, right hand 0.096 mm",
    "pd_gravity": "simulated error [10.738052  0.106382] mrad",
    "pick_and_place": "rest -> A: speed 5*pi/16 = 0.9817 at 1.50 s, torque 376.8 at 0.62 s, work 18.0 J",
    "skeleton_reach": "one radian moves the hand 0.4957 m about the root, 0.2500 m about the joint of l1",
    "mpc_path": "of [9. 6.]",
}


def loaded(name: str) -> ModuleType:
    with mock.patch.object(sys, "path", [str(EXAMPLES), *sys.path]):
        return importlib.import_module(name)


@pytest.mark.parametrize("name", SAID)
@pytest.mark.first(4)
def test_an_example_reaches_its_own_figures(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert loaded(name).main() == 0
    assert SAID[name] in capsys.readouterr().out


def test_the_error_of_computed_torque_follows_the_formula_of_a_critically_damped_mass() -> None:
    example = loaded("computed_torque")
    run = example.follow(Motion.load(example.PLAN))
    assert run.error == pytest.approx(run.expected, abs=1e-8)
    assert np.abs(run.error[0]).max() == pytest.approx(0.4)


def test_what_stays_of_the_error_under_pd_and_gravity_is_the_weight_that_the_model_lacks() -> None:
    """Kp e is the weight of half a kilogram that has its centre in the middle of the second link."""
    example = loaded("pd_gravity")
    motion = Motion.load(example.PLAN)
    error = example.predicted_error(motion)
    q1, q2 = motion(motion.duration)[0] - error
    weight = 0.5 * 9.81 * np.array([0.5 * np.cos(q1) + 0.2 * np.cos(q1 + q2), 0.2 * np.cos(q1 + q2)])
    assert error == pytest.approx(weight / [200, 100], abs=1e-12)


def test_small_steps_of_the_skeleton_err_by_the_order_of_the_step() -> None:
    example = loaded("skeleton_reach")
    q, target = np.array([-0.6, 0.9]), np.array([0.20, 0.35])
    errors = [example.reach(q, target, steps)[1] for steps in (100, 200, 400)]
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(2, rel=0.05)
    assert example.reach(q, target, 100, corrected=True)[1] < 1e-12
    lengths = np.sqrt(0.25**2 + 0.3**2 + 2 * 0.25 * 0.3 * np.cos(0.9)), 0.25
    assert example.levers(q) == pytest.approx(lengths, rel=1e-14)


def test_every_plan_beside_the_examples_is_one() -> None:
    plans = [path for path in sorted(EXAMPLES.glob("*.yaml")) if path.name != "swing-up.yaml"]
    assert len(plans) >= 5
    for path in plans:
        assert Motion.load(path).duration > 0


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

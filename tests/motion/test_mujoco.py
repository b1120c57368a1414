"""Simulations against MuJoCo, which has the arm from its MJCF; its accelerations are tested where that is written."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.exchange.formats import exported
from derive.motion.motion import Motion
from derive.robot.expression import number
from derive.robot.robot import Robot
from tests.exchange.arms import dressed
from tests.random_robots import chains

mujoco = pytest.importorskip("mujoco")

TIME, STEP = 10.0, 1e-3
PLAN = f"robot: planar-3r\npoints: {{a: [0, 0, 0]}}\npath: [a, {{to: a, time: {TIME}}}]\nsample: 0.05\nfriction: none\n"


def motions_agree(robot: Robot, inertia: str) -> None:
    model = mujoco.MjModel.from_xml_string(exported(robot, "mjcf", inertia).text)
    model.opt.timestep, model.opt.integrator = STEP, mujoco.mjtIntegrator.mjINT_RK4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT  # limits and dry friction
    data = mujoco.MjData(model)
    start = np.random.default_rng(2).uniform(-1, 1, robot.n)
    data.qpos[:] = start
    places = []
    for _ in range(int(TIME / 0.05)):
        mujoco.mj_step(model, data, nstep=round(0.05 / STEP))
        places.append(np.array(data.qpos))
    plan = Motion.from_text(PLAN).plan
    point = replace(plan.points["a"], q=tuple(number(Fraction(float(cell))) for cell in start))
    gains = (number(0),) * robot.n
    control = replace(plan.control, kp=gains, kd=gains)
    run = Motion(replace(plan, robot=robot, points={"a": point}, control=control)).simulate()
    assert run.reached
    assert np.abs(run.q[1:] - places).max() <= 1e-9
    assert np.ptp(run.q, axis=0).max() > 0.5


def test_puma_moves_for_ten_seconds_as_in_mujoco() -> None:
    pytest.importorskip("clarabel")
    motions_agree(Robot.load("puma560-corke"), "possible")


@pytest.mark.sweep
@pytest.mark.parametrize("name", chains())
def test_every_robot_moves_as_in_mujoco(name: str) -> None:
    motions_agree(dressed(name, calm=True), "given")

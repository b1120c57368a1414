"""Simulations against MuJoCo, which knows the arm by an MJCF written here from the table."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.arrays import Array
from derive.motion.motion import Motion
from derive.robot.description import Inertia
from derive.robot.evaluate import parameter_values
from derive.robot.expression import number
from derive.robot.load import catalogue_names
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from tests.motion.mjcf import mjcf
from tests.motion.random_arms import decimal, numbered

mujoco = pytest.importorskip("mujoco")

TIME = 10.0
STEP = 1e-3


def possible_puma() -> Robot:
    """PUMA 560 with the same dynamics as Corke's, and bodies that exist.

    The mass of link 1 and its moments across its axis do not enter. Joint 3 turns about y of frame 3 and about z of
    frame 2: moments across it may move from link 2 to link 3.
    """
    robot = Robot.load("puma560-corke")
    links = list(robot.links)
    links[0] = replace(links[0], mass=number(1), inertia=Inertia(decimal(0.35), decimal(0.35), decimal(0.35)))
    links[1] = replace(links[1], inertia=Inertia(decimal(0.126), decimal(0.52), decimal(0.539)))
    links[2] = replace(links[2], inertia=Inertia(decimal(0.07), decimal(0.086), decimal(0.0165)))
    return replace(robot, links=tuple(links))


def values_of(robot: Robot) -> dict[str, float]:
    assert not free_symbols(robot)
    return {name: float(value) for name, value in parameter_values(robot).items()}


def motions_agree(ours: Robot, theirs: Robot, start: Array) -> None:
    model = mujoco.MjModel.from_xml_string(mjcf(theirs, values_of(theirs), STEP))
    data = mujoco.MjData(model)
    data.qpos[:] = start
    places = []
    for _ in range(int(TIME / 0.05)):
        mujoco.mj_step(model, data, nstep=round(0.05 / STEP))
        places.append(np.array(data.qpos))
    text = "robot: planar-3r\npoints: {a: [0, 0, 0]}\npath: [a, {to: a, time: TIME}]\nsample: 0.05\nfriction: none\n"
    plan = Motion.from_text(text.replace("TIME", repr(TIME))).plan
    point = replace(plan.points["a"], q=tuple(number(Fraction(float(cell))) for cell in start))
    gains = (number(0),) * ours.n
    run = Motion(
        replace(plan, robot=ours, points={"a": point}, control=replace(plan.control, kp=gains, kd=gains))
    ).simulate()
    assert run.reached
    assert np.abs(run.q[1:] - places).max() <= 1e-9
    assert np.ptp(run.q, axis=0).max() > 0.5


def test_puma_moves_for_ten_seconds_as_in_mujoco() -> None:
    motions_agree(Robot.load("puma560-corke"), possible_puma(), np.array([0.3, 0.8, -1.2, 0.4, 0.5, 0.6]))


@pytest.mark.sweep
@pytest.mark.parametrize("name", catalogue_names())
def test_every_robot_moves_as_in_mujoco(name: str) -> None:
    robot = numbered(name)
    motions_agree(robot, robot, np.random.default_rng(2).uniform(-1, 1, robot.n))

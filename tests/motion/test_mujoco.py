"""Simulations against MuJoCo, which knows the arm by an MJCF written here from the table."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.motion.functions import Functions
from derive.motion.hermite import Array
from derive.motion.motion import Motion
from derive.robot.description import Inertia, Link
from derive.robot.evaluate import parameter_values
from derive.robot.expression import Expression, number
from derive.robot.load import catalogue_names
from derive.robot.names import free_symbols, robot_symbols
from derive.robot.robot import Robot
from tests.motion.mjcf import mjcf

mujoco = pytest.importorskip("mujoco")

TIME = 10.0
STEP = 1e-3


def decimal(value: float) -> Expression:
    return number(Fraction(round(value * 10000), 10000))


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


def numbered(name: str) -> Robot:
    """A robot of the catalogue with numbers for its symbols, and links of random possible bodies without rotors.

    Friction grows with what a joint carries: long chains without it are chaotic, and no two methods agree for 10 s.
    """
    robot, random = Robot.load(name), np.random.default_rng(len(name))

    def link(carried: int) -> Link:
        spread = random.normal(size=(3, 3)) / 5
        second = spread @ spread.T + 0.01 * np.eye(3)
        moments = np.trace(second) * np.eye(3) - second
        cells = (decimal(moments[at]) for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        com = tuple(decimal(c) for c in random.uniform(-0.2, 0.2, 3))
        armature, viscous = decimal(random.uniform(0.2, 0.4)), decimal(carried * random.uniform(1, 3))
        mass = decimal(random.uniform(1, 3))
        return Link(mass, com, Inertia(*cells), armature=armature, viscous=viscous)  # type: ignore[arg-type]

    gravity = (decimal(0.3), decimal(-9.1), decimal(-2.7))
    dressed = replace(robot, links=tuple(link(robot.n - i) for i in range(robot.n)), gravity=gravity)
    symbols = {symbol: decimal(random.uniform(0.3, 0.9)) for symbol in robot_symbols(dressed)}
    return replace(dressed, parameters=tuple(symbols.items()), runtime=())


def values_of(robot: Robot) -> dict[str, float]:
    assert not free_symbols(robot)
    return {name: float(value) for name, value in parameter_values(robot).items()}


def accelerations_agree(ours: Robot, theirs: Robot) -> None:
    model = mujoco.MjModel.from_xml_string(mjcf(theirs, values_of(theirs), STEP))
    data = mujoco.MjData(model)
    functions = Functions(ours, frozenset({"forward_dynamics"}), values_of(ours))
    random = np.random.default_rng(1)
    for _ in range(50):
        q, qd = random.uniform(-3, 3, ours.n), random.uniform(-2, 2, ours.n)
        tau = random.uniform(-20, 20, ours.n)
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, qd, tau
        mujoco.mj_forward(model, data)
        expected = np.array(data.qacc)
        found = functions("forward_dynamics", q, qd, tau)
        assert np.abs(found - expected).max() <= 1e-12 * max(1, np.abs(expected).max())


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


def test_puma_accelerates_and_moves_for_ten_seconds_as_in_mujoco() -> None:
    ours, theirs = Robot.load("puma560-corke"), possible_puma()
    accelerations_agree(ours, theirs)
    motions_agree(ours, theirs, np.array([0.3, 0.8, -1.2, 0.4, 0.5, 0.6]))


def test_an_arm_with_a_slide_accelerates_as_in_mujoco() -> None:
    robot = numbered("stanford-deluca")
    accelerations_agree(robot, robot)


@pytest.mark.sweep
@pytest.mark.parametrize("name", catalogue_names())
def test_every_robot_accelerates_and_moves_as_in_mujoco(name: str) -> None:
    robot = numbered(name)
    accelerations_agree(robot, robot)
    motions_agree(robot, robot, np.random.default_rng(2).uniform(-1, 1, robot.n))

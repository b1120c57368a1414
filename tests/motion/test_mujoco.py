"""Simulations against MuJoCo, which knows the arm by an MJCF written here from the table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.arrays import Array
from derive.motion.motion import Motion
from derive.motion.torques.functions import Functions
from derive.robot.description import Inertia
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import ZERO, number
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


def possible_scara() -> Robot:
    """The SCARA of document 004 with the same dynamics, and a link 2 that exists: it turns about z alone."""
    robot = Robot.load("scara-matlab")
    links = list(robot.links)
    links[1] = replace(links[1], inertia=replace(links[1].inertia, xx=decimal(0.15), yy=decimal(0.15)))
    return replace(robot, links=tuple(links))


def spins(robot: Robot) -> list[tuple[float, list[float]]]:
    """Of an arm whose axes are all vertical: inertia of each rotor, and its speed by those of the joints."""
    values, up, found = values_of(robot), 1.0, []
    for i, (joint, link) in enumerate(zip(robot.joints, robot.links, strict=True)):
        carried = [up if other.is_revolute else 0.0 for other in robot.joints[:i]]
        ratio = evaluate(link.motor.ratio, values)
        found.append((evaluate(link.motor.inertia, values), [*carried, ratio]))
        if joint.alpha != ZERO:
            assert i == 1, "axes point down from frame 2 on"
            up = -up
    return found


def values_of(robot: Robot) -> dict[str, float]:
    assert not free_symbols(robot)
    return {name: float(value) for name, value in parameter_values(robot).items()}


def accelerations_agree(ours: Robot, theirs: Robot, rotors: Sequence[tuple[float, list[float]]] = ()) -> None:
    model = mujoco.MjModel.from_xml_string(mjcf(theirs, values_of(theirs), STEP, rotors))
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


def test_arms_with_a_slide_and_with_motors_accelerate_as_in_mujoco() -> None:
    robot = numbered("stanford-deluca")
    accelerations_agree(robot, robot)
    ours, theirs = Robot.load("scara-matlab"), possible_scara()
    accelerations_agree(ours, theirs, spins(theirs))


def test_bodies_that_do_not_exist_are_refused_by_mujoco() -> None:
    """All other robots of the catalogue leave their masses open."""
    with_dynamics = (robot for robot in map(Robot.load, catalogue_names()) if robot.has_dynamics)
    assert {r.name for r in with_dynamics if not free_symbols(r)} == {"puma560-corke", "scara-matlab"}
    for name, reason in (("puma560-corke", r"positive eigenvalues"), ("scara-matlab", r"A \+ B >= C")):
        robot = Robot.load(name)
        with pytest.raises(ValueError, match=reason):
            mujoco.MjModel.from_xml_string(mjcf(robot, values_of(robot), STEP))


@pytest.mark.sweep
@pytest.mark.parametrize("name", catalogue_names())
def test_every_robot_accelerates_and_moves_as_in_mujoco(name: str) -> None:
    robot = numbered(name)
    accelerations_agree(robot, robot)
    motions_agree(robot, robot, np.random.default_rng(2).uniform(-1, 1, robot.n))

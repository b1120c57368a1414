"""Motions and simulations of robots with coupled joints and with closed loops."""

from dataclasses import replace

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.motion.motion import Motion
from derive.motion.output.printed import diverged, samples
from derive.motion.torques.functions import Functions
from derive.plans.catalogue import new_plan_text
from derive.robot.expression import number
from derive.robot.robot import Robot
from tests.random_robots import swept

FOUR_BAR = "robot: four-bar\npoints: {a: [1], b: [0.7]}\npath: [a, {to: b, time: 2}]\n"
COMPUTED = "control: {law: computed-torque, kp: 900, kd: 60}"


@pytest.mark.first(1)
@pytest.mark.parametrize("name", ["palletiser", "four-bar", "slider-crank"])
@pytest.mark.parametrize(
    "law", ["control: {law: none}", *swept("control: {law: pd-gravity, kp: 9, kd: 0.2}", COMPUTED)]
)
def test_energy_balances(name: str, law: str) -> None:
    text = new_plan_text(name, Robot.load(name), name).split("control:", maxsplit=1)[0]
    run = (motion := Motion.from_text(f"{text.replace('time: 2', 'time: 1')}{law}\n")).simulate()
    assert run.reached
    assert run.energy_error < 1e-9 * (scale := max(1.0, np.abs(run.energy).max()))
    assert (run.lost[-1] > 0) == (name == "slider-crank")  # by the viscous friction of its passive piston
    assert motion.poses(motion.times).shape[1:] == (4, 4)
    if law == COMPUTED:  # which does not know dry friction; generated torques do
        assert np.abs(run.q - motion(run.t)[0]).max() < 1e-9
        rough = tuple(replace(link, coulomb=(number("0.002"), number("0.001"))) for link in motion.plan.robot.links)
        other = Motion(replace(motion.plan, robot=replace(motion.plan.robot, links=rough)))
        power = ((other.torques(run.t) - motion.torques(run.t)) * run.qd).sum(axis=1)
        assert (found := other.simulate()).energy_error < 1e-7 * scale
        assert found.lost[-1] - run.lost[-1] == pytest.approx(np.trapezoid(power, run.t), rel=0.05)


def test_a_loop_stays_closed_for_ten_seconds() -> None:
    run = (motion := Motion.from_text(FOUR_BAR.replace("time: 2", "time: 10"))).simulate()
    assert np.ptp(run.energy) < 1e-8
    frames = Functions(motion.plan.robot, frozenset({"link_transforms"}), motion.values)("link_transforms", run.q)
    assert np.abs(frames[:, 1, :3, 3] - frames[:, 2, :3, 3]).max() <= 1e-9
    # The loop by angles: l1 e^(i q1) + l2 e^(i (q1 + q2)) = l0 + l3 e^(i q3).
    q1, q2, q3 = samples(motion, run)[1][:, [1, -2, -1]].T
    way = 0.1 * np.exp(1j * q1) + 0.35 * np.exp(1j * (q1 + q2)) - 0.4 - 0.25 * np.exp(1j * q3)
    assert np.abs(way).max() <= 1e-9


def test_dead_points_and_open_loops_end_with_their_time() -> None:
    # With a long crank no joint of the four-bar turns round: it falls until coupler and rocker are in line.
    motion = Motion.from_text(f"{FOUR_BAR}values: {{l1: 0.3, l2: 0.25}}\n")
    assert "dead point of a loop after" in diverged(motion, motion.simulate())
    with pytest.raises(DeriveError, match="do not close at"):
        Motion.from_text(FOUR_BAR.replace("0.7", "2.6") + "values: {l1: 0.3, l2: 0.25}\n")


@pytest.mark.parametrize("more", ["friction: exact", "base: {x: t}", "plant: {payload: 1}"])
def test_what_needs_joints_of_their_own_is_refused(more: str) -> None:
    with pytest.raises(DeriveError, match="whose joints are coupled"):
        Motion.from_text(f"{FOUR_BAR}{more}\n")

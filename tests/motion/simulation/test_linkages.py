"""Motions and simulations of robots with coupled joints and with closed loops."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.motion.motion import Motion
from derive.motion.output.printed import diverged, samples
from derive.motion.torques.functions import Functions
from derive.plans.catalogue import new_plan_text
from derive.robot.expression import number
from derive.robot.robot import Robot
from tests.inverse.loops.test_iterated import PLATE, plate_gap
from tests.random_robots import swept

# The plate of the tests of loops without formulas, with bodies in the order of its rows.
BODIES = "".join(f"  - {{mass: {m}, com: [-0.1, 0.02, 0], inertia: {{zz: 0.004}}}}\n" for m in (1, 2, 1, 0, 0, 1, 0, 1))
HEAVY_PLATE = f"{PLATE}gravity: [0, -9.81, 0]\nlinks:\n{BODIES}"
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


def plate_plan(folder: Path, to: float, time: float, law: str, crank: float = 0.1) -> str:
    (folder / "plate.yaml").write_text(HEAVY_PLATE.replace("r: 0.1", f"r: {crank}"))
    points = f"points: {{a: [0.1], b: [{to}]}}\npath: [a, {{to: b, time: {time}}}]"
    return f"robot: {folder / 'plate.yaml'}\n{points}\ncontrol: {{law: {law}}}\n"


@pytest.mark.parametrize("seconds", [2, pytest.param(10, marks=pytest.mark.sweep)])
def test_loops_without_formulas_follow_from_the_last_configuration(tmp_path: Path, seconds: int) -> None:
    # at most two turns, further than one way of `positions`
    motion = Motion.from_text(plate_plan(tmp_path, 1.3 * seconds, seconds, "none"))
    t = np.linspace(0, seconds, 200 * seconds + 1)
    q, qd, _ = motion(t)
    energy = Functions(motion.plan.robot, frozenset({"kinetic_energy", "potential_energy"}), motion.values)
    stored = energy("kinetic_energy", q, qd) + energy("potential_energy", q)
    work = np.append(0, np.cumsum((power := (motion.torques(t) * qd).sum(axis=1))[1:] + power[:-1])) * (t[1] / 2)
    assert np.abs(stored - stored[0] - work).max() < 1e-4 * np.ptp(stored)
    run = motion.simulate()
    assert run.reached
    assert np.ptp(run.energy) < 1e-8
    names, rows = samples(motion, run)
    q1, *passive = (rows[:, names.index(name)] for name in ("q1", "q2", "q3", "q4", "q5"))
    assert np.abs(plate_gap(q1, np.array(passive))).max() <= 1e-9
    assert np.abs(np.diff(passive)).max() < 0.5  # of one assembly from sample to sample
    # Every time by itself, in any order, is the same configuration.
    assert np.abs(motion.poses(t[::-7]) - motion.poses(t)[::-7]).max() < 1e-12


def test_loops_without_formulas_end_with_time_and_with_what_is_missing(tmp_path: Path) -> None:
    with pytest.raises(DeriveError, match=r"are open by \S+ \[m, or entries of rotations\] at 0\.\d+ s"):
        Motion.from_text(plate_plan(tmp_path, 2.0, 1, "none", crank=0.3))
    motion = Motion.from_text(plate_plan(tmp_path, 0.2, 3, "none", crank=0.3))
    run = motion.simulate()
    assert "dead point of a loop after" in diverged(motion, run)
    assert run.energy_error < 1e-8


@pytest.mark.sweep
def test_a_loop_with_formulas_that_turns_through_goes_with_one_without(tmp_path: Path) -> None:
    rows = (
        "  - {type: revolute, name: coupler, after: crank, q: q6, a: 0.45, passive: true}\n"
        "  - {type: fixed, name: stand, after: base, a: 0.3, theta: 3}\n"
        "  - {type: revolute, name: rocker, q: q7, a: 0.4, passive: true}\n"
        "loops:\n  - {join: [coupler, rocker], by: revolute}\n"
    )
    (tmp_path / "both.yaml").write_text(PLATE.replace("loops:\n", rows))
    plan = f"robot: {tmp_path / 'both.yaml'}\npoints: {{a: [0], b: [13]}}\npath: [a, {{to: b, time: 5}}]\n"
    q1, *_, q6, q7 = samples(Motion.from_text(plan))[1].T[[1, 4, 5, 6, 7, 8, 9]]
    pins = 0.1 * np.exp(1j * q1) + 0.45 * np.exp(1j * (q1 + q6)) - 0.3 * np.exp(3j) - 0.4 * np.exp(1j * (3 + q7))
    assert np.abs(pins).max() < 1e-9
    assert np.abs(np.diff(q6)).max() > 6  # the angle of a formula is within half a turn

"""Friction that sticks: closed forms, complementarity, and both ways of integration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.simulation.stages import stages_of
from derive.motion.simulation.stepping import Plant, smooth
from derive.motion.simulation.sticking import Contact, exact, stepped
from derive.verification.oracle.functions import Oracle

SLIDES = """\
robot: {name: slides, convention: standard, gravity: [0, -9.81, 0], joints: [{type: prismatic}, {type: prismatic}],
  links: [{mass: 3, friction: {coulomb: FIRST}}, {mass: 2, friction: {coulomb: 4}}]}
points: {a: [0, 0]}
path: [a, {to: a, time: 2}]
friction: exact
disturbance: [{joint: q2, torque: 10, end: 1}]
"""
"""A slide of 2 kg on one of 3 kg, on one line across gravity; the upper one is pushed."""

ARM = """\
robot: {name: arm, convention: standard, gravity: [0, -9.81, 0],
  joints: [{type: revolute, a: 1}, {type: revolute, a: 0.8}, {type: revolute, a: 0.5}],
  links: [{mass: 2, com: [-0.5, 0, 0], friction: {coulomb: 6, viscous: 0.3}}, {mass: 1.5, friction: {coulomb: 4}},
    {mass: 1, com: [-0.2, 0, 0], friction: {coulomb: 1.5}}]}
points: {a: [-1, 0.3, 0.2], b: [-0.7, 0.2, 0.5]}
path: [a, {to: b, time: 1}, {to: a, time: 1}, {to: a, time: 0.5}]
control: {law: pd, kp: 60, kd: 4}
friction: exact
"""


def plant_of(text: str) -> Plant:
    motion = Motion.from_text(text)
    return stages_of(motion.plan, motion.trajectory, motion.values, None)[0].plant


def test_one_joint_stands_while_the_other_slides_and_both_come_to_rest() -> None:
    """The upper slide speeds up at (10 - 4)/2 and slows down at 4/2; the lower one is pulled by 6, then 4 of 7 N."""
    run = Motion.from_text(SLIDES.replace("FIRST", "7")).simulate()
    assert not run.q[:, 0].any()
    assert not run.qd[:, 0].any()
    early, t = run.t <= 1, run.t
    assert run.qd[early, 1] == pytest.approx(3 * t[early], abs=1e-12)
    assert run.qd[~early, 1] == pytest.approx(3 - 2 * (t[~early] - 1), abs=1e-12)
    assert run.q[-1, 1] == pytest.approx(1.5 + 3 - 1, abs=1e-11)
    assert run.energy_error < 1e-12
    longer = Motion.from_text(SLIDES.replace("FIRST", "7").replace("time: 2", "time: 3")).simulate()
    assert longer.q[-1, 1] == pytest.approx(1.5 + 9 / 4, abs=1e-11)
    assert (longer.qd[longer.t > 2.51] == 0).all()


def test_where_the_reaction_is_more_than_breakaway_both_slide() -> None:
    """With 5 N below, 2 a2 + 2 a1 = 10 - 4 and 5 a1 + 2 a2 = 5 (pulled back): a1 = -1/3, a2 = 10/3."""
    run = Motion.from_text(SLIDES.replace("FIRST", "5")).simulate()
    early, t = run.t <= 1, run.t[run.t <= 1]
    assert run.qd[early] == pytest.approx(np.stack([-t / 3, 10 * t / 3], axis=1), abs=1e-12)
    assert run.energy_error < 1e-10


def test_friction_is_complementary_at_every_sample() -> None:
    """What stands needs less than breakaway, by an oracle's dynamics, and what slips loses energy."""
    motion = Motion.from_text(ARM)
    run, oracle = motion.simulate(), Oracle.of(motion.plan.robot)
    dry, viscous, seen = np.array([6, 4, 1.5]), np.array([0.3, 0, 0]), set()
    for q, qd, after, tau in zip(run.q[:-1], run.qd[:-1], run.qd[1:], run.tau[:-1], strict=True):
        stands = (qd == 0) & (after == 0)
        seen.add(tuple(stands))
        inertia, pull = oracle.evaluate("inertia_matrix", q), tau - oracle.evaluate("gravity_vector", q)
        pull -= oracle.evaluate("coriolis_vector", q, qd) + viscous * qd + dry * np.sign(qd)
        slips = qd != 0
        if (slips | stands).sum() < 3:
            continue  # it breaks away before the next sample
        qdd = np.zeros(3)
        qdd[slips] = np.linalg.solve(inertia[np.ix_(slips, slips)], pull[slips])
        assert (np.abs(pull - inertia @ qdd)[stands] <= dry[stands] * (1 + 1e-9)).all()
    assert len(seen) >= 4
    assert run.energy_error < 1e-9
    assert (np.diff(run.lost) >= 0).all()


def test_small_steps_and_smooth_friction_come_to_the_same_motion() -> None:
    plant = replace(plant_of(ARM), coulomb=np.array([3.0, 2, 0.5]))
    start = np.concatenate([[0.2, 0.5, -0.3], np.zeros(5)])

    def idle(*_: object) -> np.ndarray:
        return np.zeros(3)

    ends = [method(plant, idle, start, (0.0, 0.4), np.array([0.4]))[0][0] for method in (exact, smooth, stepped)]
    assert np.abs(ends[0][3:6]).max() > 1
    assert ends[1] == pytest.approx(ends[0], abs=2e-3)
    assert ends[2] == pytest.approx(ends[0], abs=3e-2)


def test_what_slips_at_rest_is_decided_for_all_joints_together() -> None:
    """A push of 10 N on the upper slide: below 6 N the lower one gives way, too."""
    for friction, way in ((7.0, [0, 1]), (5.0, [-1, 1]), (0.0, [0, 1])):
        plant = replace(plant_of(SLIDES.replace("FIRST", "7")), coulomb=np.array([friction, 4]))
        contact = Contact.at(plant, lambda *_: np.zeros(2), 0.0, np.zeros(2), np.zeros(2))
        assert contact is not None
        assert contact.way.tolist() == way
        assert contact.stands.tolist() == [friction == 7, False]


def test_a_torque_that_is_breakaway_itself_moves_nothing() -> None:
    plant = replace(plant_of(SLIDES.replace("FIRST", "7")), coulomb=np.array([9.0, 10]))
    (end,), divergence = exact(plant, lambda *_: np.zeros(2), np.zeros(6), (0.0, 1.0), np.array([1.0]))
    assert divergence is None
    assert not end.any()


def test_large_gains_of_a_light_link_do_not_stop_a_simulation() -> None:
    """20 N m s/rad on 0.0004 kg m^2 decay at 50,000/s; an explicit solver would take as many steps."""
    text = ARM.replace("[-0.2, 0, 0], friction", "[0, 0, 0], friction").replace("mass: 1,", "mass: 0.001,")
    plant, calls = plant_of(text.replace("a: 0.5", "a: 0.1")), 0

    def stiff(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        return -60 * q - 20 * qd

    (end,), divergence = exact(plant, stiff, np.array([0.3, 0.2, 0.5, 0, 0, 0, 0, 0]), (0.0, 0.5), np.array([0.5]))
    assert divergence is None
    assert calls < 20_000
    assert np.abs(end[:3]).max() < 0.5


def test_chatter_does_not_stop_a_simulation() -> None:
    """A motor that pushes against the velocity with more than breakaway: no way of slipping lasts."""
    plant = replace(plant_of(SLIDES.replace("FIRST", "7")), coulomb=np.array([1.0, 1]), push=np.zeros(2))

    def chatter(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        return np.where(qd > 0, -5.0, 5.0)

    (end,), divergence = exact(plant, chatter, np.zeros(6), (0.0, 0.03), np.array([0.03]))
    assert divergence is None
    assert np.abs(end[2:4]).max() < 0.05

"""What is simulated: loads that the controller knows and others, and pushes."""

from __future__ import annotations

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.simulation.stages import stages_of
from derive.verification.oracle.functions import Oracle
from tests.motion.plans import PICK_AND_PLACE

SHORT = PICK_AND_PLACE.replace("time: 3", "time: 1/2").replace("friction: smooth", "friction: none")
CARRYING = SHORT.replace("{to: B, time: 1/2}", "{to: B, time: 1/2, payload: {mass: 2, com: [0.1, 0, 0.2]}}")


def error(text: str) -> float:
    motion = Motion.from_text(text)
    run = motion.simulate()
    assert run.reached
    assert run.energy_error < 1e-6
    return float(np.abs(run.q - motion(run.t)[0]).max())


def test_a_stage_lasts_as_long_as_load_and_push_stay() -> None:
    text = CARRYING + "disturbance: [{joint: q2, torque: 3, start: 0.7, end: 1.2}]\n"
    motion = Motion.from_text(text)
    stages = stages_of(motion.plan, motion.trajectory, motion.values, None)
    assert [stage.start for stage in stages] == [0, 0.5, 0.7, 1, 1.2]
    assert [stage.plant.push[1] for stage in stages] == [0, 0, 3, 3, 0]


def test_a_load_that_the_controller_knows_is_followed() -> None:
    assert error(CARRYING) < 1e-8


def test_a_load_that_the_controller_does_not_know_is_not() -> None:
    assert 1e-3 < error(SHORT + "plant: {payload: {mass: 2, com: [0.1, 0, 0.2]}}\n") < 1


def test_the_plant_with_a_payload_has_the_torques_of_the_motion_with_it() -> None:
    """Forward dynamics of the loaded plant against inverse dynamics by the regressor."""
    motion = Motion.from_text(CARRYING)
    plant = stages_of(motion.plan, motion.trajectory, motion.values, None)[1].plant
    for t in (0.55, 0.7, 0.9):
        q, qd, qdd = motion(t)
        assert plant.functions("forward_dynamics", q, qd, motion.torques(t)) == pytest.approx(qdd, abs=1e-10)


def test_a_push_moves_an_arm_as_a_motor_would() -> None:
    """From rest with gravity compensated by B^-1 push; PD holds it at push/kp."""
    text = (
        "robot: {name: arm, convention: standard, gravity: [0, -9.81, 0],\n"
        "  joints: [JOINT, JOINT], links: [LINK, LINK]}\n"
        "points: {a: [0.3, 0.7]}\npath: [a, {to: a, time: 4}]\nfriction: none\nsample: 0.002\n"
        "control: {law: pd-gravity, kp: 90, kd: 45}\ndisturbance: [{joint: q1, torque: 0.9, start: 0.5, end: 9}]\n"
    )
    text = text.replace("JOINT", "{type: revolute, a: 1}").replace("LINK", "{mass: 1}")
    motion = Motion.from_text(text)
    run = motion.simulate()
    assert np.abs(run.q[run.t <= 0.5] - run.q[0]).max() < 1e-10
    assert run.q[-1] - run.q[0] == pytest.approx([0.01, 0], abs=1e-4)
    inertia = Oracle.of(motion.plan.robot).evaluate("inertia_matrix", run.q[0])
    at = int(np.searchsorted(run.t, 0.501))
    expected = np.linalg.solve(inertia, [0.9, 0]) * (run.t[at] - 0.5)
    assert run.qd[at] == pytest.approx(expected, rel=0.2)
    assert run.energy_error < 1e-8

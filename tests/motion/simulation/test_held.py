"""Arms under held torques in C beside scipy's solvers."""

from __future__ import annotations

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.simulation import held
from derive.motion.simulation.held import held_arm
from derive.motion.simulation.simulation import Run
from derive.motion.simulation.stages import stages_of
from derive.motion.torques import functions
from derive.targets.compiler import find_compiler

ARM = """\
robot: {name: arm, convention: standard, gravity: [0, -9.81, 0], parameters: {m2: 1}, joints:
    [{type: revolute, a: 1}, {type: prismatic, alpha: pi/2}],
  links: [{mass: 2, com: [-0.5, 0, 0], inertia: {zz: 0.2}, friction: {viscous: 0.3, coulomb: 1.5}},
    {mass: m2, friction: {coulomb: 0.5}}]}
points: {a: [0.4, 0.1], b: [1, 0.3]}
path: [a, {to: b, time: 0.5, payload: 0.3}, {to: a, time: 0.3}]
plant: {m2: 1.25}
disturbance: [{joint: q1, torque: 3, start: 0.2, end: 0.25}]
"""
SAMPLED = "control: {law: LAW, kp: 100, kd: 20, period: 0.004}\n"

if find_compiler() is None:
    pytest.skip("no C compiler", allow_module_level=True)


@pytest.fixture(autouse=True)
def _held_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """All other functions are in NumPy: their compilation is tested elsewhere."""
    monkeypatch.setattr(functions, "find_compiler", lambda: None)


def runs(extra: str) -> tuple[Run, Run]:
    """In C, and by scipy alone."""
    motion = Motion.from_text(ARM + extra)
    return motion.simulate(calls=1e9), motion.simulate(calls=0)


@pytest.mark.parametrize(
    "extra",
    [
        "friction: none\n",
        pytest.param("friction: none\n" + SAMPLED.replace("LAW", "pd-gravity"), marks=pytest.mark.sweep),
        "friction: smooth\n" + SAMPLED.replace("LAW", "computed-torque"),
    ],
    ids=["falls", "sampled, without dry friction", "sampled, with dry friction"],
)
def test_both_are_one_motion(extra: str) -> None:
    ours, theirs = runs(extra)
    assert ours.reached
    assert np.abs(ours.q - theirs.q).max() < 1e-9
    assert np.abs(ours.qd - theirs.qd).max() < 1e-7
    assert np.abs(ours.tau - theirs.tau).max() < 1e-6
    assert ours.energy_error < 1e-8


def test_what_diverges_says_where_and_keeps_the_rows_so_far() -> None:
    ours, theirs = runs("friction: none\ncontrol: {law: pd, kp: 1, kd: 100000, period: 0.01}\n")
    assert ours.divergence is not None
    assert theirs.divergence is not None
    assert ours.divergence.time == pytest.approx(theirs.divergence.time, abs=0.01)
    assert np.abs(ours.divergence.qd).max() >= 1e4
    assert 1 <= ours.t.size == theirs.t.size
    assert np.isfinite(ours.q).all()


def test_a_time_as_near_as_rounding_is_reached() -> None:
    motion = Motion.from_text(ARM + "friction: none\n")
    plant = stages_of(motion.plan, motion.trajectory, motion.values, 1e9)[0].plant
    assert plant.held is not None
    state = np.array([0.4, 0.1, 1.0, -0.5, 0.0, 0.0])
    for start in (0.5, 7.0, 1e5):
        end = np.nextafter(start, np.inf)
        rows, divergence = plant.held(plant, np.zeros(2), state, (start, end), np.array([end]))
        assert divergence is None
        assert rows[0] == pytest.approx(state, abs=1e-9)


def test_few_evaluations_are_not_worth_a_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(held, "find_compiler", pytest.fail)
    motion = Motion.from_text(ARM)
    assert held_arm(motion.plan.robot, motion.values, 1000) is None


def test_without_a_compiler_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(held, "find_compiler", lambda: None)
    robot = Motion.from_text(ARM.replace("name: arm", "name: another")).plan.robot
    assert held_arm(robot, {}, 1e9) is None

"""Integration from one time to the next."""

from __future__ import annotations

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.simulation.stages import stages_of
from derive.motion.simulation.stepping import DIVERGED, Plant, integrated, smooth
from derive.motion.simulation.sticking import exact, stepped
from tests.motion.plans import PUMA_FALLS


@pytest.fixture(scope="module")
def plant() -> Plant:
    motion = Motion.from_text(PUMA_FALLS.replace("TIME", "1"))
    values = {"g": 9.81, "a2": 0.4318, "a3": 0.0203, "d3": 0.15005, "d4": 0.4318}
    return stages_of(motion.plan, motion.trajectory, values, None)[0].plant


def idle(*_: object) -> np.ndarray:
    return np.zeros(6)


def state(plant: Plant) -> np.ndarray:
    return np.concatenate([[0, 0.8, -1.5, 0.2, 0.3, 0.5], np.zeros(6), [0, 0]])


def test_the_energy_of_a_fall_is_kept(plant: Plant) -> None:
    (end,), divergence = smooth(plant, idle, state(plant), (0.0, 1.0), np.array([1.0]))
    assert divergence is None
    before = plant.energy(state(plant)[:6], np.zeros(6))
    assert plant.energy(end[:6], end[6:12]) == pytest.approx(before - end[13], abs=1e-8)


@pytest.mark.parametrize("step", [smooth, exact, stepped])
def test_what_diverges_says_when_and_where_and_keeps_its_rows(plant: Plant, step: object) -> None:
    def driven(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        return 5 * qd + np.array([0, 0, 0, 0, 0, 1.0])

    times = np.linspace(0.01, 5, 500)
    rows, divergence = step(plant, driven, state(plant), (0.0, 5.0), times)  # type: ignore[operator]
    assert divergence is not None
    assert 0 < len(rows) < 500
    assert times[len(rows) - 1] <= divergence.time < times[len(rows)]
    assert abs(divergence.qd[divergence.joint]) == pytest.approx(DIVERGED, rel=0.7)
    assert np.isfinite(rows).all()


def test_an_integration_ends_where_something_else_begins() -> None:
    """A fall from rest passes one metre after sqrt(2/9.81) s."""

    def falling(t: float, state: np.ndarray) -> np.ndarray:
        return np.array([state[1], -9.81, 0, 0])

    times = np.linspace(0.1, 1, 10)
    got, change, divergence = integrated(
        falling, np.zeros(4), (0.0, 1.0), times, "DOP853", lambda _, state: float(state[0]) + 1
    )
    assert change is not None
    assert divergence is None
    assert change[0] == pytest.approx(np.sqrt(2 / 9.81), rel=1e-12)
    assert change[1][:2] == pytest.approx([-1, -np.sqrt(2 * 9.81)], rel=1e-12)
    assert len(got) == 4


def test_large_gains_of_a_light_joint_take_few_steps() -> None:
    """Velocities that decay within microseconds hold explicit solvers up: a hundred thousand calls and more."""
    text = (
        "robot: {name: p, convention: standard, gravity: [0, -9.81, 0], joints: [{type: revolute, a: 0.1}],\n"
        "  links: [{mass: 0.01}]}\n"
        "points: {a: [0], b: [1]}\n"
        "path: [a, {to: b, time: 0.3}]\n"
        "control: {law: pd, kp: 400, kd: 20}\n"
    )
    motion = Motion.from_text(text)
    (stage,) = stages_of(motion.plan, motion.trajectory, {}, None)
    calls = 0

    def counted(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        return stage.law(t, q, qd)

    (end,), divergence = smooth(stage.plant, counted, np.zeros(4), (0.0, 0.3), np.array([0.3]))
    assert divergence is None
    assert calls < 5000
    assert end[0] == pytest.approx(1, abs=1e-3)

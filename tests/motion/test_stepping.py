"""Integration from one time to the next."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.stages import stages_of
from derive.motion.stepping import DIVERGED, Plant, exact, smooth
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


def test_small_steps_of_exact_friction_come_to_the_smooth_solution(plant: Plant) -> None:
    rough = replace(plant, coulomb=np.array([3.0, 3, 3, 0.5, 0.5, 0.5]))
    (ours,), _ = exact(rough, idle, state(plant), (0.0, 0.3), np.array([0.3]))
    (theirs,), _ = smooth(rough, idle, state(plant), (0.0, 0.3), np.array([0.3]))
    assert ours[:12] == pytest.approx(theirs[:12], abs=5e-3)
    assert np.abs(theirs[6:8]).max() > 0.5


def test_the_energy_of_a_fall_is_kept(plant: Plant) -> None:
    (end,), divergence = smooth(plant, idle, state(plant), (0.0, 1.0), np.array([1.0]))
    assert divergence is None
    before = plant.energy(state(plant)[:6], np.zeros(6))
    assert plant.energy(end[:6], end[6:12]) == pytest.approx(before - end[13], abs=1e-8)


@pytest.mark.parametrize("step", [smooth, exact])
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

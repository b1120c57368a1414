"""Torque, power and work of a segment."""

from __future__ import annotations

import numpy as np
import pytest

from derive.arrays import Array
from derive.motion.torques.loads import loads


def state(times: Array) -> tuple[Array, Array]:
    """Two joints: tau = 3 sin(2 t), -t; qd = cos(t), 2."""
    tau = np.stack([3 * np.sin(2 * times), -times], axis=-1)
    return tau, np.stack([np.cos(times), np.full_like(times, 2.0)], axis=-1)


@pytest.mark.parametrize("samples", [1, 7, 300])
def test_peaks_lie_between_samples_and_integrals_are_exact(samples: int) -> None:
    first, second = loads(0.0, 1.5, samples, state)
    assert (first.peak, first.time) == pytest.approx((3.0, np.pi / 4), rel=1e-5)
    assert first.peak == pytest.approx(3.0, rel=1e-10)
    assert (second.peak, second.time) == pytest.approx((-1.5, 1.5))
    assert second.work == pytest.approx(-(1.5**2))
    assert second.rms == pytest.approx(1.5 / np.sqrt(3))
    assert first.work == pytest.approx(2 * (1 - np.cos(1.5) ** 3), rel=1e-7)
    u = np.sqrt(1 / 3)  # 6 sin t cos^2 t is largest where sin^2 t = 1/3
    assert first.power == pytest.approx(6 * u * (1 - u**2), rel=1e-10)


def test_what_the_next_segment_carries_does_not_count() -> None:
    (load,) = loads(0.0, 1.0, 10, lambda t: (np.where(t < 1, 1.0, 9.0)[..., None], np.ones((*t.shape, 1))))
    assert (load.peak, load.power, load.rms) == (1.0, 1.0, pytest.approx(1.0))


def test_integrals_stop_at_corners() -> None:
    """A torque of 1 that jumps to 3 at a third of the time: work 7/3, mean square 19/3."""

    def jumping(t: Array) -> tuple[Array, Array]:
        return np.where(t < 1 / 3, 1.0, 3.0)[..., None], np.ones((*t.shape, 1))

    (load,) = loads(0.0, 1.0, 10, jumping, [1 / 3])
    assert load.work == pytest.approx(7 / 3, rel=1e-12)
    assert load.rms == pytest.approx(np.sqrt(19 / 3), rel=1e-12)
    assert (load.peak, load.power) == (3, 3)
    assert load.time == pytest.approx(1 / 3)

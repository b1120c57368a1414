"""Pick and place of document 004: what its figures show, and what its motors must do.

The report plots diff(q) and diff(diff(q)) and calls them speed and acceleration. They are differences from sample to
sample: at 10 ms a hundred and ten thousand times too small. Peaks by formula, from samples, and the torques that the
report does not compute:

    python examples/pick_and_place.py

needs derive. The same by the command: `derive move examples/pick-and-place.yaml`.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from derive import Motion

PLAN = Path(__file__).with_name("pick-and-place.yaml")
SAMPLE = 0.01
"""Time between two samples [s], Tc in the report."""


def main() -> int:
    """Print segments, and what the unscaled differences are."""
    motion = Motion.load(PLAN)
    for peaks in motion.peaks:
        speed = max(peaks.speeds, key=lambda peak: abs(float(peak.value)))
        load = max(peaks.loads, key=lambda load: abs(load.peak))
        said = f"speed {speed.value} = {float(speed.value):.4f} at {float(speed.time):.2f} s"
        print(f"{peaks.segment.name}: {said}, torque {load.peak:.1f} at {load.time:.2f} s, work {peaks.work:.1f} J")
    slow, weak = unscaled(motion)
    print(f"largest diff(q): {slow:.7f} rad, times 1/Tc: {slow / SAMPLE:.4f} rad/s")
    print(f"largest diff(diff(q)): {weak:.5e} rad, times 1/Tc^2: {weak / SAMPLE**2:.4f} rad/s^2")
    extra = lifting(motion)
    print(f"the payload costs {extra:.4f} N more at rest in A")
    return 0 if abs(slow / SAMPLE - 5 * np.pi / 16) < 1e-4 and abs(extra - 0.5 * 9.8062) < 1e-9 else 1


def unscaled(motion: Motion) -> tuple[float, float]:
    """What figure 15 of the report has on its axes, for the first joint from rest to A.

    Args:
        motion: The motion.

    Returns:
        The largest first and second difference of 301 samples.
    """
    q = motion(np.arange(301) * SAMPLE)[0][:, 0]
    return float(np.diff(q).max()), float(np.diff(np.diff(q)).max())


def lifting(motion: Motion) -> float:
    """How much more the slide pulls at rest in A with the payload (at 9 s) than without it (at 3 s) [N].

    Args:
        motion: The motion.
    """
    without, with_it = motion.torques(np.array([3.0, 9.0]))[:, 2]
    return float(without - with_it)


if __name__ == "__main__":
    sys.exit(main())

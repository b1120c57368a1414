"""Computed torque: a PUMA 560 follows a motion from a wrong start, and its error dies out as a formula says.

The law tau = B(q) (qdd_d + kd de/dt + kp e) + C(q, qd) qd + g(q) leaves of the arm's dynamics the equation
d2e/dt2 + kd de/dt + kp e = 0 for the error e = q_d - q of every joint. With kp = w**2 and kd = 2 w it is critically
damped, e(t) = (1 + w t) exp(-w t) e(0), whatever the arm and the motion.

    python examples/computed_torque.py

needs derive and SciPy; the model is the committed one of generated/puma560_corke. The same motion by the command:
`derive move examples/computed-torque.yaml --simulate`.
"""

from __future__ import annotations

import importlib
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

from derive import Motion

PLAN = Path(__file__).with_name("computed-torque.yaml")
W = 10.0
"""Rate at which the error dies out [1/s]; kp = W**2, kd = 2 W."""
OFF = np.array([0.2, -0.1, 0.15, 0.3, -0.3, 0.4])
"""How far from its place each joint starts [rad]."""

Array = npt.NDArray[np.float64]

sys.path.insert(0, str(Path(__file__).parents[1] / "generated"))
puma = importlib.import_module("puma560_corke.model_numpy")


@dataclass(frozen=True)
class Run:
    """What happened.

    Attributes:
        t: Times [s].
        error: q_d - q, (times, 6) [rad].
        tau: Torques of the motors, (times, 6) [N m].
    """

    t: Array
    error: Array
    tau: Array

    @property
    def expected(self) -> Array:
        """The error by the formula."""
        decay = (1 + W * self.t) * np.exp(-W * self.t)
        return -OFF * decay[:, None]


def main() -> int:
    """Drive, and compare the error with the formula."""
    run = follow(Motion.load(PLAN))
    apart = float(np.abs(run.error - run.expected).max())
    for t in (0.0, 0.25, 0.5, 1.0):
        at = int(np.searchsorted(run.t, t))
        print(f"{run.t[at]:.2f} s: largest error {np.abs(run.error[at]).max():.2e} rad")
    print(f"largest torque {np.abs(run.tau).max():.0f} N m; farthest from the formula: {apart:.1e} rad")
    return 0 if apart < 1e-7 else 1


def follow(motion: Motion) -> Run:
    """The arm under the law, from a start that is `OFF` by.

    Args:
        motion: What is wanted.

    Returns:
        Errors and torques every 10 ms.
    """

    def torque(t: float, q: Array, qd: Array) -> Array:
        wanted, velocity, acceleration = motion(t)
        pull = acceleration + 2 * W * (velocity - qd) + W**2 * (wanted - q)
        return np.asarray(puma.inverse_dynamics(q, qd, pull))

    def rate(t: float, state: Array) -> Array:
        q, qd = state[:6], state[6:]
        return np.concatenate([qd, puma.forward_dynamics(q, qd, torque(t, q, qd))])

    q, qd, _ = motion(0.0)
    found = solve_ivp(
        rate, (0, motion.duration), [*(q + OFF), *qd], "DOP853", t_eval=motion.times, rtol=1e-9, atol=1e-10
    )
    tau = np.array([torque(t, state[:6], state[6:]) for t, state in zip(found.t, found.y.T, strict=True)])
    return Run(found.t, motion(found.t)[0] - found.y[:6].T, tau)


if __name__ == "__main__":
    sys.exit(main())

"""Two hands at once: both hands of a torso follow circles while it turns, and their errors die out as a formula says.

Seven joints move x = (p_left, p_right, waist), two points and an angle. With its Jacobian xd = J qd, and the law
tau = B(q) J^-1 (xdd_d + kd de/dt + kp e - J' qd) + C(q, qd) qd + g(q), each coordinate of x obeys
d2e/dt2 + kd de/dt + kp e = 0 for its error e = x_d - x (Siciliano et al., Robotics, 2009, 8.6.2). With kp = w**2 and
kd = 2 w that is e(t) = (1 + w t) exp(-w t) e(0), of both hands, though the arms move each other by way of the waist.

    python examples/bimanual.py

needs SciPy; the model is the committed one of generated/two_armed_torso, a tree with the ends left and right.
"""

from __future__ import annotations

import importlib
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

W = 10.0
"""Rate at which errors die out [1/s]; kp = W**2, kd = 2 W."""
RADIUS, TURN = 0.06, 0.3
"""Of the circles of the hands [m], and how far the waist turns to each side [rad]."""
Q0 = np.array([0.05, 0.6, 0.2, -1.3, 0.5, -0.1, -1.2])
"""Where the joints start; the hands are off their circles there."""
HELD = {"m2": 1.6 + 0.5}
"""Mass of a forearm with half a box of a kilogram [kg]."""

Array = npt.NDArray[np.float64]

sys.path.insert(0, str(Path(__file__).parents[1] / "generated"))
torso = importlib.import_module("two_armed_torso.model_numpy")


@dataclass(frozen=True)
class Run:
    """What happened.

    Attributes:
        t: Times [s].
        error: x_d - x, (times, 7): of the left hand, of the right one [m], and of the waist [rad].
    """

    t: Array
    error: Array

    @property
    def expected(self) -> Array:
        """The error by the formula, of a start at the velocity that is wanted."""
        return ((1 + W * self.t) * np.exp(-W * self.t))[:, None] * self.error[0]


def main() -> int:
    """Drive, and compare the errors with the formula."""
    run = follow(2.0)
    for t in (0.0, 0.25, 0.5, 1.0):
        at = int(np.searchsorted(run.t, t))
        left, right = (1e3 * np.linalg.norm(run.error[at, place : place + 3]) for place in (0, 3))
        print(f"{run.t[at]:.2f} s: left hand {left:.3f} mm off, right hand {right:.3f} mm")
    apart = float(np.abs(run.error - run.expected).max())
    print(f"farthest from the formula: {apart:.1e}")
    return 0 if apart < 1e-7 else 1


def wanted(t: float) -> tuple[Array, Array, Array]:
    """Hands on vertical circles half a metre apart, the waist to and fro: x and its first two derivatives."""
    rate = np.pi
    c, s = RADIUS * np.cos(rate * t), RADIUS * np.sin(rate * t)
    x = np.array([0.4, 0.2 + c, 1.0 + s, 0.4, -0.3 + c, 1.0 + s, TURN * np.sin(rate * t)])
    xd = rate * np.array([0, -s, c, 0, -s, c, TURN * np.cos(rate * t)])
    xdd = rate**2 * np.array([0, -c, -s, 0, -c, -s, -TURN * np.sin(rate * t)])
    return x, xd, xdd


def place(q: Array) -> Array:
    """Where the hands and the waist are."""
    hands = [torso.forward_kinematics(q, end=end)[..., :3, 3] for end in torso.ENDS]
    return np.concatenate([*hands, q[..., :1]], axis=-1)


def jacobian(q: Array) -> Array:
    """Their rates by those of the joints."""
    return np.concatenate([*(torso.jacobian(q, end=end)[:3] for end in torso.ENDS), np.eye(7)[:1]])


def torque(t: float, q: Array, qd: Array) -> Array:
    """Torques of the motors [N m]."""
    x, xd, xdd = wanted(t)
    turning = np.concatenate([*(torso.jacobian_dot(q, qd, end=end)[:3] for end in torso.ENDS), np.zeros((1, 7))])
    j = jacobian(q)
    pull = xdd + 2 * W * (xd - j @ qd) + W**2 * (x - place(q)) - turning @ qd
    return np.asarray(torso.inverse_dynamics(q, qd, np.linalg.solve(j, pull), HELD))


def follow(duration: float) -> Run:
    """The torso under the law, from the wrong place `Q0`.

    Args:
        duration: How long [s].

    Returns:
        Errors every 10 ms.
    """

    def rate(t: float, state: Array) -> Array:
        q, qd = state[:7], state[7:]
        return np.concatenate([qd, torso.forward_dynamics(q, qd, torque(t, q, qd), HELD)])

    start = np.concatenate([Q0, np.linalg.solve(jacobian(Q0), wanted(0.0)[1])])
    times = np.linspace(0, duration, round(100 * duration) + 1)
    found = solve_ivp(rate, (0, duration), start, "DOP853", t_eval=times, rtol=1e-9, atol=1e-10)
    error = np.array([wanted(t)[0] for t in found.t]) - place(found.y[:7].T)
    return Run(found.t, error)


if __name__ == "__main__":
    sys.exit(main())

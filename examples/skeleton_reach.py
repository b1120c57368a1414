"""The skeleton of document 001: from curves of the joints to the way of the hand, and back by small steps.

1. p(t) = f(alpha(t), beta(t), Tx(t), Ty(t) | l0, l1) by exact curves (slides 25 to 29), and the hand's velocity.
2. Which joint moves the hand most: the lengths of the columns of J (slide 27).
3. Incremental inverse kinematics: many small displacements of the hand, each followed by J^+ (slide 32). Without a
   correction the error that gathers is of the order of the step; with one it is gone.

    python examples/skeleton_reach.py

needs derive; the models are the committed ones of generated/.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt

from derive import Motion

PLAN = Path(__file__).with_name("skeleton-reach.yaml")
LENGTHS = {"l0": 0.30, "l1": 0.25}
"""Of both links [m], as in the plan."""
ROOT = {"Tx": 0.0, "Ty": 0.0}
"""Where the root stands while the arm reaches by small steps."""

Array = npt.NDArray[np.float64]

sys.path.insert(0, str(Path(__file__).parents[1] / "generated"))
whole = importlib.import_module("skeleton_root.model_numpy")
arm = importlib.import_module("skeleton.model_numpy")


def main() -> int:
    """Go through the three questions."""
    motion = Motion.load(PLAN)
    times = np.linspace(0, motion.duration, 9)
    hand, velocity = way(motion, times)
    apart = float(np.abs(hand - slide(motion, times)).max())
    for t, (x, y), (vx, vy) in zip(times, hand, velocity, strict=True):
        print(f"t = {t:.2f} s: hand at ({x:.4f}, {y:.4f}) m, moving at ({vx:+.4f}, {vy:+.4f}) m/s")
    print(f"farthest from the formula of the slides: {apart:.0e} m")
    q = np.array([-0.6, 0.9])
    about_root, about_elbow = levers(q)
    print(f"one radian moves the hand {about_root:.4f} m about the root, {about_elbow:.4f} m about the joint of l1")
    target = np.array([0.20, 0.35])
    for steps in (10, 100, 1000):
        print(f"{steps} steps without correction: {reach(q, target, steps)[1]:.1e} m from the target")
    _, left = reach(q, target, 100, corrected=True)
    print(f"100 steps with correction: {left:.0e} m")
    return 0 if apart < 1e-12 and left < 1e-9 else 1


def way(motion: Motion, times: Array) -> tuple[Array, Array]:
    """Positions and velocities of the hand in the plane of the slides.

    Args:
        motion: Curves of Tx, Ty, beta and alpha.
        times: When [s].

    Returns:
        (times, 2) each [m, m/s].
    """
    q, qd, _ = motion(times)
    pose = whole.forward_kinematics(q, LENGTHS)
    twist = (whole.jacobian(q, LENGTHS) @ qd[..., None])[..., 0]
    return pose[:, 0:2, 3], twist[:, 0:2]


def slide(motion: Motion, times: Array) -> Array:
    """The formula of slides 9 and 10: x = l1 c_ab + l0 c_b + Tx, y = -l1 s_ab - l0 s_b + Ty.

    Args:
        motion: The curves.
        times: When [s].

    Returns:
        (times, 2) [m].
    """
    tx, ty, beta, alpha = motion(times)[0].T
    l0, l1 = LENGTHS["l0"], LENGTHS["l1"]
    x = l1 * np.cos(alpha + beta) + l0 * np.cos(beta) + tx
    y = -l1 * np.sin(alpha + beta) - l0 * np.sin(beta) + ty
    return np.stack([x, y], axis=-1)


def levers(q: Array) -> Array:
    """How far a turn of each joint moves the hand: the lengths of the columns of J.

    Args:
        q: beta and alpha [rad].

    Returns:
        (2,) [m/rad]; by slide 27 sqrt(l1^2 + l0^2 + 2 l1 l0 cos(alpha)) and l1.
    """
    return np.asarray(np.linalg.norm(arm.jacobian(q, LENGTHS | ROOT)[:2], axis=0))


def reach(q: Array, target: Array, steps: int, *, corrected: bool = False) -> tuple[Array, float]:
    """The hand goes to a target on a straight line by small displacements dq = J^+ dp.

    Args:
        q: Where from [rad].
        target: Where to [m].
        steps: How many displacements.
        corrected: Whether each is measured from where the hand is, not from where it should be, and four more follow.

    Returns:
        Where the joints are then, and how far the hand is from the target.
    """
    start = place(q)
    for k in range(steps):
        goal = start + (target - start) * (k + 1) / steps
        moved = goal - place(q) if corrected else (target - start) / steps
        q = q + np.linalg.pinv(arm.jacobian(q, LENGTHS | ROOT)[:2]) @ moved
    for _ in range(4 if corrected else 0):
        q = q + np.linalg.pinv(arm.jacobian(q, LENGTHS | ROOT)[:2]) @ (target - place(q))
    return q, float(np.linalg.norm(target - place(q)))


def place(q: Array) -> Array:
    """Where the hand is.

    Args:
        q: beta and alpha [rad].

    Returns:
        (2,) [m].
    """
    return np.asarray(arm.forward_kinematics(q, LENGTHS | ROOT)[:2, 3])


if __name__ == "__main__":
    sys.exit(main())

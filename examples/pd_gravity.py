"""PD with gravity compensation: what is left when the load is not the one in the model, predicted and simulated.

At rest tau = Kp e + g(q) of the model balances the weight of the real arm, so that the error that stays solves
Kp e = g_arm(q_d - e) - g_model(q_d - e). The example solves that equation with the closed form of g, and then lets the
arm swing into place under the law (Siciliano et al., Robotics, 2009, 8.5.1).

    python examples/pd_gravity.py

needs derive and SciPy.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import sympy
from scipy.optimize import fsolve

import derive
from derive import Motion
from derive.robot.evaluate import evaluate

PLAN = Path(__file__).with_name("pd-gravity.yaml")

Array = npt.NDArray[np.float64]


def main() -> int:
    """Predict, simulate, compare."""
    motion = Motion.load(PLAN)
    predicted = predicted_error(motion)
    run = motion.simulate()
    left = motion(run.t)[0] - run.q
    print(f"predicted error {np.round(1000 * predicted, 6)} mrad")
    print(f"simulated error {np.round(1000 * left[-1], 6)} mrad, moving at {np.abs(run.qd[-1]).max():.0e} rad/s")
    print(f"energy ledger closed to {run.energy_error:.0e} J")
    return 0 if np.abs(left[-1] - predicted).max() < 1e-6 else 1


def predicted_error(motion: Motion) -> Array:
    """The error that stays, by the closed form of g.

    Args:
        motion: The plan, with what the arm has and the controller does not know.

    Returns:
        q_d - q at rest, (2,) [rad].
    """
    plan = motion.plan
    gravity = derive.Model(plan.robot).g
    known = {name: evaluate(value, {}) for name, value in plan.values.items()}
    real = known | {name: evaluate(value, {}) for name, value in plan.plant.items()}
    q = sympy.symbols([joint.variable for joint in plan.robot.joints])
    model, arm = (sympy.lambdify(q, gravity.subs(numbers)) for numbers in (known, real))
    kp = np.array([evaluate(gain, {}) for gain in plan.control.kp])
    wanted = motion(motion.duration)[0]

    def imbalance(error: Array) -> Array:
        return np.asarray(kp * error + (model(*(wanted - error)) - arm(*(wanted - error))).ravel())

    return np.asarray(fsolve(imbalance, np.zeros(2), xtol=1e-13))


if __name__ == "__main__":
    sys.exit(main())

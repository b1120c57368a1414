"""Model predictive control along a path: the generated model and the generated motion in one optimisation.

`derive move examples/swing-path.yaml --out DIR` writes the motion as a CasADi function of time. Here its values at
the next steps are parameters of a multiple shooting problem: least deviation from the path within the torques that
the motors have, at 20 steps a second. The arm starts beside the path and is pushed once on its way.

    python examples/mpc_path.py

needs derive and CasADi, which brings Ipopt along.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import casadi
import numpy as np
import numpy.typing as npt
from mpc_casadi import LIMITS, ROBOT, STEP, generated_model, step_function

import derive
from derive.motion.output.code import MODULE
from derive.publish.modules import module_of

PLAN = Path(__file__).with_name("swing-path.yaml")
HORIZON, STEPS = 8, 80
"""Steps that are planned ahead, and steps that are driven: the path, and a second of standing."""
START = np.array([-np.pi / 2 + 0.25, -0.2, 0.0, 0.0])
"""A quarter radian beside the path: angles [rad], then rates [rad/s]."""
PUSH, PUSHED = np.array([0.0, 0.0, 0.8, -0.8]), 40
"""A blow that changes the rates [rad/s], and the step before which it comes."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """What happened.

    Attributes:
        states: Angles and rates at every step, (steps + 1, 4).
        wanted: Those of the path, (steps + 1, 4).
        torques: Torques in every step, (steps, 2).
    """

    states: Array
    wanted: Array
    torques: Array

    def error(self, step: int) -> float:
        """How far the angles are from the path.

        Args:
            step: When.

        Returns:
            The larger of both [rad].
        """
        return float(np.abs(self.states[step, :2] - self.wanted[step, :2]).max())


def main() -> int:
    """Follow the path and tell how it went."""
    with generated_model(ROBOT) as model:
        run = follow(model, generated_motion(PLAN))
    for step in (0, 10, PUSHED - 1, PUSHED + 1, PUSHED + 10, STEPS):
        print(f"{STEP * step:.2f} s: {run.error(step):.4f} rad from the path")
    print(f"farthest torques: {np.abs(run.torques).max(axis=0).round(2)} N m of {LIMITS}")
    within = bool((np.abs(run.torques) <= LIMITS).all())
    return 0 if within and run.error(PUSHED - 1) < 0.01 and run.error(STEPS) < 0.01 else 1


def generated_motion(plan: Path) -> ModuleType:
    """The CasADi module of a plan, written for the occasion.

    Args:
        plan: Path of the plan.

    Returns:
        The module; its ``motion`` is a function of time.
    """
    with tempfile.TemporaryDirectory() as folder:
        derive.move(plan, code=folder)
        return module_of(Path(folder) / MODULE, "motion_casadi")


def follow(model: ModuleType, path: ModuleType) -> Run:
    """Drive along a path.

    Args:
        model: The generated model of the arm.
        path: The generated motion.

    Returns:
        What happened.
    """
    step, planner = step_function(model), Planner(model)
    q, qd, _ = path.motion(STEP * np.arange(STEPS + HORIZON + 1)[None, :])
    wanted = np.array(casadi.vertcat(q, qd)).T
    states, torques = [START], []
    for k in range(STEPS):
        torques.append(planner(states[-1], wanted[k + 1 : k + 1 + HORIZON]))
        after = np.array(step(states[-1], torques[-1])).ravel()
        states.append(after + PUSH if k + 1 == PUSHED else after)
    return Run(np.array(states), wanted[: STEPS + 1], np.array(torques))


class Planner:
    """Plans torques for the next steps (direct multiple shooting), each time beginning with the plan before."""

    def __init__(self, model: ModuleType) -> None:
        step = step_function(model)
        states, torques = casadi.SX.sym("X", 4, HORIZON), casadi.SX.sym("U", 2, HORIZON)
        start, wanted = casadi.SX.sym("start", 4), casadi.SX.sym("wanted", 4, HORIZON)
        before = casadi.horzcat(start, states)
        defects = [states[:, k] - step(before[:, k], torques[:, k]) for k in range(HORIZON)]
        problem = {
            "x": casadi.veccat(states, torques),
            "p": casadi.veccat(start, wanted),
            "f": self._cost(states - wanted, torques),
            "g": casadi.vertcat(*defects),
        }
        options = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "ipopt.max_iter": 100}
        self.solver = casadi.nlpsol("solver", "ipopt", problem, options)
        self.bound = np.concatenate([np.full(4 * HORIZON, np.inf), np.tile(LIMITS, HORIZON)])
        self.guess = np.concatenate([np.tile(START, HORIZON), np.zeros(2 * HORIZON)])

    @staticmethod
    def _cost(deviation: Any, torque: Any) -> Any:
        """Distance from the path, and a little of the effort."""
        return 100 * casadi.sumsqr(deviation[:2, :]) + casadi.sumsqr(deviation[2:, :]) + 1e-4 * casadi.sumsqr(torque)

    def __call__(self, state: Array, wanted: Array) -> Array:
        """The torques of the next step.

        Args:
            state: Where the arm is, (4,).
            wanted: Where it should be after each of the next steps, (HORIZON, 4).
        """
        parameters = np.concatenate([state, wanted.ravel()])
        found = self.solver(x0=self.guess, p=parameters, lbx=-self.bound, ubx=self.bound, lbg=0, ubg=0)
        self.guess = np.array(found["x"]).ravel()
        return np.clip(self.guess[4 * HORIZON :][:2], -LIMITS, LIMITS)


if __name__ == "__main__":
    sys.exit(main())

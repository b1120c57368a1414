"""Model predictive control with a generated CasADi model: a two-link arm swings itself up.

The motors are too weak to lift the arm: held out level it needs 21 N m at the first joint, and there are 9. So the
controller has to swing. Every 50 ms it plans the next two seconds with Ipopt, from where the arm is, and applies the
first torques.

    python examples/mpc_casadi.py

needs derive and CasADi, which brings Ipopt along.
"""

from __future__ import annotations

import importlib
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import casadi
import numpy as np
import numpy.typing as npt

import derive

ROBOT = Path(__file__).with_name("swing-up.yaml")
LIMITS = np.array([9.0, 6.0])
"""Greatest torques [N m]."""
STEP, HORIZON, STEPS = 0.05, 40, 120
"""Length of a step [s], steps that are planned ahead, and steps that are driven at most."""
HANGING, STANDING = np.array([-np.pi / 2, 0.0, 0.0, 0.0]), np.array([np.pi / 2, 0.0, 0.0, 0.0])
"""States: joint angles [rad], then rates [rad/s]."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """What happened.

    Attributes:
        states: Angles and rates at every step, (steps + 1, 4).
        torques: Torques in every step, (steps, 2).
        seconds: Wall time.
    """

    states: Array
    torques: Array
    seconds: float

    @property
    def error(self) -> float:
        """How far the last state is from standing still upright; whole turns do not count."""
        difference = self.states[-1] - STANDING
        difference[:2] = np.arctan2(np.sin(difference[:2]), np.cos(difference[:2]))
        return float(np.abs(difference).max())


def main() -> int:
    """Swing up and tell how it went."""
    with generated_model(ROBOT) as model:
        run = swing_up(model)
    stands = run.error < 0.02
    print(f"{'standing' if stands else 'not standing'} after {STEP * len(run.torques):.2f} s of motion")
    print(f"farthest torques: {np.abs(run.torques).max(axis=0).round(2)} N m of {LIMITS}")
    print(f"distance from standing still: {run.error:.1e} rad, rad/s")
    print(f"computed in {run.seconds:.1f} s, {1000 * run.seconds / len(run.torques):.0f} ms a step")
    return 0 if stands else 1


@contextmanager
def generated_model(robot: Path) -> Iterator[ModuleType]:
    """The CasADi model of a robot file, built for the occasion.

    Args:
        robot: Path of the robot file.

    Yields:
        The generated module, importable until the end of the block.
    """
    with tempfile.TemporaryDirectory() as folder:
        package = derive.build(robot, folder, targets=["casadi"], only=True).folder.name
        sys.path.insert(0, folder)
        try:
            yield importlib.import_module(f"{package}.model_casadi")
        finally:
            sys.path.remove(folder)


def swing_up(model: ModuleType) -> Run:
    """Drive until the arm stands still, or for `STEPS` steps.

    Args:
        model: The generated module.

    Returns:
        What happened.
    """
    started = time.perf_counter()
    step, plan = step_function(model), Planner(model)
    states, torques = [HANGING], []
    for _ in range(STEPS):
        torques.append(plan(states[-1]))
        states.append(np.array(step(states[-1], torques[-1])).ravel())
        if Run(np.array(states), np.array(torques), 0.0).error < 0.01:
            break
    return Run(np.array(states), np.array(torques), time.perf_counter() - started)


def step_function(model: ModuleType) -> casadi.Function:
    """The state one step later under constant torques (Runge-Kutta, fourth order).

    Args:
        model: The generated module.

    Returns:
        A CasADi function of state (4) and torques (2).
    """
    state, torque = casadi.SX.sym("x", 4), casadi.SX.sym("tau", 2)

    def rate(x: Any) -> Any:
        return casadi.vertcat(x[2:], model.forward_dynamics(x[:2], x[2:], torque))

    k1 = rate(state)
    k2 = rate(state + STEP / 2 * k1)
    k3 = rate(state + STEP / 2 * k2)
    k4 = rate(state + STEP * k3)
    return casadi.Function("step", [state, torque], [state + STEP / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])


class Planner:
    """Plans torques for the next steps (direct multiple shooting), each time beginning with the plan before."""

    def __init__(self, model: ModuleType) -> None:
        step = step_function(model)
        states, torques = casadi.SX.sym("X", 4, HORIZON + 1), casadi.SX.sym("U", 2, HORIZON)
        start = casadi.SX.sym("start", 4)
        defects = [states[:, 0] - start]
        defects += [states[:, k + 1] - step(states[:, k], torques[:, k]) for k in range(HORIZON)]
        cost = sum(self._cost(states[:, k + 1], torques[:, k]) for k in range(HORIZON))
        problem = {
            "x": casadi.veccat(states, torques),
            "p": start,
            "f": cost + 20 * self._cost(states[:, -1], 0 * torques[:, -1]),
            "g": casadi.vertcat(*defects),
        }
        options = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "ipopt.max_iter": 200}
        self.solver = casadi.nlpsol("solver", "ipopt", problem, options)
        self.bound = np.concatenate([np.full(4 * (HORIZON + 1), np.inf), np.tile(LIMITS, HORIZON)])
        self.guess: Array | None = None

    @staticmethod
    def _cost(state: Any, torque: Any) -> Any:
        """Height that is missing, motion and effort."""
        missing = 2 * (1 - casadi.sin(state[0])) + (1 - casadi.sin(state[0] + state[1]))
        return 10 * missing + 0.05 * casadi.sumsqr(state[2:]) + 0.002 * casadi.sumsqr(torque)

    def __call__(self, state: Array) -> Array:
        """The torques of the next step."""
        if self.guess is None:
            self.guess = np.concatenate([np.tile(state, HORIZON + 1), np.tile(0.5 * LIMITS, HORIZON)])
        found = self.solver(x0=self.guess, p=state, lbx=-self.bound, ubx=self.bound, lbg=0, ubg=0)
        plan = np.array(found["x"]).ravel()
        states, torques = plan[: 4 * (HORIZON + 1)].reshape(-1, 4), plan[4 * (HORIZON + 1) :].reshape(-1, 2)
        later = [states[1:], states[-1:], torques[1:], torques[-1:]]
        self.guess = np.concatenate([part.ravel() for part in later])
        return np.clip(torques[0], -LIMITS, LIMITS)


if __name__ == "__main__":
    sys.exit(main())

"""From one time to the next: friction that is smooth, by scipy's solvers, or exact, by time stepping."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from derive.errors import TargetError
from derive.motion.functions import Functions
from derive.motion.hermite import Array

TOLERANCE = 2e-11
"""Relative and absolute error of a step."""

STICTION_SPEED = 1e-4
"""Speed at which smooth friction has three quarters of its value [rad/s or m/s]: f tanh(qd/1e-4)."""

STEP = 1e-3
"""Longest time step of exact friction [s]."""

SWEEPS = 200
"""Most sweeps of the friction of one step."""

DIVERGED = 1e4
"""Speed beyond which a simulation is given up [rad/s or m/s]."""

PLANT = frozenset({"forward_dynamics", "inertia_matrix", "kinetic_energy", "potential_energy"})
"""Generated functions of a plant."""

Law = Callable[[float, Array, Array], Array]
"""Torques of the motors at a time, position and velocity."""


@dataclass(frozen=True)
class Plant:
    """The arm that is simulated.

    Attributes:
        functions: Those of `PLANT`, without dry friction.
        viscous: Coefficients of friction by velocity, which the functions hold.
        coulomb: Coefficients of dry friction, which they do not.
        push: What acts on the joints besides motors and friction [N m or N].
    """

    functions: Functions
    viscous: Array
    coulomb: Array
    push: Array

    def energy(self, q: Array, qd: Array) -> Array:
        """Kinetic and potential energy [J].

        Args:
            q: (..., n).
            qd: (..., n).
        """
        return self.functions("kinetic_energy", q, qd) + self.functions("potential_energy", q)


@dataclass(frozen=True, slots=True)
class Divergence:
    """Where a simulation was given up.

    Attributes:
        time: When [s].
        q: Joint variables then, (n,).
        qd: Velocities then, (n,).
    """

    time: float
    q: Array
    qd: Array

    @property
    def joint(self) -> int:
        """Index of the fastest joint."""
        return int(np.abs(self.qd).argmax())


Steps = tuple[Array, Divergence | None]
"""States at the times that are wanted, and where it ended earlier.

A state holds positions, velocities, the work of motors and pushes, and what friction took, in one vector.
"""


def smooth(plant: Plant, law: Law, state: Array, span: tuple[float, float], times: Array) -> Steps:
    """With friction f tanh(qd/v0): LSODA, or DOP853 where there is no dry friction.

    Args:
        plant: The arm.
        law: What the motors do.
        state: At the start.
        span: Start and end [s].
        times: Times that are wanted, within it.

    Returns:
        A row for each time.
    """
    try:
        from scipy.integrate import solve_ivp
    except ImportError:
        found = "simulations need scipy, which is not installed"
        raise TargetError(found, remedy="pip install 'derive-robot[motion]'") from None

    n = plant.coulomb.size
    dry, viscous, push = plant.coulomb, plant.viscous, plant.push
    frozen, rough, nothing = np.zeros_like(state), bool(dry.any()), np.zeros(n)

    def _rates(t: float, state: Array) -> Array:
        q, qd = state[:n], state[n : 2 * n]
        if not qd @ qd < 4 * n * DIVERGED**2:
            return frozen
        tau = law(t, q, qd) + push
        slip = dry * np.tanh(qd / STICTION_SPEED) if rough else nothing
        rates = np.empty_like(state)
        rates[:n] = qd
        rates[n : 2 * n] = plant.functions("forward_dynamics", q, qd, tau - slip)
        rates[-2], rates[-1] = tau @ qd, (slip + viscous * qd) @ qd
        return rates

    def _bounded(_: float, state: Array) -> float:
        return DIVERGED - float(np.abs(state[n : 2 * n]).max())

    _bounded.terminal = True  # type: ignore[attr-defined]
    method = "LSODA" if rough else "DOP853"
    with np.errstate(all="ignore"):
        found = solve_ivp(_rates, span, state, method, times, rtol=TOLERANCE, atol=TOLERANCE, events=_bounded)
    got = np.array(found.y).T.reshape(-1, state.size)
    if len(got) == len(times):
        return got, None
    if len(found.t_events[0]):
        end, last = float(found.t_events[0][0]), found.y_events[0][0]
    else:
        end, last = (float(found.t[-1]), got[-1]) if len(got) else (span[0], state)
    return got, Divergence(end, last[:n], last[n : 2 * n])


def exact(plant: Plant, law: Law, state: Array, span: tuple[float, float], times: Array) -> Steps:
    """With Coulomb friction that sticks: |qd| is zero, not small, below the torque of breakaway.

    A step of time h solves ``qd+ = qd + h qdd(tau) - B^-1 p`` for impulses p of friction with p = h f sign(qd+) where a
    joint slips and |p| <= h f where it sticks, by projected Gauss-Seidel (Moreau's time stepping; Acary and Brogliato,
    Numerical Methods for Nonsmooth Dynamical Systems, 2008).

    Args:
        plant: The arm.
        law: What the motors do.
        state: At the start.
        span: Start and end [s].
        times: Times that are wanted, ascending, the last of them the end.

    Returns:
        A row for each time.
    """
    n, t = plant.coulomb.size, span[0]
    q, qd, (work, lost) = state[:n], state[n : 2 * n], map(float, state[2 * n :])
    rows: list[Array] = []
    for wanted in times:
        steps = max(int(np.ceil((wanted - t) / STEP - 1e-9)), 1)
        h = float(wanted - t) / steps
        for _ in range(steps):
            tau = law(t, q, qd) + plant.push
            free = qd + h * plant.functions("forward_dynamics", q, qd, tau)
            mobility = np.linalg.inv(plant.functions("inertia_matrix", q))
            slipping, impulses = _slipping(mobility.tolist(), free.tolist(), (h * plant.coulomb).tolist())
            after, impulse = np.array(slipping), np.array(impulses)
            mean = (qd + after) / 2
            work += h * float(tau @ mean)
            lost += float((impulse + h * plant.viscous * mean) @ mean)
            q, qd, t = q + h * after, after, t + h
            if not np.all(np.abs(qd) < DIVERGED):
                return np.array(rows).reshape(-1, state.size), Divergence(t, q, qd)
        t = float(wanted)
        rows.append(np.concatenate([q, qd, [work, lost]]))
    return np.array(rows), None


def _slipping(mobility: list[list[float]], free: list[float], most: list[float]) -> tuple[Sequence[float], list[float]]:
    """Velocities after a step and the impulses of friction."""
    joints = range(len(free))
    impulse, velocity = [0.0] * len(free), list(free)
    enough = 1e-14 * max(*most, 1e-300)
    for _ in range(SWEEPS):
        largest = 0.0
        for j in joints:
            wanted = impulse[j] + velocity[j] / mobility[j][j]
            new = min(max(wanted, -most[j]), most[j])
            change = new - impulse[j]
            if change:
                largest, impulse[j] = max(largest, abs(change)), new
                for i in joints:
                    velocity[i] -= mobility[i][j] * change
        if largest <= enough:
            break
    return [0.0 if abs(impulse[j]) < most[j] else velocity[j] for j in joints], impulse

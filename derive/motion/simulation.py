"""The arm under a control law: forward dynamics in time, friction smooth or exact, and where the energy went."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

from derive.motion.functions import Functions
from derive.motion.hermite import Array

TOLERANCE = 1e-10
"""Relative and absolute error of a step."""

STICTION_SPEED = 1e-4
"""Speed at which smooth friction has three quarters of its value [rad/s or m/s]: f tanh(qd/1e-4)."""

STEP = 1e-3
"""Time step of exact friction [s]."""

SWEEPS = 200
"""Most sweeps of the friction of one step."""

DIVERGED = 1e8
"""Speed beyond which a simulation is given up [rad/s or m/s]."""


@dataclass(frozen=True, slots=True)
class Run:
    """A simulated motion.

    Attributes:
        t: Times [s], (samples,).
        q: Joint variables, (samples, n).
        qd: Velocities, (samples, n).
        tau: Torques of the motors, (samples, n).
        energy: Kinetic and potential energy [J], (samples,).
        work: Of the motors and disturbances up to then [J], (samples,).
        lost: To friction up to then [J], (samples,).
        reached: Whether the end was reached; else it is the time at which it was given up.
    """

    t: Array
    q: Array
    qd: Array
    tau: Array
    energy: Array
    work: Array
    lost: Array
    reached: bool

    @property
    def energy_error(self) -> float:
        """The largest gap in the ledger [J]: energy at the start and work, less losses, less energy now."""
        return float(np.abs(self.energy[0] + self.work - self.lost - self.energy).max())


Law = Callable[[float, Array, Array], Array]
"""Torques of the motors at a time, position and velocity."""


@dataclass(frozen=True, slots=True)
class _Row:
    """A sample: positions, velocities, work and losses in one vector, and the torques."""

    t: float
    state: Array
    tau: Array


PLANT = frozenset({"forward_dynamics", "inertia_matrix", "kinetic_energy", "potential_energy"})
"""Generated functions of a plant."""


@dataclass(frozen=True)
class Plant:
    """The arm that is simulated.

    Attributes:
        functions: Those of `PLANT`, without dry friction.
        viscous: Coefficients of friction by velocity, which the functions hold.
        coulomb: Coefficients of dry friction, which they do not.
    """

    functions: Functions
    viscous: Array
    coulomb: Array

    def energy(self, q: Array, qd: Array) -> Array:
        """Kinetic and potential energy [J].

        Args:
            q: (..., n).
            qd: (..., n).
        """
        return self.functions("kinetic_energy", q, qd) + self.functions("potential_energy", q)


def simulate_smooth(
    plant: Plant, law: Law, start: tuple[Array, Array], times: Array, period: float | None, *, friction: bool
) -> Run:
    """With friction f tanh(qd/v0), or without dry friction.

    Args:
        plant: The arm.
        law: What the motors do.
        start: Positions and velocities at the first time, (n,) each.
        times: Times of the samples [s], ascending.
        period: Time between two looks of a controller that holds its torques in between [s]; None for a continuous one.
        friction: Whether there is dry friction.

    Returns:
        The motion; up to where it diverges.
    """
    n = start[0].size
    dry = plant.coulomb if friction else np.zeros(n)
    state = np.concatenate([*start, [0.0, 0.0]])
    rows = [_Row(times[0], state, law(times[0], *start))]
    edges = [times[0], times[-1]] if period is None else _edges(times[0], times[-1], period)
    for a, b in pairwise(edges):
        held = None if period is None else law(a, state[:n], state[n : 2 * n])

        def _torque(t: float, q: Array, qd: Array, held: Array | None = held) -> Array:
            return law(t, q, qd) if held is None else held

        def _rates(t: float, state: Array, torque: Law = _torque) -> Array:
            q, qd = state[:n], state[n : 2 * n]
            tau = torque(t, q, qd)
            slip = dry * np.tanh(qd / STICTION_SPEED)
            qdd = plant.functions("forward_dynamics", q, qd, tau - slip)
            return np.concatenate([qd, qdd, [tau @ qd, (slip + plant.viscous * qd) @ qd]])

        inside = times[(times > a) & (times <= b)]
        wanted = inside if inside.size and inside[-1] == b else np.append(inside, b)
        with np.errstate(all="ignore"):
            found = solve_ivp(
                *(_rates, (a, b), state, "LSODA" if dry.any() else "DOP853", wanted),
                rtol=TOLERANCE,
                atol=TOLERANCE,
                events=_growth(n),
            )
        got = np.array(found.y).T.reshape(-1, state.size)
        rows += [_Row(t, y, _torque(t, y[:n], y[n : 2 * n])) for t, y in zip(inside, got, strict=False)]
        if len(got) < wanted.size:
            return _run(plant, rows, reached=False)
        state = got[-1]
    return _run(plant, rows, reached=True)


def _edges(start: float, end: float, period: float) -> list[float]:
    """When a sampled controller looks, and the end."""
    count = int(np.ceil((end - start) / period - 1e-9))
    return [*(start + period * np.arange(count)), end]


def _growth(n: int) -> Callable[[float, Array], float]:
    """An event that ends a simulation whose speeds grow beyond all bounds."""

    def _bounded(_: float, state: Array) -> float:
        return DIVERGED - float(np.abs(state[n : 2 * n]).max())

    _bounded.terminal = True  # type: ignore[attr-defined]
    return _bounded


def simulate_exact(plant: Plant, law: Law, start: tuple[Array, Array], times: Array, period: float | None) -> Run:
    """With Coulomb friction that sticks: |qd| is zero, not small, below the torque of breakaway.

    A step of time h solves ``qd+ = qd + h qdd(tau) - B^-1 p`` for impulses p of friction with p = h f sign(qd+) where a
    joint slips and |p| <= h f where it sticks, by projected Gauss-Seidel (Moreau's time stepping; Acary and Brogliato,
    Numerical Methods for Nonsmooth Dynamical Systems, 2008).

    Args:
        plant: The arm.
        law: What the motors do.
        start: Positions and velocities at the first time, (n,) each.
        times: Times of the samples [s], ascending.
        period: Time between two looks of a controller that holds its torques in between [s]; None for a continuous one.

    Returns:
        The motion; up to where it diverges.
    """
    q, qd = start
    t, work, lost = float(times[0]), 0.0, 0.0
    tau, looks = law(t, q, qd), t + (period or 0.0)
    rows = [_Row(t, np.concatenate([q, qd, [work, lost]]), tau)]
    for sample in times[1:]:
        steps = int(np.ceil((sample - t) / min(STEP, period or STEP) - 1e-9))
        h = (sample - t) / steps
        for _ in range(steps):
            if period is None or t >= looks - 1e-9 * period:
                tau, looks = law(t, q, qd), looks + (period or 0.0)
            free = qd + h * plant.functions("forward_dynamics", q, qd, tau)
            mobility = np.asarray(np.linalg.inv(plant.functions("inertia_matrix", q)), dtype=float)
            after, impulse = _slipping(mobility, free, h * plant.coulomb)
            mean = (qd + after) / 2
            work += h * float(tau @ mean)
            lost += float((impulse + h * plant.viscous * mean) @ mean)
            q, qd, t = q + h * after, after, t + h
            if not np.all(np.abs(qd) < DIVERGED):
                return _run(plant, rows, reached=False)
        t = float(sample)
        rows.append(_Row(t, np.concatenate([q, qd, [work, lost]]), law(t, q, qd) if period is None else tau))
    return _run(plant, rows, reached=True)


def _slipping(mobility: Array, free: Array, most: Array) -> tuple[Array, Array]:
    """Velocities after a step and the impulses of friction."""
    impulse = np.zeros_like(free)
    velocity = free.copy()
    for _ in range(SWEEPS):
        before = impulse.copy()
        for j in range(free.size):
            wanted = impulse[j] + velocity[j] / mobility[j, j]
            new = min(max(wanted, -most[j]), most[j])
            velocity -= mobility[:, j] * (new - impulse[j])
            impulse[j] = new
        if np.abs(impulse - before).max() <= 1e-14 * max(most.max(), 1e-300):
            break
    velocity[np.abs(impulse) < most] = 0.0
    return velocity, impulse


def _run(plant: Plant, rows: list[_Row], *, reached: bool) -> Run:
    states = np.array([row.state for row in rows])
    n = plant.coulomb.size
    q, qd = states[:, :n].copy(), states[:, n : 2 * n].copy()
    t, tau = np.array([row.t for row in rows]), np.array([row.tau for row in rows])
    return Run(t, q, qd, tau, plant.energy(q, qd), states[:, 2 * n], states[:, 2 * n + 1], reached)

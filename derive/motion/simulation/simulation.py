"""The arm under a control law: forward dynamics in time, stage by stage, and where the energy went."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import groupby, pairwise

import numpy as np

from derive.arrays import Array
from derive.motion.simulation.stepping import Divergence, Law, Plant, smooth
from derive.motion.simulation.sticking import exact

SAME = 1e-9  # times closer than this are one [s]


@dataclass(frozen=True, slots=True)
class Run:
    """A simulated motion."""

    t: Array  # times [s], (samples,)
    q: Array  # joint variables, (samples, n)
    qd: Array  # velocities, (samples, n)
    tau: Array  # torques of the motors, (samples, n)
    energy: Array  # kinetic and potential energy [J], (samples,); in the world where the base moves
    work: Array  # of the motors up to then, the integral of tau qd [J], (samples,)
    brought: Array  # what bodies brought that were taken up, less what those took that were put down [J], (samples,)
    lost: Array  # to friction up to then [J], (samples,)
    divergence: Divergence | None  # where it was given up, with the samples up to then; None where the end was reached
    pushed: Array = field(default_factory=lambda: np.zeros(1))  # work of the disturbances up to then [J], (samples,)
    base: Array = field(default_factory=lambda: np.zeros(1))  # work of a moving base on the arm up to then [J]

    @property
    def reached(self) -> bool:
        """Whether the end was reached."""
        return self.divergence is None

    @property
    def energy_error(self) -> float:
        """The largest gap in the ledger [J]: energy at the start and all work, less losses, less energy now."""
        given = self.work + self.brought + self.pushed + self.base
        return float(np.abs(self.energy[0] + given - self.lost - self.energy).max())


@dataclass(frozen=True)
class Stage:
    """A time in which neither the load nor a disturbance changes."""

    start: float  # when it begins [s]; it ends with the next
    plant: Plant  # the arm with what it carries
    law: Law  # what its motors do


def simulate(
    stages: Sequence[Stage],
    start: tuple[Array, Array],
    times: Array,
    period: float | None,
    *,
    sticks: bool,
    jumps: Sequence[float] = (),
) -> Run:
    """A motion from positions and velocities at the first of ascending times [s].

    A controller holds its torques between two looks, a period [s] apart; None for a continuous one, whose integration
    does not go across times at which what it wants jumps [s], infinite where nothing is controlled.
    """
    n = start[0].size
    begins = [stage.start for stage in stages]
    edges = _edges(times, [*begins, *jumps] if period is None else begins, period)
    stage, brought, pushed, divergence = stages[0], 0.0, np.zeros(1), None
    state = np.concatenate([*start, np.zeros(2 if stage.plant.base is None else 3)])
    held = stage.law(float(times[0]), *start)
    parts = [_Stretch(times[:1], state[None], held[None], stage.plant, brought, pushed)]
    for (a, looks), (b, _) in pairwise(edges):
        now = [other for other in stages if other.start <= a + SAME][-1]
        if now is not stage:
            # what is taken up or put down has the speed of the hand then
            heavier, lighter = (
                plant.energy(state[None, :n], state[None, n : 2 * n], np.array([a]))[0]
                for plant in (now.plant, stage.plant)
            )
            brought, stage = brought + float(heavier - lighter), now
        if looks:
            held = stage.law(a, state[:n], state[n : 2 * n])
        law = _motors(stage.law, held, b, is_sampled=period is not None)
        # Samples after a up to b, and b itself, from which the next integration starts.
        inside = times[slice(*np.searchsorted(times, (a, b), side="right"))]
        wanted = inside if inside.size and inside[-1] == b else np.append(inside, b)
        if stage.plant.held:
            rows, divergence = stage.plant.held(stage.plant, held, state, (a, b), wanted)
        else:
            step = exact if sticks and stage.plant.coulomb.any() else smooth
            rows, divergence = step(stage.plant, law, state, (a, b), wanted)
        kept = rows[: inside.size]
        tau = [law(float(t), row[:n], row[n : 2 * n]) for t, row in zip(inside, kept, strict=False)]
        # The work of a constant push is push . (q - q_a).
        pushes = pushed[-1] + (rows[:, :n] - state[:n]) @ stage.plant.push
        part = inside[: len(kept)], kept, np.array(tau).reshape(-1, n), stage.plant, brought, pushes[: len(kept)]
        parts.append(_Stretch(*part))
        if divergence is not None:
            break
        state, pushed = rows[-1], pushes
    return _run(parts, divergence)


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Samples between two edges: times, states, torques, the arm, what bodies brought and the work of pushes [J]."""

    t: Array
    states: Array
    tau: Array
    plant: Plant
    brought: float
    pushed: Array


def _edges(times: Array, begins: Sequence[float], period: float | None) -> list[tuple[float, bool]]:
    """Times at which an integration begins anew and whether the controller looks then; the end as the last."""
    start, end = float(times[0]), float(times[-1])
    count = 0 if period is None else int(np.ceil((end - start) / period - 1e-9))
    looks = [start + (period or 0.0) * k for k in range(count)]
    merged: list[tuple[float, bool]] = []
    for t, look in sorted([*((t, True) for t in looks), *((t, False) for t in (start, *begins))]):
        if merged and t - merged[-1][0] <= SAME:
            merged[-1] = (merged[-1][0], merged[-1][1] or look)
        elif t < end - SAME:
            merged.append((t, look))
    return [*merged, (end, False)]


def _motors(law: Law, held: Array, end: float, *, is_sampled: bool) -> Law:
    """What drives the motors up to an end: held torques, or a law that does not see what is wanted from the end on."""
    last = float(np.nextafter(end, -np.inf))  # what is wanted may jump at the end
    return (lambda *_: held) if is_sampled else (lambda t, q, qd: law(min(t, last), q, qd))


def _run(parts: Sequence[_Stretch], divergence: Divergence | None) -> Run:
    n = parts[0].tau.shape[1]
    states = np.concatenate([part.states for part in parts])
    energies = []
    # One call for all samples of a plant, which is as many times faster as there are looks of a controller.
    for _, same in groupby((part for part in parts if part.t.size), key=lambda part: id(part.plant)):
        of_plant = list(same)
        rows, when = (np.concatenate([getattr(part, name) for part in of_plant]) for name in ("states", "t"))
        energies.append(of_plant[0].plant.energy(rows[:, :n], rows[:, n : 2 * n], when))
    pushed = np.concatenate([part.pushed for part in parts])
    return Run(
        t=np.concatenate([part.t for part in parts]),
        q=states[:, :n].copy(),
        qd=states[:, n : 2 * n].copy(),
        tau=np.concatenate([part.tau for part in parts]),
        energy=np.concatenate(energies),
        work=states[:, 2 * n] - pushed,
        brought=np.concatenate([np.full(len(part.t), part.brought) for part in parts]),
        lost=states[:, 2 * n + 1],
        divergence=divergence,
        pushed=pushed,
        base=states[:, 2 * n + 2] if states.shape[1] > 2 * n + 2 else np.zeros(len(states)),
    )

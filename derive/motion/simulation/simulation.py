"""The arm under a control law: forward dynamics in time, stage by stage, and where the energy went."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby, pairwise

import numpy as np

from derive.arrays import Array
from derive.errors import RobotFileError
from derive.motion.curves.trajectory import Trajectory
from derive.motion.simulation.stepping import PLANT, Divergence, Law, Plant, held_arm, rows_of, smooth
from derive.motion.simulation.sticking import exact
from derive.motion.torques.base_torques import BaseTorques, OpenLinks
from derive.motion.torques.functions import Functions
from derive.plans.plan import Plan
from derive.plans.segments import Payload
from derive.robot.evaluate import evaluate
from derive.robot.expression import ZERO

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
        if (now := [other for other in stages if other.start <= a + SAME][-1]) is not stage:
            # what is taken up or put down has the speed of the hand then
            here = state[None, :n], state[None, n : 2 * n], np.array([a])
            brought += float(now.plant.energy(*here)[0] - stage.plant.energy(*here)[0])
            stage = now
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


# -- from a plan to its stages: who drives the arm, what it carries and what pushes it
#
# Control laws: Siciliano et al., Robotics, 2009, 8.5.1 (PD with gravity), 8.5.2 (computed torque: inverse dynamics).

RATES = {"none": 200.0, "smooth": 4000.0, "exact": 2000.0}  # calls of a simulated second, about, by friction
MOST_LOOKS = 1_000_000  # of a sampled controller
CALLS_PER_LOOK = 30.0  # calls from one look of a sampled controller to the next, about
Reference = Callable[[float], tuple[Array, Array, Array]]  # position, velocity and acceleration wanted at a time
# Generated functions of each law.
NEEDS: dict[str, frozenset[str]] = {
    "none": frozenset(),
    "pd": frozenset(),
    "pd-gravity": frozenset({"gravity_vector"}),
    "computed-torque": frozenset({"inverse_dynamics"}),
}


@dataclass(frozen=True)
class Controller:
    """A control law with its gains."""

    law: str  # one of `NEEDS`
    kp: Array  # gains of the position, (n,)
    kd: Array  # gains of the velocity, (n,)
    reference: Reference  # what is wanted
    functions: Functions | None  # the model that it knows, without dry friction; None where the law needs none
    inertial: Callable[[float, Array, Array], Array] | None = None  # what a base adds that moves; None where it stands

    def __call__(self, t: float, q: Array, qd: Array) -> Array:
        """Torques of the motors, (n,) [N m or N]."""
        if self.law == "none":
            return np.zeros(q.size)
        # pd               tau = Kp e + Kd de/dt
        # pd-gravity       tau = Kp e + Kd de/dt + g(q)
        # computed-torque  tau = B(q) (qdd_d + Kd de/dt + Kp e) + C(q, qd) qd + g(q)
        wanted, velocity, acceleration = self.reference(t)
        tau: Array = self.kp * (wanted - q) + self.kd * (velocity - qd)
        if self.functions is None:
            return tau
        inertial = 0.0 if self.inertial is None else self.inertial(t, q, qd)
        if self.law == "pd-gravity":
            return tau + self.functions("gravity_vector", q) + inertial
        return self.functions("inverse_dynamics", q, qd, acceleration + tau) + inertial


def looked_up(reference: Callable[[Array], tuple[Array, Array, Array]], period: float, duration: float) -> Reference:
    """What is wanted at the looks of a sampled controller [s], computed at once for all of a motion [s]."""
    q, qd, qdd = reference(period * np.arange(np.ceil(duration / period) + 1))
    return lambda t: (q[k := round(t / period)], qd[k], qdd[k])


def stages_of(
    plan: Plan, trajectory: Trajectory, values: Mapping[str, float], calls: float | None, added: BaseTorques | None
) -> list[Stage]:
    """The stages of a simulation whose functions will be called so often; None for an estimate."""
    # The controller knows the robot, how its base moves and what the path says that the tool carries; it knows nothing
    # of disturbances and of what stands under plant:.
    robot, control = plan.robot, plan.control
    # Numbers that the plant has otherwise stay symbols; dry friction is the simulation's, not the functions'.
    numbers = tuple(pair for pair in robot.parameters if pair[0] not in plan.plant)
    bare = replace(robot, links=tuple(replace(link, coulomb=ZERO) for link in robot.links), parameters=numbers)
    loads = [plan.plant_payload, *(step.payload for step in plan.steps)]
    link = OpenLinks.of(bare, loads) if any(loads) else None
    period = evaluate(control.period, values) if control.period and control.law != "none" else None
    reference = looked_up(trajectory, period, float(trajectory.duration)) if period else trajectory
    rate = max(RATES[plan.friction], CALLS_PER_LOOK / period if period else 0.0)
    expected = rate * float(trajectory.duration) if calls is None else calls
    needed = PLANT | NEEDS[control.law] | ({"passive_positions"} if robot.passive else set())
    known = link.carrying(bare, values) if link else values
    true = {**values, **{name: evaluate(value, values) for name, value in plan.plant.items()}}
    viscous = np.array([evaluate(each.viscous, true) for each in robot.links])
    coulomb = np.array([[evaluate(each.dry[way], true) for each in robot.links] for way in (0, 1)])
    coulomb = np.zeros_like(coulomb) if plan.friction == "none" else coulomb
    arm = link.robot if link else bare
    keeps = (period or control.law == "none") and (not coulomb.any() or (period and plan.friction == "smooth"))
    # Steps in C for torques that are held, where dry friction is smooth or there is none.
    held = held_arm(arm, expected) if keeps and added is None and not robot.coupled else None
    functions = Functions(arm, needed, known, calls=expected / (CALLS_PER_LOOK if held and calls is None else 1))
    kp, kd = (np.array([evaluate(gain, values) for gain in row]) for row in (control.kp, control.kd))

    def _numbers(numbers: Mapping[str, float], payloads: Sequence[Payload | None]) -> Mapping[str, float]:
        return link.carrying(bare, numbers, payloads) if link else numbers

    stages = []
    for start in _changes(plan, trajectory, values):
        pairs = zip(plan.steps, trajectory.segments, strict=False)
        carried = [None, *(step.payload for step, segment in pairs if float(segment.start) <= start)][-1]
        push = np.zeros(robot.dof)
        for each in plan.disturbances:
            if evaluate(each.start, values) <= start < evaluate(each.end, values):
                push[each.joint] += evaluate(each.torque, values)
        actual = _numbers(true, (carried, plan.plant_payload))
        base = replace(added, values=true).carrying(carried, plan.plant_payload) if added else None
        own = functions.given(actual)
        rows = rows_of(replace(robot, links=(), gravity=None), true, own) if robot.coupled else None
        plant = Plant(own, viscous, coulomb, push, held(actual) if held else None, base, rows)
        model = functions.given(_numbers(values, (carried,))) if NEEDS[control.law] else None
        known_inertial = added.single(carried) if added else None
        stages.append(Stage(start, plant, Controller(control.law, kp, kd, reference, model, known_inertial)))
    return stages


def period_of(plan: Plan, values: Mapping[str, float], duration: float) -> float | None:
    """Time between two looks of the controller [s]; None for a continuous one, infinite without control."""
    if (control := plan.control).law == "none":
        return float(np.inf)
    period = None if control.period is None else evaluate(control.period, values)
    if period is not None and duration / period > MOST_LOOKS:
        found = f"control, period: {duration / period:.4g} samples of the controller in {duration:.6g} s"
        allowed, remedy = f"allowed: at most {MOST_LOOKS}", f"write period: {duration / 1e4:.2g} [s]"
        raise RobotFileError(found, allowed=allowed, remedy=remedy, location=plan.places["period"])
    return period


def _changes(plan: Plan, trajectory: Trajectory, values: Mapping[str, float]) -> list[float]:
    end, found = float(trajectory.duration), {0.0}
    for before, step, segment in zip([None, *plan.steps], plan.steps, trajectory.segments, strict=False):
        if before is not None and before.payload != step.payload:
            found.add(float(segment.start))
    for each in plan.disturbances:
        found |= {evaluate(each.start, values), evaluate(each.end, values)}
    return sorted(t for t in found if 0 <= t < end)

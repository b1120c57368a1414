"""From a plan to what is simulated: who drives the arm, what it carries and what pushes it, stage by stage.

Control laws: Siciliano et al., Robotics, 2009, 8.5.1 (PD with gravity), 8.5.2 (computed torque: inverse dynamics).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from derive.arrays import Array
from derive.errors import RobotFileError
from derive.motion.curves.trajectory import Trajectory
from derive.motion.simulation.held import held_arm
from derive.motion.simulation.simulation import Stage
from derive.motion.simulation.stepping import PLANT, Plant
from derive.motion.torques.base_torques import BaseTorques
from derive.motion.torques.bodies import OpenLink
from derive.motion.torques.functions import Functions
from derive.plans.plan import Plan
from derive.plans.segments import Payload
from derive.robot.evaluate import evaluate
from derive.robot.expression import ZERO

# Calls of a simulated second, about, by how friction is treated.
RATES = {"none": 200.0, "smooth": 4000.0, "exact": 2000.0}
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
    plan: Plan,
    trajectory: Trajectory,
    values: Mapping[str, float],
    calls: float | None,
    added: BaseTorques | None = None,
) -> list[Stage]:
    """The stages of a simulation whose functions will be called so often; None for an estimate.

    The controller knows the robot, how its base moves and what the path says that the tool carries; it knows nothing of
    disturbances and of what stands under ``plant``.
    """
    robot, control = plan.robot, plan.control
    # Numbers that the plant has otherwise stay symbols; dry friction is the simulation's, not the functions'.
    numbers = tuple(pair for pair in robot.parameters if pair[0] not in plan.plant)
    bare = replace(robot, links=tuple(replace(link, coulomb=ZERO) for link in robot.links), parameters=numbers)
    loaded = plan.plant_payload or any(step.payload for step in plan.steps)
    link = OpenLink.of(bare) if loaded else None
    period = evaluate(control.period, values) if control.period and control.law != "none" else None
    reference = looked_up(trajectory, period, float(trajectory.duration)) if period else trajectory
    rate = max(RATES[plan.friction], CALLS_PER_LOOK / period if period else 0.0)
    expected = rate * float(trajectory.duration) if calls is None else calls
    needed = PLANT | NEEDS[control.law]
    known = link.carrying(bare, values) if link else values
    true = {**values, **{name: evaluate(value, values) for name, value in plan.plant.items()}}
    viscous = np.array([evaluate(each.viscous, true) for each in robot.links])
    coulomb = np.array([[evaluate(each.dry[way], true) for each in robot.links] for way in (0, 1)])
    if plan.friction == "none":
        coulomb = np.zeros_like(coulomb)
    arm = link.robot if link else bare
    slides = not coulomb.any()
    keeps = (period or control.law == "none") and (slides or (period and plan.friction == "smooth"))
    # Steps in C for torques that are held, where dry friction is smooth or there is none.
    held = held_arm(arm, known, expected) if keeps and added is None else None
    functions = Functions(arm, needed, known, calls=expected / (CALLS_PER_LOOK if held and calls is None else 1))
    kp, kd = (np.array([evaluate(gain, values) for gain in row]) for row in (control.kp, control.kd))

    def _numbers(numbers: Mapping[str, float], payloads: Sequence[Payload | None]) -> Mapping[str, float]:
        return link.carrying(bare, numbers, payloads) if link else numbers

    stages = []
    for start in _changes(plan, trajectory, values):
        pairs = zip(plan.steps, trajectory.segments, strict=False)
        carried = [None, *(step.payload for step, segment in pairs if float(segment.start) <= start)][-1]
        push = np.zeros(robot.n)
        for each in plan.disturbances:
            if evaluate(each.start, values) <= start < evaluate(each.end, values):
                push[each.joint] += evaluate(each.torque, values)
        actual = _numbers(true, (carried, plan.plant_payload))
        base = replace(added, values=true).carrying(carried, plan.plant_payload) if added else None
        steps = held.given(actual) if held else None
        plant = Plant(functions.given(actual), viscous, coulomb, push, steps, base)
        model = functions.given(_numbers(values, (carried,))) if NEEDS[control.law] else None
        known_inertial = added.single(carried) if added else None
        stages.append(Stage(start, plant, Controller(control.law, kp, kd, reference, model, known_inertial)))
    return stages


def period_of(plan: Plan, values: Mapping[str, float], duration: float) -> float | None:
    """Time between two looks of the controller [s]; None for a continuous one, infinite without control."""
    control = plan.control
    if control.law == "none":
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

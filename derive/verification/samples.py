"""Random configurations, motions and parameters at which generated code is compared."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from derive.errors import ExpressionError, VerificationError
from derive.inverse.loops.linkage import SolvedLoop, linkage, positions
from derive.model.identification.base_parameters import base_set
from derive.robot.description import Joint, Variable
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import names
from derive.robot.inertial_parameters import Parameter, has_regressor
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import Array
from derive.verification.oracle.functions import Oracle

# Ranges tried in turn for free parameters, until every cell has a value: ``sqrt(a1 - 2)`` needs a1 > 2.
REGIONS = ((0.3, 1.7), (0.05, 0.4), (1.5, 4.0), (5.0, 20.0), (0.001, 0.01))
ATTEMPTS = 30  # draws from each range in search of physical inertia tensors
SPECIAL = 2  # the zero configuration, which finds divisions by zero, and a state at rest, which finds signs of zero
POOL = 1024  # configurations of a robot with loops that are tried
CLEAR = 0.05  # share of the best clearance from the configurations in which passive joints are not determined
BESIDE = 0.02  # how far passive joints start from where loops close [rad, or lengths of the arm]
GENERIC = 3  # fewest other states of a set: at the special ones most wrong terms vanish
Parameters = Mapping[str, Any]  # a number, or an array that broadcasts against the batch, for every free symbol


@dataclass(frozen=True, slots=True, eq=False)
class SampleSet:
    """Configurations at one choice of parameters."""

    parameters: Mapping[str, float]  # numbers of the free symbols
    oracle: Oracle  # the robot with these numbers
    # q, qd, qdd and tau, (samples, n) each, and h, (samples, 6); of loops without formulas q_p, and a start beside it.
    arguments: Mapping[str, Array]


def sample_sets(robot: Robot, samples: int, rng: np.random.Generator) -> tuple[SampleSet, ...]:
    """Random samples: one set where nothing is free, else three with other parameters each."""
    number = 3 if free_symbols(robot) else 1
    count = max(SPECIAL + GENERIC, -(-samples // number))
    base = base_set(robot).parameters if has_regressor(robot) else None
    sets = []
    for index in range(number):
        parameters, oracle, q = _draw_positions(robot, index, count, rng, base)
        qd, qdd = rng.uniform(-2.0, 2.0, (2, count, robot.dof))
        qd[-1] = 0.0
        tau = oracle.evaluate("inverse_dynamics", q, qd, qdd) if oracle.dynamic else np.zeros_like(q)
        h = rng.spawn(1)[0].uniform(-10.0, 10.0, (count, 6))  # without a change of what is drawn next
        arguments = {"q": q, "qd": qd, "qdd": qdd, "tau": tau, "h": h}
        if oracle.is_iterated:
            passive = oracle.following(q).x[:, oracle.arm.passive]
            beside = BESIDE * rng.spawn(1)[0].uniform(-1.0, 1.0, passive.shape)
            scale = np.where(oracle.arm.revolute[oracle.arm.passive], 1.0, oracle.arm.length)
            arguments |= {"q_p": passive, "start": passive + beside * scale}
        sets.append(SampleSet(parameters, oracle, arguments))
    return tuple(sets)


def oracle_of(
    robot: Robot, parameters: Mapping[str, float] | None = None, base: tuple[Parameter, ...] | None = None
) -> Oracle:
    """The oracle of a robot, which closes loops from their closed form on."""
    if not robot.loops:
        return Oracle.of(robot, parameters, base)
    loops, passive = linkage(robot), [k for k, joint in enumerate(robot.joints) if joint.follows]
    numbers = parameter_values(robot, parameters)

    def _guess(q: Array) -> Array:
        with np.errstate(all="ignore"):
            found, exists = positions(robot, loops, list(q.T), numbers)
        return np.where(exists[:, None], np.stack([found[k] for k in passive], axis=-1), np.nan)

    is_iterated = not all(isinstance(one, SolvedLoop) for one in loops)
    return replace(Oracle.of(robot, parameters, base), guess=_guess, is_iterated=is_iterated)


def _draw_positions(
    robot: Robot, index: int, count: int, rng: np.random.Generator, base: tuple[Parameter, ...] | None
) -> tuple[dict[str, float], Oracle, Array]:
    """Parameters, and configurations at which loops close and their passive joints are well determined."""
    for _ in range(ATTEMPTS):
        parameters = _draw_parameters(robot, index, rng)
        oracle = oracle_of(robot, parameters, base)
        low, high = np.array([_range(joint, robot, parameters) for joint in robot.variables]).T
        q = rng.uniform(low, high, (POOL if robot.loops else count, robot.dof))
        q[0] = np.clip(0.0, low, high)
        if robot.loops:
            clearance = oracle.following(q).clearance()
            q = q[clearance > CLEAR * clearance.max()][:count]
        if len(q):
            return parameters, oracle, np.resize(q, (count, robot.dof))
    found = f"robot {robot.name!r}: its loops close in none of {ATTEMPTS * POOL} configurations that were tried"
    raise VerificationError(found, remedy="give its variables limits within which they close")


def _range(joint: Joint | Variable, robot: Robot, parameters: Mapping[str, float]) -> tuple[float, float]:
    """The limits where they are numbers in order, else a turn or a metre to each side."""
    widest = (-np.pi, np.pi) if joint.is_revolute else (-1.0, 1.0)
    if joint.limits is None:
        return widest
    try:
        values = parameter_values(robot, parameters)
        low, high = (to_float(limit, values) for limit in joint.limits)
    except ExpressionError:
        return widest
    return (low, high) if low < high else widest


def _draw_parameters(robot: Robot, index: int, rng: np.random.Generator) -> dict[str, float]:
    """Positive numbers, the file's own in the first set, at which the robot is finite and if possible physical."""
    free = free_symbols(robot)
    tensors = [link.inertia for link in (*robot.links, *(row.link for row in robot.fixed)) if link]
    products = {name for tensor in tensors for cell in (tensor.xy, tensor.xz, tensor.yz) for name in names(cell)}
    known = {name: value for name, value in parameter_values(robot).items() if name in free}
    fallback: dict[str, float] | None = None
    for low, high in [region for region in REGIONS for _ in range(ATTEMPTS if free else 1)]:
        # large products of inertia would make a tensor indefinite
        numbers = {name: float(rng.uniform(low, high)) * (0.02 if name in products else 1.0) for name in free}
        for name, value in known.items():
            numbers[name] = float(value) * (1.0 if index == 0 else numbers[name] / high)
        try:
            arm = Oracle.of(robot, numbers).arm
        except ExpressionError:
            continue
        definite = bool((np.linalg.eigvalsh(arm.inertia) >= -1e-12).all())
        if not numbers or (definite and (arm.mass >= 0).all() and (arm.rotor_inertia >= 0).all()):
            return numbers
        fallback = fallback or numbers
    if fallback is None:
        found = f"robot {robot.name!r}: no numbers were found for its free symbols at which every cell has a value"
        raise VerificationError(found, remedy="give them numbers under 'parameters'")
    return fallback

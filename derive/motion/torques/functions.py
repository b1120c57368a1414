"""The generated functions of a robot as a motion needs them, compiled where that is worth it, and what joints do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import lru_cache, partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from derive.arrays import Array, Flags
from derive.errors import Location, QuantityError
from derive.motion.curves.limits import highest
from derive.plans.segments import Load
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Program
from derive.publish.modules import KEPT, loaded
from derive.robot import tree
from derive.robot.robot import Robot
from derive.targets.target import Source
from derive.version import __version__

if TYPE_CHECKING:  # the inverse kinematics, which few motions need
    from derive.inverse.loops.linkage import Reached

COMPILING = 2.0  # what a compiler takes [s]
SAVED = 2e-8  # what compiled code saves an operation of a single call [s]


class Functions:
    """Functions of ``model_numpy.py`` or ``model_native.py`` with the numbers of a plan."""

    def __init__(
        self,
        robot: Robot,
        names: frozenset[str],
        values: Mapping[str, float],
        *,
        calls: float = 0,
        inverse: bool = False,
        reached: Reached | None = None,
    ) -> None:
        self.n = robot.dof
        bare, self._reached = bare_robot(robot), reached or reached_of(robot)
        names |= frozenset({"passive_positions"} if self._reached else ())
        program = program_of(bare, names, inverse=inverse)
        compiled = calls * max(sum(counts.values()) for counts in program.operations.values()) * SAVED > COMPILING
        self._module, self._folder = _imported(bare, names, inverse=inverse, compiled=compiled)
        self._parameters, self._inverse = program.parameters, program.inverse
        self._options, self._values = self._numbers(values), values

    def _numbers(self, values: Mapping[str, float]) -> dict[str, Any]:
        check_numbers(self._parameters, values, "the robot")
        numbers = {name: values[name] for name in self._parameters}
        return {"params": self._module.precompute(numbers)} if numbers else {}

    def given(self, values: Mapping[str, float]) -> Self:
        """The same functions with other numbers."""
        other = copy(self)
        other._options, other._values = self._numbers(values), values
        return other

    @property
    def standard_parameters(self) -> tuple[str, ...]:
        """Columns of the regressor."""
        return tuple(self._module.STANDARD_PARAMETERS)

    def __call__(self, name: str, *arguments: Array) -> Array:
        """The value of a function; not numbers where loops without formulas stay open."""
        if self._reached:
            passive, _ = self.passive(arguments[0])
            if name == "passive_positions":
                return passive
            arguments = (*arguments, passive)
        value: Array = getattr(self._module, name)(*arguments, **self._options)
        return value

    def passive(self, q: Array) -> tuple[Array, Array]:
        """Passive joints of loops without formulas, (..., passive), and by how much these are open, see `Reached`."""
        assert self._reached is not None
        found = self._reached(partial(self._module.passive_positions, **self._options), self._values, q)
        return found[..., :-1], found[..., -1]

    @property
    def branches(self) -> int:
        """How many branches the inverse kinematics has in closed form; zero where it has none."""
        return self._inverse.branches if self._inverse else 0

    def nearest(self, pose: Array, q: Array, branches: Sequence[int] = ()) -> Array:
        """The solution of a pose nearest to a configuration, (n,); not numbers where there is none."""
        module = self._module
        if not branches or self._inverse is None:
            return np.asarray(module.inverse_kinematics_nearest(pose, q, **self._options))
        there = {"given": q[list(self._inverse.given)]} if self._inverse.given else {}
        rows = module.inverse_kinematics(pose, near=q, **there, **self._options)
        return np.asarray(module._nearest(rows[list(branches)], q))


def check_numbers(names: Iterable[str], values: Mapping[str, float], of: str, place: Location | None = None) -> None:
    """Refuse a symbol without a number."""
    if missing := next((name for name in names if name not in values), ""):
        found, remedy = f"the symbol '{missing}' of {of} has no number", f"write values: {{{missing}: ...}} in the plan"
        raise QuantityError(found, remedy=remedy, location=place)


def bare_robot(robot: Robot) -> Robot:
    """A robot without what its functions do not depend on."""
    return replace(robot, title="", digest="", source="", remarks=())


def arm_of(robot: Robot, end: str) -> tuple[Robot, tuple[int, ...]]:
    """The serial arm that leads to an end, without links, and the indices of its joints; of a chain itself and all."""
    if robot.coupled:  # joints move with variables of other rows, too: all of it, and all variables
        own = replace(robot, ends=(replace(tree.end_named(robot, end), name=""),))
        return replace(own, links=(), gravity=None), tuple(range(robot.dof))
    arm, places = tree.arm(robot, end)
    return replace(arm, links=(), gravity=None), places


def reached_of(robot: Robot) -> Reached | None:
    """For configurations of loops without formulas; None where there are none."""
    if not robot.loops:
        return None
    from derive.inverse.loops.linkage import Reached, is_iterated  # the inverse kinematics, which few motions need

    return Reached(robot) if is_iterated(robot) else None


def joint_positions(
    robot: Robot, q: Array, values: Mapping[str, float], reached: Reached | None = None
) -> tuple[Array, Flags, Array]:
    """Of all joints, (rows, joints) [rad or m], by those of the variables, (rows, n), and where loops close.

    And by how much loops without formulas are open, (rows,), of others zero.
    """
    from derive.inverse.loops.linkage import constant_rows, linkage, positions

    if reached is None:
        found, closed = positions(robot, linkage(robot), list(q.T), values)
        return np.stack(found, axis=-1), closed, np.zeros(len(q))
    table = tree.bare(robot)
    passive, missing = Functions(table, frozenset(), values, reached=reached).passive(q)
    full = q @ np.array(constant_rows(table, values)).T
    full[:, [bool(joint.follows) for joint in robot.joints]] = passive
    return full, np.asarray(np.isfinite(passive).all(axis=-1)), missing


@lru_cache(KEPT)
def program_of(robot: Robot, names: frozenset[str], *, inverse: bool = False) -> Program:
    """Functions of a robot, found quickly and kept."""
    return build_program(robot, Effort.QUICK, names=names, inverse=inverse)


@lru_cache(KEPT)
def _imported(robot: Robot, names: frozenset[str], *, inverse: bool, compiled: bool) -> tuple[Any, Any]:
    """The module of a target, and the folder that holds it as long as it is kept."""
    return loaded(Source(robot, program_of(robot, names, inverse=inverse), __version__), compiled=compiled)


LEAST_INTERVALS = 64  # of a segment, for work and root mean square; a multiple of four, for Boole's rule


def mean_weights(count: int) -> Array:
    """Weights (count + 1,) of evenly spaced places for the mean of a function: Boole's rule, Simpson's for the rest."""
    # Polynomials of degree five are exact where four divides the number.
    weights, last = np.zeros(count + 1), count - count % 4
    for k in range(0, last, 4):
        weights[k : k + 5] += np.array([7, 32, 12, 32, 7]) * (2 / 45)
    weights[last : last + 3] += np.array([1, 4, 1]) / 3 if last < count else 0
    return np.asarray(weights / count)


def loads(
    start: float, end: float, samples: int, state: Callable[[Array], tuple[Array, Array]], corners: Iterable[float] = ()
) -> tuple[Load, ...]:
    """What each joint does in a segment, whose torques may jump at its ends and its corners [s]."""
    count, length = max(2 * samples, LEAST_INTERVALS), end - start
    places, parts = [], []
    for a, b in pairwise(sorted({start, *corners, end})):
        inner = count if b - a == length else 4 * max(2, int(np.ceil(count * (b - a) / length / 4)))
        # what comes before a jump, and what this segment carries and does, not the next one
        places.append(np.minimum(a + (b - a) * np.arange(inner + 1) / inner, np.nextafter(b, a)))
        parts.append(mean_weights(inner) * ((b - a) / length))
    times, weights = np.concatenate(places), np.concatenate(parts)

    def _both(at: Array) -> Array:
        torque, velocity = state(at)
        return np.concatenate([torque, torque * velocity], axis=-1)

    values = _both(times)
    tau, power = np.split(values, 2, axis=1)
    # work = integral of tau qd dt, rms^2 = mean of tau^2.
    work = weights @ power * (end - start)
    rms = np.sqrt(weights @ tau**2)
    when = highest(lambda at: np.abs(_both(at)), times, np.abs(values))
    own = np.arange(when.size)
    peaks, powers = np.split(_both(when)[own, own], 2)
    return tuple(Load(*map(float, row)) for row in zip(peaks, when[: peaks.size], rms, powers, work, strict=True))

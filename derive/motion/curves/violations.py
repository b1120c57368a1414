"""Where a motion exceeds what robot and plan allow."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from derive.arrays import Array
from derive.motion.curves.extremes import highest
from derive.plans.plan import Plan
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, names

ROUNDING = 1e-9  # what exceeds a limit by less, relative to it, does not exceed it
Bound = tuple[Array, Array]  # lowest and highest values, (n,) each
Function = Callable[[Array], Array]  # values at times, (...) to (..., n)
# A motion comes near a limit that is closer than this part of half the way between both limits, or of the only one.
NEAR = 0.35
# By `position`, `speed`, `acceleration`, `torque` the lowest and highest values, (n,) each, or infinite.
Bounds = Mapping[str, Bound]


@dataclass(frozen=True, slots=True)
class Violation:
    """A limit of the robot or the plan that a motion exceeds."""

    joint: int  # index of the joint
    what: str  # ``position``, ``speed``, ``acceleration`` or ``torque``
    time: float  # when it is exceeded most [s]
    value: float  # what it is then [rad or m, per s, per s^2, N m or N]
    limit: float  # what is allowed

    @property
    def excess(self) -> float:
        """By how much [of the same unit]."""
        return abs(self.value - self.limit)


def bounds_of(plan: Plan, values: Mapping[str, float]) -> Bounds:
    """What robot and plan allow."""
    joints = plan.robot.joints

    def _least(*rows: Sequence[Expression | None]) -> Array:
        of_joints = ([_known(most) for most in found if most is not None] for found in zip(*rows, strict=True))
        return np.array([min(found, default=np.inf) for found in of_joints])

    def _known(most: Expression, unknown: float = np.inf) -> float:
        return evaluate(most, values) if all(name in values for name in names(most)) else unknown

    most = {
        "speed": _least(plan.speed, [joint.speed for joint in joints]),
        "acceleration": _least(plan.acceleration),
        "torque": _least(plan.torque, [joint.torque for joint in joints]),
    }
    ends = [joint.limits for joint in joints]
    low = np.array([_known(end[0], -np.inf) if end else -np.inf for end in ends])
    high = np.array([_known(end[1]) if end else np.inf for end in ends])
    return {"position": (low, high), **{what: (-value, value) for what, value in most.items()}}


def exceeded(
    times: Array,
    values: Mapping[str, Array],
    bounds: Bounds,
    functions: Mapping[str, Function] | None = None,
) -> tuple[Violation, ...]:
    """Each limit that is exceeded at times (rows,) by values (rows, n), where it is exceeded most, joint by joint."""
    found = []
    for what, rows in values.items():
        low, high = bounds[what]
        when, most = _most(times, rows, bounds[what], functions[what] if functions else None)
        for j, value in enumerate(most):
            limit = float(high[j] if value > high[j] else low[j])
            if abs(value - limit) > ROUNDING * abs(limit) and not low[j] <= value <= high[j]:
                found.append(Violation(j, what, float(when[j]), float(value), limit))
    return tuple(sorted(found, key=lambda violation: violation.joint))


def _most(times: Array, rows: Array, bound: Bound, function: Function | None) -> tuple[Array, Array]:
    """When each joint is furthest beyond its bound, and its value then."""
    joints, excess = np.arange(rows.shape[1]), _excess(rows, bound)
    if function is None:
        at = excess.argmax(axis=0)
        return times[at], rows[at, joints]
    when = highest(lambda t: _excess(function(t), bound), times, excess)
    return when, function(when)[joints, joints]


def _excess(values: Array, bound: Bound) -> Array:
    low, high = bound
    return np.maximum(values - high, low - values)


def nearby(values: Mapping[str, Array], bounds: Bounds, kinds: Array) -> Bounds:
    """Limits worth a line in a plot: the rows, (rows, n), come near them, and they are not far outside the picture."""
    found = {}
    for what, rows in values.items():
        low, high = bounds[what]
        least, most = rows.min(axis=0), rows.max(axis=0)
        # Angles and slides have plots of their own: the height of a picture is that of one kind.
        picture = np.array([np.ptp(rows[:, kinds == kind]) for kind in kinds])
        both = np.isfinite(low) & np.isfinite(high)
        only = np.where(np.isfinite(high), np.abs(high), np.abs(low))
        half = np.where(both, (high - np.where(both, low, 0.0)) / 2, only)
        # Near: within a part of half the way between both limits, and not farther outside than the picture is high.
        room = np.minimum(NEAR * half, picture)
        found[what] = np.where(least <= low + room, low, -np.inf), np.where(most >= high - room, high, np.inf)
    return found

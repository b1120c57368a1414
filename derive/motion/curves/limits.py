"""Limits of a motion: how long it takes where they decide, by the slowest joint, and where it exceeds them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

import numpy as np
from sympy import Expr, Rational, sqrt

from derive.arrays import Array
from derive.motion.curves.extremes import highest
from derive.plans.hermite import ZERO, Piece
from derive.plans.plan import Plan
from derive.plans.profile import CRUISE
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, names

MOST_CRUISE = Rational(2)  # speed of a trapezoid without a part of constant speed, as a multiple of distance by time
# Times that are found by numbers are rounded up to one of these in a second, so that what follows stays exact.
MICROSECONDS = 10**6
Largest = tuple[Expr | None, ...]  # the largest value of something of each joint; None where nothing limits it


@dataclass(frozen=True, slots=True)
class Limits:
    """The largest magnitudes that a motion may have."""

    speed: Largest  # [rad/s or m/s]
    acceleration: Largest  # [rad/s^2 or m/s^2]
    torque: Largest  # [N m or N]

    def numbers(self) -> tuple[Array, Array, Array]:
        """All of them in floats, infinite where nothing limits, (n,) each."""
        bounds = (self.speed, self.acceleration, self.torque)
        a, b, c = (np.array([np.inf if most is None else float(most) for most in bound]) for bound in bounds)
        return a, b, c

    def stretch(self, speeds: Sequence[Expr], accelerations: Sequence[Expr]) -> Expr | None:
        """By how much a motion must be longer so that it keeps to speed and acceleration.

        In a time that is f times as long speeds are 1/f, accelerations 1/f^2 of what they were. The factor may be below
        one; it is zero where nothing moves, and None where nothing limits what moves.
        """
        longest: Expr | None = None
        for j, (speed, acceleration) in enumerate(zip(speeds, accelerations, strict=True)):
            fastest, hardest = self.speed[j], self.acceleration[j]
            # T >= v/v_max, T^2 >= a/a_max for a motion of one second.
            needed = [(speed / fastest).expand()] if speed != 0 and fastest is not None else []
            if acceleration != 0 and hardest is not None:
                needed.append(sqrt(acceleration / hardest))
            for factor in needed:
                if longest is None or float(factor) > float(longest) * (1 + 1e-12):
                    longest = factor
        return longest if longest is not None or any(speeds) else ZERO

    def cruise(self, joint: int, way: Expr) -> Expr:
        """The speed of a joint's trapezoid at full limits, as a multiple of distance by time.

        At speed V and acceleration A a way D takes T = D/V + V/A, so that V T/D = 1 + V^2/(A D); where that is above
        two the joint never gets to V, and T = 2 sqrt(D/A).
        """
        speed, acceleration = self.speed[joint], self.acceleration[joint]
        if acceleration is None:
            return CRUISE
        found = MOST_CRUISE if speed is None else 1 + speed**2 / (acceleration * way)
        return min(found, MOST_CRUISE, key=float)


def proportions(needed: Sequence[float]) -> tuple[Expr, ...]:
    """Times of segments that are passed without a stop, before they are stretched together."""
    longest = max(needed) or 1.0
    shares = (Fraction(max(value / longest, 0.01)).limit_denominator(100) for value in needed)
    return tuple(Rational(share.numerator, share.denominator) for share in shares)


def rounded_up(seconds: float) -> Rational:
    """The next microsecond."""
    return Rational(ceil(seconds * MICROSECONDS * (1 + 1e-12)), MICROSECONDS)


def placed(piece: Piece, start: Expr, factor: Expr) -> Piece:
    """A piece that is slower by a factor and later: time 0 becomes `start` [s]."""
    if isinstance(piece.duration, float):
        if factor == 1 and start == 0:
            return piece
        slower, later = [float(factor**i) for i in range(piece.k)], float(start)
        pairs = (zip(end, slower, strict=True) for end in piece.values)
        first, second = (tuple(v / s if isinstance(v, float) else v for v, s in end) for end in pairs)
        return Piece(later + piece.start * slower[1], piece.duration * slower[1], (first, second))
    first, second = (tuple(value / factor**i for i, value in enumerate(end)) for end in piece.values)
    return Piece(start + piece.start * factor, piece.duration * factor, (first, second))


# -- where a motion exceeds what robot and plan allow

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
    joints = plan.robot.variables

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
    times: Array, values: Mapping[str, Array], bounds: Bounds, functions: Mapping[str, Function] | None = None
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

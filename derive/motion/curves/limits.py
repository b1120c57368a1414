"""How long a motion takes where limits of the joints decide: the slowest joint sets the time."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

import numpy as np
from sympy import Expr, Rational, sqrt

from derive.arrays import Array
from derive.plans.hermite import Piece
from derive.plans.profile import CRUISE, ZERO

MOST_CRUISE = Rational(2)  # speed of a trapezoid without a part of constant speed, as a multiple of distance by time
# Times that are found by numbers are rounded up to one of these in a second, so that what follows stays exact.
MICROSECONDS = 10**6
Bound = tuple[Expr | None, ...]  # the largest value of something of each joint; None where nothing limits it


@dataclass(frozen=True, slots=True)
class Limits:
    """The largest magnitudes that a motion may have."""

    speed: Bound  # [rad/s or m/s]
    acceleration: Bound  # [rad/s^2 or m/s^2]
    torque: Bound  # [N m or N]

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


def trapezoid_peaks(cruise: Expr) -> tuple[Expr, Expr]:
    """Speed and acceleration of a trapezoid from 0 to 1 in one second."""
    return cruise, cruise**2 / (cruise - 1)


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
        first, second = (
            tuple(v / s if isinstance(v, float) else v for v, s in zip(end, slower, strict=True))
            for end in piece.values
        )
        return Piece(later + piece.start * slower[1], piece.duration * slower[1], (first, second))
    first, second = (tuple(value / factor**i for i, value in enumerate(end)) for end in piece.values)
    return Piece(start + piece.start * factor, piece.duration * factor, (first, second))

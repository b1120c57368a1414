"""How a joint goes from one point to the next: the profiles of books, as pieces of polynomials, exact.

Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008, chapters 2 to 4; Craig,
Introduction to Robotics, 3rd edition, 7.3; Siciliano et al., Robotics, 2009, 4.2.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from itertools import pairwise
from math import prod

import numpy as np
from sympy import Abs, Add, Expr, Matrix, Mul, Pow, Rational, atan, atan2, cos, pi, sign, sin, sqrt, tan, together

from derive.arrays import Array
from derive.plans.hermite import TIME, ZERO, Piece, Span, joined

KEPT = 4096  # how many parts of formulas a process keeps as functions


# The profiles; their names in a plan are these in small letters.
Profile = StrEnum("Profile", ("CUBIC", "QUINTIC", "SEPTIC", "TRAPEZOIDAL", "HARMONIC", "SPLINE", "FASTEST"))


VALUES = {Profile.CUBIC: 2, Profile.QUINTIC: 3, Profile.SEPTIC: 4}  # at each end of a polynomial from point to point
# Largest speed and acceleration from 0 to 1 in one second, from rest to rest.
UNIT_PEAKS: dict[Profile, tuple[Expr, Expr]] = {
    Profile.CUBIC: (Rational(3, 2), Rational(6)),
    Profile.QUINTIC: (Rational(15, 8), 10 / sqrt(3)),
    Profile.SEPTIC: (Rational(35, 16), 84 * sqrt(5) / 25),
    Profile.HARMONIC: (pi / 2, pi**2 / 2),
}
CRUISE = Rational(3, 2)  # speed of a trapezoid by distance and time: a third each to speed up, go on and slow down


@dataclass(frozen=True, slots=True)
class Cosine(Span):
    """A harmonic piece from rest to rest: ``q = q0 + (q1 - q0)(1 - cos(pi u))/2``."""

    values: tuple[tuple[Expr], tuple[Expr]]  # position at both ends


@dataclass(frozen=True, slots=True)
class Curve(Span):
    """A formula of the time since the motion began."""

    formulas: tuple[Expr, Expr, Expr]  # position, velocity and acceleration, in the symbol `derive.plans.hermite.TIME`

    def sampled(self, t: Array, order: int) -> Array:
        """A derivative at some times."""
        return np.broadcast_to(_on_array(self.formulas[order])(t), t.shape)


AnyPiece = Piece | Cosine | Curve

_FUNCTIONS: dict[type[Expr], Callable[..., Array]] = {
    Add: lambda *terms: sum(terms[1:], terms[0]),
    Mul: lambda *factors: prod(factors),
    Pow: np.power,
    sin: np.sin,
    cos: np.cos,
    tan: np.tan,
    sign: np.sign,
    Abs: np.abs,
    atan2: np.arctan2,
    atan: np.arctan,
}


@lru_cache(KEPT)
def _on_array(formula: Expr) -> Callable[[Array], Array]:
    """A formula at many times; nothing but what the grammar of cells and its derivatives know."""
    if formula == TIME:
        return lambda t: t
    if not formula.has(TIME):
        constant = np.array(float(formula))
        return lambda _: constant
    arguments = tuple(map(_on_array, formula.args))
    if isinstance(formula, Pow) and formula.exp.is_Integer:
        base, exponent = arguments[0], int(formula.exp)
        return lambda t: np.asarray(base(t) ** exponent)
    operation = _FUNCTIONS[formula.func]
    return lambda t: np.asarray(operation(*[argument(t) for argument in arguments]))


def rest_to_rest(profile: Profile, start: Expr, duration: Expr, q0: Expr, q1: Expr) -> tuple[AnyPiece, ...]:
    """From standing to standing in a duration [s]."""
    if profile is Profile.HARMONIC:
        return (Cosine(start, duration, ((q0,), (q1,))),)
    rest = (ZERO,) * (VALUES[profile] - 1)
    return (Piece(start, duration, ((q0, *rest), (q1, *rest))),)


def trapezoid(start: Expr, duration: Expr, q0: Expr, q1: Expr, speed: Expr) -> tuple[Piece, ...]:
    """Constant acceleration, constant speed V in (D/T, 2 D/T], constant deceleration, with D = |q1 - q0|."""
    if (way := q1 - q0) == 0:
        return (Piece(start, duration, ((q0, ZERO), (q1, ZERO))),)
    velocity = sign(way) * speed
    blend = together(duration - way / velocity)  # D = V (T - t_b): the area under the trapezoid of velocity
    gone = velocity * blend / 2
    points = [(ZERO, q0, ZERO), (blend, q0 + gone, velocity), (duration - blend, q1 - gone, velocity)]
    if together(duration - 2 * blend) == 0:
        points.pop()
    points.append((duration, q1, ZERO))
    return joined([(q, v) for _, q, v in points], [start + t for t, _, _ in points])


def via_velocities(times: Sequence[Expr], positions: Sequence[Expr]) -> tuple[Expr, ...]:
    """Velocities at points that are passed at times [s]: the mean of both slopes, zero where the path turns back."""
    slopes = [(positions[j + 1] - positions[j]) / (times[j + 1] - times[j]) for j in range(len(times) - 1)]
    inner = [(before + after) / 2 if float(before) * float(after) > 0 else ZERO for before, after in pairwise(slopes)]
    return (ZERO, *inner, ZERO)


def spline(times: Sequence[Expr], positions: Sequence[Expr]) -> tuple[Piece, ...]:
    """The cubic spline through points at rational times [s], with continuous acceleration, standing at both ends.

    Its velocities solve v[j-1]/h[j-1] + 2 v[j] (1/h[j-1] + 1/h[j]) + v[j+1]/h[j] = 3 (s[j-1]/h[j-1] + s[j]/h[j]) with
    the slopes s and lengths h of the intervals (Biagiotti and Melchiorri, 4.4.1).
    """
    count = len(times)
    lengths = [times[j + 1] - times[j] for j in range(count - 1)]
    slopes = [(positions[j + 1] - positions[j]) / lengths[j] for j in range(count - 1)]
    system, right = Matrix.eye(count), Matrix.zeros(count, 1)
    # Continuous acceleration at the inner points; the first and last row say v = 0.
    for j in range(1, count - 1):
        before, after = 1 / lengths[j - 1], 1 / lengths[j]
        system[j, j - 1], system[j, j], system[j, j + 1] = before, 2 * (before + after), after
        right[j] = 3 * (slopes[j - 1] * before + slopes[j] * after)
    velocities = system.LUsolve(right) if count > 2 else right
    return joined([(q, v.expand()) for q, v in zip(positions, velocities, strict=True)], times)

"""How a joint goes from one point to the next: the profiles of books, as pieces of polynomials, exact.

Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008, chapters 2 to 4; Craig,
Introduction to Robotics, 3rd edition, 7.3; Siciliano et al., Robotics, 2009, 4.2.

A polynomial is given by what holds at its two ends: position, velocity, acceleration, jerk. With k values at each end
it has degree 2k - 1: cubic for k = 2, quintic for 3, septic for 4. In u = t/T,

    h_i(u) = u**i/i! (1 - u)**k sum_{j < k - i} C(k - 1 + j, j) u**j

has the i-th derivative 1 at u = 0, and all others of order below k are 0 at both ends; ``(-1)**i h_i(1 - u)`` is the
same at u = 1 (Biagiotti and Melchiorri, 2.1). Nothing is rounded at the ends: pieces that share the values of a point
join without a gap in any of them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache, lru_cache
from itertools import pairwise
from math import comb, factorial, prod

import numpy as np
import sympy
from sympy import Expr, Float, Integer, Matrix, Poly, Rational, Symbol, expand, pi, sign, sqrt, together

from derive.arrays import Array

MOST_PRINTED = 8  # pieces of a joint in a segment that are printed
TIME = Symbol("t", real=True)
ZERO = Rational(0)


@cache
def basis(k: int) -> tuple[tuple[int, ...], ...]:
    """Coefficients of ``i! h_i``, then of ``i! (-1)**i h_i(1 - u)``, from the constant on; all are integers."""
    starts, ends = [], []
    for i in range(k):
        # i! h_i = u^i (1 - u)^k sum_j C(k - 1 + j, j) u^j, with (1 - u)^k by the binomial theorem.
        falling, rising = [comb(k, j) * (-1) ** j for j in range(k + 1)], [comb(k - 1 + j, j) for j in range(k - i)]
        start: list[int] = [0] * i + np.convolve(falling, rising).tolist()
        # (-1)^i h_i(1 - u): (1 - u)^p = sum_m C(p, m) (-u)^m.
        end = ((-1) ** (i + m) * sum(comb(p, m) * c for p, c in enumerate(start)) for m in range(2 * k))
        starts.append(tuple(start))
        ends.append(tuple(end))
    return (*starts, *ends)


@cache
def _derived(k: int, order: int) -> Array:
    """A derivative of `basis` by u, (2k, 2k), the highest power first."""
    rows = np.polynomial.polynomial.polyder(np.array(basis(k), dtype=float), order, axis=1)
    return np.pad(rows, ((0, 0), (0, order)))[:, ::-1]


@dataclass(frozen=True, slots=True)
class Span:
    """An interval of time."""

    start: Expr  # time of its first end [s]
    duration: Expr  # its length [s], positive

    @property
    def end(self) -> Expr:
        """Time of its second end [s]."""
        return self.start + self.duration


@dataclass(frozen=True, slots=True)
class Piece(Span):
    """A polynomial of one joint on an interval of time."""

    # Floats of many pieces, none of which is printed, are Python's: SymPy's take a hundred times as long.
    values: tuple[tuple[Expr, ...], tuple[Expr, ...]]  # position, velocity, ... at the first end, then at the second

    @property
    def k(self) -> int:
        """How many values stand at each end."""
        return len(self.values[0])

    @property
    def is_exact(self) -> bool:
        """Whether no float is in it."""
        numbers = (self.start, self.duration, *self.values[0], *self.values[1])
        return not any(isinstance(value, float) or value.has(Float) for value in numbers)

    def in_unit_time(self) -> Poly:
        """The polynomial in u = (t - start)/duration, exact."""
        u = Symbol("u", real=True)
        total = Integer(0)
        weighted = [(i, value) for end in self.values for i, value in enumerate(end)]
        for row, (i, value) in zip(basis(self.k), weighted, strict=True):
            scale = value * self.duration**i / factorial(i)
            total += sum((Rational(c) * scale * u**power for power, c in enumerate(row)), Integer(0))
        return Poly(expand(total), u, domain="EX")


def symbolic(value: Expr) -> Expr:
    """A float of Python's as one of SymPy's, zero as a whole number; anything else as it is."""
    return (Float(value) if value else Integer(0)) if isinstance(value, float) else value


def power_coefficients(numbers: Array, k: int, duration: float) -> Array:
    """Coefficients of a piece by powers of unit time."""
    weights = numbers * np.array([duration**i / factorial(i) for i in range(k)] * 2)
    # h_0(u) + h_0(1 - u) = 1: the difference of both positions, and the first one added at last, round less.
    weights[0], weights[k] = 0.0, numbers[k] - numbers[0]
    coefficients: Array = weights @ _derived(k, 0)
    coefficients[-1] += numbers[0]
    return coefficients


def sampled(piece_numbers: Array, k: int, u: Array, duration: Array, order: int) -> Array:
    """A derivative of pieces at points u of unit time, (points,); their values at both ends are (points, 2k)."""
    powers = np.zeros((2 * k, u.size))
    for column in _derived(k, order).T:
        powers = powers * u + column[:, None]
    total = np.zeros(u.size)
    if order:  # two positions that are alike leave nothing but rounding in a sum
        piece_numbers = piece_numbers.copy()
        piece_numbers[:, k] -= piece_numbers[:, 0]
        piece_numbers[:, 0] = 0.0
    scale = [duration ** float(i - order) for i in range(k)]
    for b in range(2 * k):
        i = b % k
        total += powers[b] / factorial(i) * scale[i] * piece_numbers[:, b]
    return total


def joined(ends: Sequence[tuple[Expr, ...]], times: Sequence[Expr]) -> tuple[Piece, ...]:
    """Pieces through points at which everything is known."""
    return tuple(Piece(times[j], times[j + 1] - times[j], (ends[j], ends[j + 1])) for j in range(len(times) - 1))


# -- profiles

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

    formulas: tuple[Expr, Expr, Expr]  # position, velocity and acceleration, in the symbol `TIME`

    def sampled(self, t: Array, order: int) -> Array:
        """A derivative at some times."""
        return np.broadcast_to(_on_array(self.formulas[order])(t), t.shape)


AnyPiece = Piece | Cosine | Curve

_FUNCTIONS: dict[type[Expr], Callable[..., Array]] = {
    sympy.Add: lambda *terms: sum(terms[1:], terms[0]),
    sympy.Mul: lambda *factors: prod(factors),
    sympy.Pow: np.power,
    sympy.sin: np.sin,
    sympy.cos: np.cos,
    sympy.tan: np.tan,
    sympy.sign: np.sign,
    sympy.Abs: np.abs,
    sympy.atan2: np.arctan2,
    sympy.atan: np.arctan,
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
    if isinstance(formula, sympy.Pow) and formula.exp.is_Integer:
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

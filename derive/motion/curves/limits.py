"""Largest speeds and accelerations of a motion, and its limits: how long it takes where they decide, what exceeds them.

Extremes are exact where their places are square roots at most.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import ceil

import numpy as np
from sympy import QQ, Expr, Float, Integer, Poly, Rational, Symbol, cancel, expand, pi, radsimp, roots, sqrt

from derive.arrays import Array
from derive.plans.plan import Plan
from derive.plans.profile import CRUISE, ZERO, AnyPiece, Cosine, Curve, Piece, power_coefficients
from derive.plans.segments import Peak
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, names

_U = Symbol("u", real=True)

_KEPT = 256  # peaks that are kept: joints of one motion often move alike, and a table asks for the same ones again
_SAMPLES = 2001  # times at which formulas are looked at
_WITHIN = 17  # times within a bracket at which functions are looked at, again and again in an eighth of it
_ROUNDS = 5  # how often
MORE = 1e-12  # what is larger between two times by less, relative to it, is not told from what it is at them
_PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)  # at which a polynomial is looked at before its extremes are computed
_SAME = 1e-9  # values that differ by less, relative to themselves, are one; the earliest counts
_NEAR = 0.8  # of the largest value: what a polynomial has to reach at these places for its extremes to be computed


def peak(pieces: tuple[AnyPiece, ...], order: int) -> Peak:
    """Where a derivative of a joint is largest in magnitude."""
    if any(isinstance(piece, Piece) and not piece.is_exact for piece in pieces):
        return numeric_peak(pieces, order)
    return _exact_peak(pieces, order)


@lru_cache(_KEPT)
def _exact_peak(pieces: tuple[AnyPiece, ...], order: int) -> Peak:
    found, *others = (candidate for piece in pieces for candidate in _candidates(piece, order))
    for candidate in others:
        if abs(float(candidate.value)) > abs(float(found.value)) * (1 + 1e-12):
            found = candidate
    value, time = (radsimp(cancel(each)) if found.is_exact else each for each in (found.value, found.time))
    return Peak(value, time, found.is_exact)


def numeric_peak(pieces: tuple[AnyPiece, ...], order: int) -> Peak:
    """Where a derivative of a joint that moves by polynomials is largest in magnitude, in floats."""
    polynomials = [piece for piece in pieces if isinstance(piece, Piece)]
    lengths = np.array([float(piece.duration) for piece in polynomials])
    value, place = np.zeros((2, len(polynomials)))
    # Coefficients of a derivative by powers of unit time, of all pieces of one degree at once, and their places.
    degrees, tables = np.array([piece.k for piece in polynomials]), []
    for k in sorted(set(degrees.tolist())):
        alike = np.flatnonzero(degrees == k)
        ends = [np.array([float(value) for end in polynomials[i].values for value in end]) for i in alike]
        rows = np.array([power_coefficients(row, k, lengths[i]) for row, i in zip(ends, alike, strict=True)])
        for _ in range(order):
            rows = rows[:, :-1] * np.arange(rows.shape[1] - 1, 0, -1)
        tables.append((alike, rows / np.array([lengths[i] ** order for i in alike])[:, None]))
    for alike, rows in tables:
        found = np.polyval(rows.T[:, :, None], np.array(_PLACES))
        at = np.abs(found).argmax(axis=1)
        value[alike], place[alike] = found[np.arange(len(rows)), at], np.array(_PLACES)[at]
    near = np.abs(value) > _NEAR * np.abs(value).max()
    for alike, rows in tables:
        alike, rows = alike[near[alike]], rows[near[alike]]
        places = _inner_zeros(rows[:, :-1] * np.arange(rows.shape[1] - 1, 0, -1))
        for u, there in zip(places.T, np.polyval(rows.T[:, :, None], places).T, strict=True):
            more = np.abs(there) > np.abs(value[alike]) * (1 + _SAME)
            value[alike[more]], place[alike[more]] = there[more], u[more]
    most = int(np.argmax(np.abs(value) >= np.abs(value).max() * (1 - _SAME)))
    return Peak(Float(value[most]), Float(float(polynomials[most].start) + place[most] * lengths[most]), False)


def refined(function: Callable[[Array], Array], low: Array, high: Array) -> tuple[Array, Array]:
    """When functions of time (k, places) are largest, each between two times, and how large they are, (k,) each."""
    rows = np.arange(low.size)
    # How large is right to rounding where the function is smooth.
    for _ in range(_ROUNDS):
        times = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, _WITHIN)
        values = function(times)
        at = values.argmax(axis=1)
        low, high = times[rows, np.maximum(at - 1, 0)], times[rows, np.minimum(at + 1, _WITHIN - 1)]
    return times[rows, at], values[rows, at]


def highest(function: Callable[[Array], Array], times: Array, values: Array) -> Array:
    """When each function of time is largest, (n,), also between ascending times (k,) at which they are (k, n)."""
    at, joints = values.argmax(axis=0), np.arange(values.shape[1])
    low, high = times[np.maximum(at - 1, 0)], times[np.minimum(at + 1, times.size - 1)]
    when, found = refined(lambda places: function(places)[joints, :, joints], low, high)
    known = values[at, joints]
    return np.where(found > known * (1 + MORE * np.sign(known)), when, times[at])


def _candidates(piece: AnyPiece, order: int) -> Iterator[Peak]:
    """Ends and stationary points of a derivative on a piece."""
    if isinstance(piece, Cosine):
        # q' and q'' of (1 - cos(pi u))/2 are largest in the middle, and at the start.
        value = (piece.values[1][0] - piece.values[0][0]) / 2 * (pi / piece.duration) ** order
        yield Peak(value, piece.start + (piece.duration / 2 if order == 1 else 0), True)
        return
    if isinstance(piece, Curve):
        times = np.linspace(float(piece.start), float(piece.end), _SAMPLES)
        at = int(np.abs(piece.sampled(times, order)).argmax())
        low, high = times[[max(at - 1, 0)]], times[[min(at + 1, _SAMPLES - 1)]]
        (when,), _ = refined(lambda places: np.abs(piece.sampled(places, order)), low, high)
        yield Peak(Float(float(piece.sampled(np.array([when]), order)[0])), Float(when), False)
        return
    if piece.values[0] == piece.values[1] and not any(piece.values[0][1:]):  # it stands
        yield Peak(Integer(0), piece.start, True)
        return
    derivative = piece.in_unit_time()
    for _ in range(order):
        derivative = derivative.diff(_U)
    # Without its leading coefficient, which may have roots, the rest is often rational and has exact factors.
    coefficients = derivative.all_coeffs()
    leading = next((c for c in coefficients if c != 0), Integer(1))
    ratios = [ratio if ratio.is_Rational else cancel(ratio) for ratio in (c / leading for c in coefficients)]
    monic = Poly(ratios, _U, domain=QQ if all(ratio.is_Rational for ratio in ratios) else "EX")
    scale = leading / piece.duration**order
    for place, value, exact in [_at(monic, Integer(0)), _at(monic, Integer(1)), *_stationary(monic)]:
        time = piece.start + place * piece.duration
        if exact:
            yield Peak(value * scale, time, True)
        else:
            yield Peak(Float(float(value) * float(scale)), Float(float(time)), False)


_Place = tuple[Expr, Expr, bool]  # a place, the value of a polynomial there, and whether both are exact


def _at(polynomial: Poly, place: Expr, factor: Poly | None = None) -> _Place:
    """The value at a place; at a root of a factor that of the remainder, which is short."""
    value = expand(polynomial.rem(factor).as_expr().subs(_U, place)) if factor else polynomial(place)
    return place, value, True


def _stationary(polynomial: Poly) -> Iterator[_Place]:
    """Where a polynomial is largest or smallest between 0 and 1."""
    if (derivative := polynomial.diff(_U)).degree() < 1:
        return
    rational = polynomial.domain == QQ
    for factor, _ in derivative.factor_list()[1] if rational else [(derivative, 1)]:
        # Square roots at most: exact. Of higher degree in floats, as eigenvalues of the companion matrix.
        if factor.degree() <= 2:
            places = [place for place in roots(factor, _U) if place.is_real and 0 < float(place) < 1]
            yield from (_at(polynomial, place, factor if rational else None) for place in places)
        else:
            numbers = [float(c) for c in polynomial.all_coeffs()]
            for place in _real_zeros([float(c) for c in factor.all_coeffs()]):
                yield Float(place), Float(float(np.polyval(numbers, place))), False


def _inner_zeros(rows: Array) -> Array:
    """Zeros between 0 and 1 of polynomials, (k, degree + 1) to (k, degree), ascending; no number where is none."""
    # The eigenvalues of companion matrices, as `numpy.roots` has them, of all polynomials at once.
    found = np.full((len(rows), max(rows.shape[1] - 1, 0)), np.nan)
    whole = (rows[:, [0, -1]] != 0).all(axis=1)
    if found.shape[1] and whole.any():
        companions = np.tile(np.eye(found.shape[1], k=-1), (int(whole.sum()), 1, 1))
        companions[:, 0] = -rows[whole, 1:] / rows[whole, :1]
        zeros = np.linalg.eigvals(companions)
        inside = (np.abs(zeros.imag) < 1e-9) & (zeros.real > 0) & (zeros.real < 1)
        found[whole] = np.sort(np.where(inside, zeros.real, np.nan), axis=1)
    for i in np.flatnonzero(~whole):
        few = _real_zeros(list(rows[i]))
        found[i, : len(few)] = few
    return found


def _real_zeros(coefficients: list[float]) -> list[float]:
    return sorted(float(zero.real) for zero in np.roots(coefficients) if abs(zero.imag) < 1e-9 and 0 < zero.real < 1)


# -- limits of a motion, and by how much they make it longer

MOST_CRUISE = Rational(2)  # speed of a trapezoid without a part of constant speed, as a multiple of distance by time
MICROSECONDS = 10**6  # times that are found by numbers are rounded up to one of these, so that what follows is exact
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
        """By how much a motion must be longer to keep to the limits: zero where it stands, None without limits."""
        longest: Expr | None = None
        for j, (speed, acceleration) in enumerate(zip(speeds, accelerations, strict=True)):
            fastest, hardest = self.speed[j], self.acceleration[j]
            # In a time f times as long speeds are 1/f, accelerations 1/f^2: f >= v/v_max, f^2 >= a/a_max.
            needed = [(speed / fastest).expand()] if speed != 0 and fastest is not None else []
            needed += [sqrt(acceleration / hardest)] if acceleration != 0 and hardest is not None else []
            for factor in needed:
                if longest is None or float(factor) > float(longest) * (1 + 1e-12):
                    longest = factor
        return longest if longest is not None or any(speeds) else ZERO

    def cruise(self, joint: int, way: Expr) -> Expr:
        """The speed of a joint's trapezoid at full limits, as a multiple of distance by time."""
        # At speed V and acceleration A a way D takes T = D/V + V/A, so that V T/D = 1 + V^2/(A D); where that is above
        # two the joint never gets to V, and T = 2 sqrt(D/A).
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
NEAR = 0.35  # of half the way between both limits, or of the only one: a motion that is closer comes near a limit
Bounds = Mapping[str, Bound]  # by `position`, `speed`, `acceleration`, `torque`; infinite where nothing limits


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
        room = np.minimum(NEAR * half, picture)
        found[what] = np.where(least <= low + room, low, -np.inf), np.where(most >= high - room, high, np.inf)
    return found

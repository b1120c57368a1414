"""Largest speeds and accelerations of a motion, exact where the places of the extremes are square roots at most."""

from collections.abc import Callable, Iterator
from functools import lru_cache

import numpy as np
from sympy import QQ, Expr, Float, Integer, Poly, Symbol, cancel, expand, pi, radsimp, roots

from derive.arrays import Array
from derive.plans.hermite import Piece, power_coefficients
from derive.plans.profile import AnyPiece, Cosine, Curve
from derive.plans.segments import Peak

_U = Symbol("u", real=True)

_KEPT = 256  # peaks that are kept: joints of one motion often move alike, and a table asks for the same ones again
_SAMPLES = 2001  # times at which formulas are looked at
_WITHIN = 17  # times within a bracket at which functions are looked at, again and again in an eighth of it
_ROUNDS = 5  # how often
MORE = 1e-12  # what is larger between two times by less, relative to it, is not told from what it is at them
# Places of a polynomial of floats at which it is looked at before its extremes are computed.
_PLACES = (0.0, 0.25, 0.5, 0.75, 1.0)
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
    # Each function is looked at between the neighbours of its largest known value.
    when, found = refined(lambda places: function(places)[joints, :, joints], low, high)
    known = values[at, joints]
    return np.where(found > known * (1 + MORE * np.sign(known)), when, times[at])


def _candidates(piece: AnyPiece, order: int) -> Iterator[Peak]:
    """Ends and stationary points of a derivative on a piece."""
    if isinstance(piece, Cosine):
        way = (piece.values[1][0] - piece.values[0][0]) / 2
        # q' and q'' of (1 - cos(pi u))/2 are largest in the middle, and at the start.
        value = way * (pi / piece.duration) ** order
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
    derivative = polynomial.diff(_U)
    if derivative.degree() < 1:
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

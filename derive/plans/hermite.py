"""Polynomials by what holds at their two ends: position, velocity, acceleration, jerk.

With k values at each end the polynomial has degree 2k - 1: cubic for k = 2, quintic for 3, septic for 4. In u = t/T,

    h_i(u) = u**i/i! (1 - u)**k sum_{j < k - i} C(k - 1 + j, j) u**j

has the i-th derivative 1 at u = 0, and all others of order below k are 0 at both ends; ``(-1)**i h_i(1 - u)`` is the
same at u = 1 (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008, 2.1). Nothing is
rounded at the ends: pieces that share the values of a point join without a gap in any of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import comb, factorial

import numpy as np
from sympy import Expr, Float, Integer, Poly, Rational, Symbol, expand

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

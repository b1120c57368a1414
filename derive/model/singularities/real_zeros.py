"""Whether polynomials of one arm have zeros for real joint variables: by their parity, their signs, or intervals.

The angles of the generators, some of them sums of joint angles, take all values independently of each other.
"""

import math
from collections.abc import Sequence
from contextlib import suppress

import numpy as np
import numpy.typing as npt

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.errors import ExpressionError
from derive.robot.evaluate import to_float

Array = npt.NDArray[np.float64]

# The number of each term, and its exponents of the generators without a number.
_Terms = Sequence[tuple[float, dict[int, int]]]
_MOVING = (Kind.SINE, Kind.COSINE, Kind.VARIABLE)
_ZERO = 1e-12  # sums below this part of their terms are zero in the numbers of a file
_SAMPLES = 2000
_CELLS = 16  # along each angle, at first; those in which a zero is not excluded are halved
_MOST_CELLS = 60_000
_MOST_ANGLES = 2


class RealZeros:
    """Judges the polynomials of one domain, with the numbers that the file has."""

    def __init__(self, domain: PolynomialDomain) -> None:
        self.domain, numbers = domain, {name: to_float(e, {}) for name, e in dict(domain.robot.parameters).items()}
        self._values: list[float | None] = [None] * len(domain.generators)
        for i, g in enumerate(domain.generators):
            with suppress(ExpressionError):  # a symbol without a number
                self._values[i] = None if g.kind in _MOVING else to_float(g.expression, numbers)
        places = domain.places
        self._angles = [(i, places[Kind.COSINE, joint]) for (kind, joint), i in places.items() if kind is Kind.SINE]
        self._slides = [i for i, g in enumerate(domain.generators) if g.kind is Kind.VARIABLE]

    def moving(self, p: Polynomial) -> tuple[int, ...]:
        """The joints (from 0) whose variables change a polynomial."""
        return tuple(i for i in range(self.domain.robot.n) if self.domain.derivative(p, i))

    def is_number(self, p: Polynomial) -> bool:
        """Whether a polynomial that does not move has a number."""
        return all(self._values[i] is not None for i, degree in enumerate(p.degrees()) if degree)

    def vanishes(self, p: Polynomial) -> bool:
        """Whether a polynomial is zero everywhere in the numbers of the file, whatever has none."""
        sums: dict[tuple[tuple[int, int], ...], list[float]] = {}
        for number, powers in self._terms(p):
            sums.setdefault(tuple(powers.items()), []).append(number)
        return all(abs(sum(numbers)) <= _ZERO * sum(map(abs, numbers)) for numbers in sums.values())

    def _terms(self, p: Polynomial) -> _Terms:
        known = [math.nan if value is None else value for value in self._values]
        free = [value is None for value in self._values]
        found = []
        for powers, coefficient in p.terms():
            size = math.prod(known[i] ** e for i, e in enumerate(powers) if e and not free[i])
            found.append((float(coefficient) * size, {i: e for i, e in enumerate(powers) if e and free[i]}))
        return found

    def rank(self, rows: Sequence[Sequence[Polynomial]]) -> int:
        """The rank of a matrix at a random place, with random numbers of symbols that have none."""
        rng = np.random.default_rng(0)
        places = {i: rng.uniform(0.5, 1.5, 1) for i, value in enumerate(self._values) if value is None}
        places |= _circles(self._angles, rng.uniform(0, 6, (1, len(self._angles))))
        matrix = [[_evaluated(self._terms(p), places)[0][0] for p in row] for row in rows]
        return int(np.linalg.matrix_rank(matrix, rtol=1e-12)) if matrix else 0

    def exist(self, polynomials: Sequence[Polynomial]) -> bool | None:
        """Whether polynomials that move are zero together in some configuration; None where that is not known."""
        read = [self._terms(p) for p in polynomials]
        if len(read) == 1 and (known := self._by_signs(read[0])) is not None:
            return known
        used = {i for terms in read for _, moving in terms for i in moving}
        angles = [pair for pair in self._angles if used & set(pair)]
        slides = used & set(self._slides)
        if used - slides.union(*angles):  # symbols without a number
            return None
        if len(read) == 1:
            rng = np.random.default_rng(0)
            places = {i: np.sinh(rng.uniform(-3, 3, _SAMPLES)) for i in slides}
            places |= _circles(angles, rng.uniform(0, 2 * math.pi, (_SAMPLES, len(angles))))
            values, size = _evaluated(read[0], places)
            # Both signs occur, and the polynomial is continuous.
            if values.min() < -_ZERO * size and values.max() > _ZERO * size:
                return True
        return False if not slides and len(angles) <= _MOST_ANGLES and _excluded(read, angles) else None

    def _by_signs(self, terms: _Terms) -> bool | None:
        """Yes where half a turn or the opposite displacement changes the sign, no for squares and a constant."""
        # Odd under q_i -> q_i + pi (or d -> -d): by the intermediate value theorem there is a zero.
        suffixes = [{i for pair in self._angles[first:] for i in pair} for first in range(len(self._angles))]
        for places in (*suffixes, *self._angles, *((i,) for i in self._slides)):
            if all(sum(powers.get(i, 0) for i in places) % 2 for _, powers in terms):
                return True
        # Squares and a constant of one sign: nowhere zero.
        is_even = not any(k % 2 for _, powers in terms for k in powers.values())
        still = [number for number, powers in terms if not powers]
        is_one_sign = any(still) and len({number > 0 for number, _ in terms if number}) == 1
        return False if is_even and is_one_sign else None


def _circles(angles: Sequence[tuple[int, int]], values: Array) -> dict[int, Array]:
    """The sines and cosines of angles, (places, angles) each."""
    return {i: f(values[:, k]) for k, pair in enumerate(angles) for i, f in zip(pair, (np.sin, np.cos), strict=True)}


def _evaluated(terms: _Terms, places: dict[int, Array]) -> tuple[Array, float]:
    """A sum of terms at places, and the size of its coefficients."""
    total = np.zeros(len(next(iter(places.values()))))
    for number, moving in terms:
        total += math.prod((places[i] ** e for i, e in moving.items()), start=np.asarray(number))
    return total, sum(abs(number) for number, _ in terms)


def _excluded(polynomials: Sequence[_Terms], angles: Sequence[tuple[int, int]]) -> bool:
    """Whether no cell of a grid of angles can hold a common zero, by the largest slopes of the polynomials."""
    # |dp/dq| is at most the sum of |coefficient| * degree: a cell with |p| above slope * half width has no zero.
    slopes = [sum(abs(number) * sum(moving.values()) for number, moving in terms) for terms in polynomials]
    half = math.pi / _CELLS
    line = half * (2 * np.arange(_CELLS) + 1)
    centres = np.stack(np.meshgrid(*[line] * len(angles)), axis=-1).reshape(-1, len(angles))
    corners = np.stack(np.meshgrid(*[[-0.5, 0.5]] * len(angles)), axis=-1).reshape(-1, len(angles))
    while len(centres) <= _MOST_CELLS and half > 1e-6:
        places = _circles(angles, centres)
        near = [np.abs(_evaluated(p, places)[0]) <= slope * half for p, slope in zip(polynomials, slopes, strict=True)]
        centres = centres[np.all(near, axis=0)]
        if not len(centres):
            return True
        # Cells that may hold one are halved along every angle.
        half /= 2
        centres = (centres[:, None] + 2 * half * corners).reshape(-1, len(angles))
    return False

"""Where the rank of a matrix of polynomials falls: the common zeros of its largest minors.

1. An entry p that does not move takes its row and its column out of the matrix, and the rank with them: what is left is
   p times the Schur complement, whose entries are short in the middle of an arm.
2. The rank is that of the largest minors that are not zero everywhere; it falls where all of these are zero.
3. Every minor is a product of factors, so their common zeros are the union over all choices of one factor of each. A
   factor whose zeros are angles or displacements is put into the other minors, which then have shorter factors.

Nothing is lost on the way but where factors of several joints are left that share a joint: then the families that were
found are not said to be all, unless intervals prove that such factors have no common zero.

Whether polynomials have zeros for real joint variables is told by their parity, their signs, or intervals. The angles
of the generators, some of them sums of joint angles, take all values independently of each other.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np
import numpy.typing as npt

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factor, Factoring
from derive.algebra.generators import MOVING, Kind
from derive.algebra.ring import Polynomial, TooManyTerms, determinant
from derive.errors import ExpressionError
from derive.robot.evaluate import to_float

Array = npt.NDArray[np.float64]

# The number of each term, and its exponents of the generators without a number.
_Terms = Sequence[tuple[float, dict[int, int]]]
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
                self._values[i] = None if g.kind in MOVING else to_float(g.expression, numbers)
        places = domain.places
        self._angles = [(i, places[Kind.COSINE, joint]) for (kind, joint), i in places.items() if kind is Kind.SINE]
        self._slides = [i for i, g in enumerate(domain.generators) if g.kind is Kind.VARIABLE]

    def moving(self, p: Polynomial) -> tuple[int, ...]:
        """The joints (from 0) whose variables change a polynomial."""
        return tuple(i for i in range(self.domain.robot.n) if self.domain.derivative(p, i))

    def moves(self, p: Polynomial) -> bool:
        """Whether any joint's variable changes a polynomial."""
        return any(self.domain.derivative(p, i) for i in range(self.domain.robot.n))

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


# -- common zeros of minors

Rows = Sequence[Sequence[Polynomial]]
FactorChoice = Mapping[str, Factor]  # the factors of a minor by their keys: it is zero where one of them is
MAX_MINORS = 200
MAX_STEPS = 400  # choices of factors that are followed


@dataclass(frozen=True)
class Zero:
    """A factor that is zero."""

    factor: Factor
    value: int | None = None  # which of its solutions is meant, see `CommonZeros.images`; None for all

    @property
    def key(self) -> tuple[str, int | None]:
        """The same for the same zeros."""
        return _key(self.factor), self.value


Family = tuple[Zero, ...]  # factors that are zero together


@dataclass(frozen=True)
class RankLoss:
    """Where a matrix has less than its usual rank."""

    rank: int  # the usual rank
    families: tuple[Family, ...]  # the rank is less where all factors of one of these are zero
    complete: bool  # whether it is less nowhere else
    unless: tuple[Polynomial, ...]  # polynomials without a number that do not move and are taken not to be zero


def rank_loss(domain: PolynomialDomain, matrices: Iterable[Rows]) -> RankLoss:
    """Where the rank of a matrix falls."""
    solver = CommonZeros(domain)
    found = []
    for rows in matrices:
        with suppress(TooManyTerms):
            found.append(solver.reduced(rows))
    if not found:
        raise TooManyTerms(domain.ring.max_terms)
    rank, rows, pivots = min(found, key=lambda reduced: sum(len(entry) for row in reduced[1] for entry in row))
    for pivot in pivots:
        solver.moving_factors(pivot)
    try:
        size, minors = solver.minors(rows)
        families = solver.largest(solver.families(minors)) if minors else []
    except TooManyTerms:
        return RankLoss(rank + solver.zeros.rank(rows), (), complete=False, unless=())
    return RankLoss(rank + size, tuple(families), solver.complete, tuple(solver.unless.values()))


def _key(factor: Factor) -> str:
    return factor.value.normalised()[1]


class CommonZeros:
    """Solves systems of products: `complete` if all common zeros were given out; `unless` is taken not to vanish."""

    def __init__(self, domain: PolynomialDomain) -> None:
        self._domain, self._factoring, self.zeros = domain, Factoring(domain), RealZeros(domain)
        self.complete, self.unless, self._steps = True, dict[str, Polynomial](), 0

    def reduced(self, rows: Rows) -> tuple[int, Rows, list[Polynomial]]:
        """The rank that entries which do not move take out of a matrix, the rest of it, and these entries."""
        left, pivots = [list(row) for row in rows if any(row)], list[Polynomial]()
        while True:
            entries = [(i, j, p) for i, row in enumerate(left) for j, p in enumerate(row)]
            still = [(i, j) for i, j, p in entries if not self.zeros.moves(p) and not self.zeros.vanishes(p)]
            if not still:
                return len(pivots), left, pivots
            costs = []
            for i, j in still:  # numbers first, then those that are short and change fewest other entries
                fill = sum(map(bool, left[i])) * sum(bool(row[j]) for row in left)
                costs.append((not left[i][j].is_constant, len(left[i][j]), fill, i, j))
            *_, i, j = min(costs)
            own = left.pop(i)
            p = own.pop(j)
            pivots.append(p)
            # Schur complement of the pivot p, times p where it is no number: p x - (row's first) y.
            by, weight = (1 / p.constant_term, 1) if p.is_constant else (1, p)
            pairs = ((row.pop(j) * by, row) for row in left)
            left = [[x * weight - first * y for x, y in zip(row, own, strict=True)] for first, row in pairs]
            left = [row for row in left if any(row)]

    def minors(self, rows: Rows) -> tuple[int, list[Polynomial]]:
        """The largest minors that are not zero everywhere, and their size."""
        width = len(rows[0]) if rows else 0
        for size in range(self.zeros.rank(rows), 0, -1):
            if comb(len(rows), size) * comb(width, size) > MAX_MINORS:
                raise TooManyTerms(MAX_MINORS)
            pairs = ((r, c) for r in combinations(rows, size) for c in combinations(range(width), size))
            found = (determinant([[row[k] for k in columns] for row in chosen]) for chosen, columns in pairs)
            if minors := [p for p in found if self.moving_factors(p) is not None]:
                return size, minors
        return 0, []

    def moving_factors(self, p: Polynomial) -> FactorChoice | None:
        """The factors of a polynomial that can be zero; None where it is zero everywhere."""
        if self.zeros.vanishes(p):
            return None
        found = {}
        for factor in self._factoring.factors(p):
            key = _key(factor)
            if self.zeros.moves(factor.value):
                if self.zeros.exist((factor.value,)) is not False:
                    found[key] = factor
            elif not self.zeros.is_number(factor.value):
                self.unless[key] = factor.value
        return found

    def families(self, polynomials: Iterable[Polynomial]) -> list[Family]:
        """The common zeros of polynomials."""
        read = [self.moving_factors(p) for p in polynomials]
        return self._solved([equation for equation in read if equation is not None])

    def _solved(self, equations: Sequence[FactorChoice]) -> list[Family]:
        self._steps += 1
        if self._steps > MAX_STEPS:
            self.complete = False
            return []
        needed: list[FactorChoice] = []
        for equation in sorted(equations, key=len):  # one with all factors of another follows from it
            if not any(set(other) <= set(equation) for other in needed):
                needed.append(equation)
        if not needed or not needed[0]:
            return [()] if not needed else []
        # A factor of all equations is a family by itself; without it the others have to vanish together.
        common = set.intersection(*map(set, needed))
        found: list[Family] = [(Zero(needed[0][key]),) for key in needed[0] if key in common]
        rest = [{key: factor for key, factor in e.items() if key not in common} for e in needed]
        if not all(rest):
            return found
        # Branch over the factors of the equation that is easiest to solve.
        first = min(rest, key=self._effort)
        if self._effort(first)[0]:
            # Factors without solutions of their own are a family if they share no joint.
            factors = [factor for equation in rest for factor in equation.values()]
            joints = [set(self.zeros.moving(factor.value)) for factor in factors]
            if not any(a & b for a, b in combinations(joints, 2)):
                return [*found, tuple(map(Zero, factors))]
            self.complete = self.complete and self.zeros.exist([factor.value for factor in factors]) is False
            return found
        for key, factor in first.items():
            found += self._with(factor, [e for e in rest if e is not first and key not in e])
        return found

    def _effort(self, equation: FactorChoice) -> tuple[int, ...]:
        unsolved = sum(not self.images(factor) for factor in equation.values())
        terms = sum(len(factor.value) for factor in equation.values())
        return len(equation) == unsolved == 1, len(equation), unsolved, terms

    def _with(self, factor: Factor, others: Sequence[FactorChoice]) -> list[Family]:
        """The families in which a factor is zero; its solutions together where the others are the same for all."""
        images = self.images(factor)
        if not images:
            return self._solved([{_key(factor): factor}, *others])
        tables = []
        for image in images:
            before: dict[tuple[str, int | None], Zero] = {}
            put = [self._put_in(equation, image, before) for equation in others]
            solved = self._solved([equation for equation in put if equation is not None])
            pairs = [(family, tuple(before.get(zero.key, zero) for zero in family)) for family in solved]
            tables.append({frozenset(zero.key for zero in read): (family, read) for family, read in pairs})
        # What holds at all solutions of a factor is said once, with the factor instead of one solution.
        shared = [name for name in tables[0] if all(name in table for table in tables)]
        alone = [(k, own) for k, table in enumerate(tables) for name, (own, _) in table.items() if name not in shared]
        return [(Zero(factor), *tables[0][name][1]) for name in shared] + [(Zero(factor, k), *own) for k, own in alone]

    def _put_in(
        self, equation: FactorChoice, image: Mapping[int, Polynomial], before: dict[tuple[str, int | None], Zero]
    ) -> FactorChoice | None:
        """An equation with a solution put in, None where it holds then; and which factors were others before."""
        found: dict[str, Factor] = {}
        for factor in equation.values():
            parts = self.moving_factors(self._put(factor.value, image))
            if parts is None:
                return None
            for key, part in parts.items():
                if len(parts) == 1 and (self.images(factor) or not self.images(part)):
                    before[key, None] = Zero(factor)
            found |= parts
        return found

    def _put(self, p: Polynomial, image: Mapping[int, Polynomial]) -> Polynomial:
        ring = self._domain.ring
        return ring.wrap(p.raw.compose(*(image[i].raw if i in image else g for i, g in enumerate(ring.context.gens()))))

    def images(self, factor: Factor) -> list[dict[int, Polynomial]]:
        """What each solution of a factor makes of the generators of one joint; none where it has no such solutions."""
        domain, ring = self._domain, self._domain.ring
        if factor.kind is None:
            joints = self.zeros.moving(factor.value)
            slope = domain.derivative(factor.value, joints[0])
            if len(joints) > 1 or domain.robot.joints[joints[0]].is_revolute or not slope.is_constant:
                return []
            rest = factor.value - slope * ring.generator(domain.robot.joints[joints[0]].variable)
            return [{domain.places[Kind.VARIABLE, joints[0]]: rest * (-1 / slope.constant_term)}]
        first, last = factor.joints[0], factor.joints[-1]
        group = domain.angles[last]  # its generator's angle is the sum over these, so that of the ones before is left
        before = group[: group.index(first)]
        c0, s0 = ring.one, ring.zero
        if before:
            places = (domain.places[kind, before[-1]] for kind in (Kind.COSINE, Kind.SINE))
            c0, s0 = (ring.wrap(ring.context.gens()[place]) for place in places)
        # The solutions put in: cosine and sine of the last angle from those of the angles before it.
        turn = domain.directions[first] * domain.directions[group[0]]
        values = ((1, 0), (-1, 0)) if factor.kind is Kind.SINE else ((0, -turn), (0, turn))
        cosine, sine = domain.places[Kind.COSINE, last], domain.places[Kind.SINE, last]
        return [{cosine: c * c0 - s * s0, sine: s * c0 + c * s0} for c, s in values]

    def largest(self, families: Sequence[Family]) -> list[Family]:
        """The families that do not lie in others."""
        kept: list[Family] = []
        for family in sorted(families, key=lambda f: (len(f), sum(len(zero.factor.value) for zero in f))):
            if not any(all(self._implies(family, zero) for zero in other) for other in kept):
                kept.append(family)
        return kept

    def _implies(self, family: Family, zero: Zero) -> bool:
        if zero.value is not None or zero.key in {own.key for own in family}:
            return zero.key in {own.key for own in family}
        # A family implies a zero if the factor vanishes at all its solutions.
        left = [zero.factor.value]
        for own in family:
            images = self.images(own.factor)
            chosen = images if own.value is None else images[own.value : own.value + 1]
            left = [self._put(p, image) for p in left for image in chosen or [{}]]
        return not any(left)

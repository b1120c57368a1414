"""Polynomials at random points modulo a prime: exact lower bounds of ranks.

A map of the ring of a robot into the integers modulo a prime that respects sums, products and every relation of the
ring (s^2 + c^2 = 1, w^2 = x, u x = 1) carries determinants to determinants: columns that are independent in the image
are independent over the ring. The converse holds but for unlucky points, so what looks dependent must be proven. The
numbers are arrays, so that one run of a recursion answers for many configurations and many right-hand sides.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from flint import fmpz, nmod_mat

from derive.algebra.domain import MappedDomain, PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial
from derive.errors import DeriveError
from derive.robot.expression import Number

Array = npt.NDArray[np.int64]

_LARGEST = 2**31 - 1  # products of two residues fit into 64 bits
# Points that are tried: every root has a value at half of them, so a ring with seven roots needs some 130.
_ATTEMPTS = 200
_SOLVED = (Kind.ROOT, Kind.PRIME_ROOT, Kind.INVERSE)  # generators whose value follows from that of others


class NoPointError(DeriveError):
    """No point was found at which every root of the ring has a value."""


class Residue:
    """An integer or an array of them modulo ``prime`` with the operations of a scalar."""

    __slots__ = ("_held", "prime")

    def __init__(self, prime: int, values: Any) -> None:
        self.prime = prime
        # A number alone stays one: most entries of frames are constants, and arithmetic with arrays costs more.
        known = values if isinstance(values, (int, np.ndarray)) else np.asarray(values, dtype=np.int64)
        self._held: int | Array = known % prime

    @property
    def values(self) -> Array:
        """The integers as an array, (1, 1) of a number alone."""
        return np.array([[self._held]], dtype=np.int64) if isinstance(self._held, int) else self._held

    def _read(self, other: Any) -> Residue:
        """Another operand, a residue or a rational."""
        if isinstance(other, Residue):
            return other
        return Residue(self.prime, other if isinstance(other, int) else fraction_residue(Fraction(other), self.prime))

    # Half of the numbers in the frames of an arm are 0 or 1, with which a sum or a product is the other operand itself.
    def __add__(self, other: Any, /) -> Residue:
        read = self._read(other)
        held, term = self._held, read._held
        if isinstance(term, int) and not term:
            return self
        if isinstance(held, int) and not held:
            return read
        return Residue(self.prime, held + term)

    __radd__ = __add__

    def __sub__(self, other: Any, /) -> Residue:
        term = self._read(other)._held
        return self if isinstance(term, int) and not term else Residue(self.prime, self._held - term)

    def __rsub__(self, other: Any, /) -> Residue:
        return Residue(self.prime, self._read(other)._held - self._held)

    def __mul__(self, other: Any, /) -> Residue:
        read = self._read(other)
        held, factor = self._held, read._held
        if isinstance(held, int) and held < 2:
            return read if held else self
        if isinstance(factor, int) and factor < 2:
            return self if factor else read
        return Residue(self.prime, held * factor)

    __rmul__ = __mul__

    def __neg__(self) -> Residue:
        return Residue(self.prime, -self._held)


class ResidueDomain(MappedDomain[Residue]):
    """A `derive.mechanics.chain.Domain` of residues: a polynomial domain at random configurations (samples, 1)."""

    def __init__(self, domain: PolynomialDomain, samples: int, seed: int = 0) -> None:
        self.value = cache(self._at_points)
        super().__init__(domain, self.value)
        self.samples = samples
        self._random = random.Random(seed)
        # the largest prime p = 4k + 3 of 31 bits modulo which the square roots of the ring's primes exist (Euler's
        # criterion), 2^31 - 1 being one itself; then a point at which all other roots do
        radicands = (g.argument for g in domain.generators if g.kind is Kind.PRIME_ROOT)
        squares = [int(r.value) for r in radicands if isinstance(r, Number)]
        candidates = (p for p in range(_LARGEST, 2**30, -4) if all(pow(x, (p - 1) // 2, p) == 1 for x in squares))
        self.prime = next((p for p in candidates if fmpz(p).is_prime()), 0)
        if not self.prime:
            raise NoPointError("no prime modulo which every root has a value")
        point = next((point for point in (self._draw_point() for _ in range(_ATTEMPTS)) if point is not None), None)
        if point is None:
            raise NoPointError("no point modulo a prime at which every root has a value")
        self._point = point

    def _at_points(self, p: Polynomial) -> Residue:
        """A polynomial at the points: (samples, 1), or (1, 1) where no joint variable is in it."""
        found = residue(p, self._point.__getitem__, self.prime)
        return Residue(self.prime, found.item() if found.size == 1 else found)

    def _draw_point(self) -> list[Array] | None:
        """A value per generator; None where a root or an inverse has none."""
        generators, index, p = self.domain.generators, self.domain.ring.index, self.prime
        # cosines, variables and parameters are free; their sines, roots and inverses follow from the relations
        point: list[Array] = [np.zeros((1, 1), dtype=np.int64)] * len(generators)
        pending = {i: g for i, g in enumerate(generators) if g.kind in _SOLVED}
        for i, g in enumerate(generators):
            if g.kind in (Kind.COSINE, Kind.CONSTANT_COSINE):
                # (1 - t^2, 2t) / (1 + t^2) on the unit circle; 1 + t^2 has no zero modulo a prime 4k + 3
                t = self._numbers(self.samples if g.kind is Kind.COSINE else 1)
                square = t * t % p
                scale = power((1 + square) % p, p - 2, p)
                point[i], point[index[g.partner]] = (1 - square) % p * scale % p, 2 * t % p * scale % p
            elif i not in pending and g.kind not in (Kind.SINE, Kind.CONSTANT_SINE):
                point[i] = self._numbers(self.samples if g.kind is Kind.VARIABLE else 1)
        # a radicand or denominator may hold other roots and inverses: the one whose argument is known comes first
        while pending:
            arguments = {i: self.domain.constant(g.argument) for i, g in pending.items()}
            ready = next(i for i, v in arguments.items() if not any(v.degrees()[k] for k in pending))
            value = residue(arguments[ready], point.__getitem__, p)
            if pending.pop(ready).kind is Kind.INVERSE:
                point[ready] = power(value, p - 2, p)  # Fermat: x^(p-2) = 1/x
                exists = value.all()
            else:
                point[ready] = power(value, (p + 1) // 4, p)  # a square root of x modulo p = 4k + 3, if x has one
                exists = (point[ready] * point[ready] % p == value).all()
            if not exists:
                return None
        return point

    def _numbers(self, count: int) -> Array:
        return np.array([[self._random.randrange(2, self.prime - 1)] for _ in range(count)], dtype=np.int64)


def residue(p: Polynomial, number: Callable[[int], Array], prime: int) -> Array:
    """A polynomial modulo a prime, its generators given by their places."""
    total: Array = np.zeros(1, dtype=np.int64)
    for exponents, coefficient in p.terms():
        term: Array = np.full(1, fraction_residue(coefficient, prime), dtype=np.int64)
        for i, exponent in enumerate(exponents):
            if exponent:
                term = term * power(number(i), exponent, prime) % prime
        total = (total + term) % prime
    return total


def fraction_residue(value: Fraction, prime: int) -> int:
    """A rational modulo a prime."""
    return value.numerator * pow(value.denominator, -1, prime) % prime


def echelon(matrix: Array, prime: int) -> tuple[tuple[int, ...], Array]:
    """Pivot columns of a matrix (m, n) modulo a prime, and what of each (rank, n) is in every column (echelon form)."""
    entries = np.asarray(matrix, dtype=np.int64) % prime
    form, rank = nmod_mat(*entries.shape, entries.ravel().tolist(), prime).rref()
    rows = [[int(entry) for entry in row] for row in form.tolist()[:rank]]
    pivots = tuple(next(j for j, entry in enumerate(row) if entry) for row in rows)
    return pivots, np.array(rows, dtype=np.int64).reshape(rank, entries.shape[1])


def power(base: Array, exponent: int, prime: int) -> Array:
    """Powers of integers modulo a prime, by repeated squaring."""
    result: Array = np.ones_like(base)
    while exponent:
        if exponent & 1:
            result = result * base % prime
        exponent >>= 1
        base = base * base % prime
    return result

"""Exact polynomials in sines, cosines, variables and parameters, reduced by what their generators satisfy.

Everything that a DH chain yields is a polynomial over the rationals in the sine and cosine of each joint angle, the
prismatic variables and the parameters. A `Ring` holds the generators and their relations (s^2 + c^2 = 1 for every
angle, w^2 = x for every square root, u*x = 1 for every inverse); a `Polynomial` is always in normal form, so that
equality is equality of coefficients.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any, TypeVar

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx

from derive.errors import DeriveError

E = TypeVar("E", bound=Any)  # entries of a matrix; those that are zero may be false

UNBOUNDED = 10**9  # a budget of terms that no polynomial reaches


class TooManyTerms(DeriveError):
    """A closed form that would be longer than its budget."""

    def __init__(self, budget: int) -> None:
        super().__init__(f"a closed form of more than {budget} terms", remedy="use the generated functions instead")


@dataclass(frozen=True, slots=True)
class Relation:
    """A generator and the polynomial, led by it, that is zero."""

    generator: int  # index of the generator
    polynomial: fmpq_mpoly  # ``s^2 + c^2 - 1``, ``w^2 - x`` or ``u*x - 1``
    # Reduce whenever the generator occurs (inverses), not only when it occurs on both sides of a product.
    always: bool = False


class Ring:
    """A polynomial ring modulo relations."""

    def __init__(self, names: Sequence[str], max_terms: int = UNBOUNDED) -> None:
        self.names, self.max_terms = tuple(names), max_terms
        plain = tuple(name.encode("ascii", "backslashreplace") for name in self.names)  # as FLINT wants them
        self.context = fmpq_mpoly_ctx.get(plain, Ordering.lex)  # FLINT's ring without the relations
        # generator name -> its place in the exponent vectors
        self.index = {name: i for i, name in enumerate(self.names)}
        # what the generators satisfy; sets of relations are written as bits, relation r as 1 << r
        self.relations: list[Relation] = []
        # opening: the relations that put generators of other relations in place of their own; always: the relations by
        # which every product must be reduced
        self.opening = self.always = 0
        self._raw = self.context.gens()
        self.zero = Polynomial(self, self.context.constant(0), 0)
        self.one = Polynomial(self, self.context.constant(1), 0)

    # -- relations, added while the ring is set up

    def relate_angle(self, eliminated: str, kept: str) -> None:
        """The Pythagorean identity s^2 + c^2 = 1: every square of the one becomes 1 less the square of the other."""
        other = self.generator(kept)
        self.relate_root(eliminated, 1 - other * other)

    def relate_root(self, name: str, radicand: Polynomial) -> None:
        """The square of a root, w^2 = x."""
        self._relate(Relation(self.index[name], self.generator(name).raw ** 2 - radicand.raw))

    def relate_inverse(self, name: str, value: Polynomial) -> None:
        """An inverse, u*x = 1."""
        self._relate(Relation(self.index[name], self.generator(name).raw * value.raw - 1, always=True))

    def _relate(self, relation: Relation) -> None:
        self.relations.append(relation)
        own = 1 << (len(self.relations) - 1)
        if self._bits(relation.polynomial) & ~own:
            self.opening |= own
        if relation.always:
            self.always |= own

    def _bits(self, raw: fmpq_mpoly) -> int:
        """Which relations a raw polynomial may be reduced by: bit r is set when the generator of relation r occurs."""
        degrees = raw.degrees() if raw else ()
        return sum(1 << r for r, rel in enumerate(self.relations) if degrees and degrees[rel.generator])

    def _reduce(self, raw: fmpq_mpoly, bits: int) -> fmpq_mpoly:
        """The remainder of a raw polynomial modulo the relations whose bits are set."""
        for r, relation in enumerate(self.relations):
            if bits >> r & 1:
                raw = divmod(raw, relation.polynomial)[1]
        # an inverse brings back generators of the relations before it: they are reduced once more
        return self._reduce(raw, self._bits(raw) & ~self.always) if bits & self.always else raw

    def settle(self, raw: fmpq_mpoly) -> Polynomial:
        """A raw polynomial reduced until nothing changes: a radicand may bring back what was reduced before."""
        while (reduced := self._reduce(raw, self._bits(raw))) != raw:
            raw = reduced
        return Polynomial(self, raw, self._bits(raw))

    # -- elements

    def generator(self, name: str) -> Polynomial:
        """A generator as a polynomial."""
        i = self.index[name]
        mask = sum(1 << r for r, relation in enumerate(self.relations) if relation.generator == i)
        return Polynomial(self, self._raw[i], mask)

    def number(self, value: int | Fraction) -> Polynomial:
        """A rational as a constant polynomial."""
        if value == 0:
            return self.zero
        return Polynomial(self, self.context.constant(fmpq(value.numerator, value.denominator)), 0)

    def wrap(self, raw: fmpq_mpoly) -> Polynomial:
        """A raw polynomial as an element of this ring, reduced to normal form."""
        mask = self._bits(raw)
        return self.settle(raw) if mask & self.opening else Polynomial(self, self._reduce(raw, mask), mask)

    def project(self, p: Polynomial) -> Polynomial:
        """A polynomial of another ring as one of this ring."""
        return self.wrap(p.raw.project_to_context(self.context))

    def coefficients(self, p: Polynomial, generators: Sequence[int]) -> dict[tuple[int, ...], Polynomial]:
        """A polynomial as one in some generators, with polynomials in all the others as coefficients."""
        parts: dict[tuple[int, ...], dict[tuple[int, ...], fmpq]] = {}
        for exponents, coefficient in p.raw.terms():
            # the monomial without these generators belongs to the coefficient
            rest = [int(e) for e in exponents]
            for i in generators:
                rest[i] = 0
            parts.setdefault(tuple(int(exponents[i]) for i in generators), {})[tuple(rest)] = coefficient
        return {monomial: self.wrap(self.context.from_dict(terms)) for monomial, terms in parts.items()}


class Polynomial:
    """An element of a `Ring` in normal form; immutable."""

    __slots__ = ("_key", "_mask", "raw", "ring")

    def __init__(self, ring: Ring, raw: fmpq_mpoly, mask: int) -> None:
        self.ring, self.raw, self._mask = ring, raw, mask
        self._key: str | None = None

    def _coerce(self, other: Polynomial | int | Fraction) -> Polynomial:
        return other if isinstance(other, Polynomial) else self.ring.number(other)

    def __add__(self, other: Any) -> Polynomial:
        o = self._coerce(other)
        if not o.raw:
            return self
        if not self.raw:
            return o
        return Polynomial(self.ring, self.raw + o.raw, self._mask | o._mask)

    __radd__ = __add__

    def __neg__(self) -> Polynomial:
        return Polynomial(self.ring, -self.raw, self._mask)

    def __sub__(self, other: Any) -> Polynomial:
        o = self._coerce(other)
        return self if not o.raw else Polynomial(self.ring, self.raw - o.raw, self._mask | o._mask)

    def __rsub__(self, other: Any) -> Polynomial:
        return (-self).__add__(other)

    def __mul__(self, other: Any) -> Polynomial:
        o, ring = self._coerce(other), self.ring
        if not self.raw or not o.raw:
            return ring.zero
        both = self._mask | o._mask
        raw = self.raw * o.raw
        if len(raw) > ring.max_terms:
            raise TooManyTerms(ring.max_terms)
        if both:
            # factors are in normal form: only a generator that stands in both can have come to its square
            bits = self._mask & o._mask | both & ring.always
            raw = ring._reduce(raw, bits)
            if bits & ring.opening:
                return ring.settle(raw)
        return Polynomial(ring, raw, both)

    __rmul__ = __mul__

    def __pow__(self, exponent: int) -> Polynomial:
        result = self.ring.one
        for _ in range(exponent):
            result = result * self
        return result

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Polynomial | int | Fraction) and bool(self.raw == self._coerce(other).raw)

    def __hash__(self) -> int:
        return hash(self.key())

    def __bool__(self) -> bool:
        return bool(self.raw)

    def __len__(self) -> int:
        """Number of terms."""
        return len(self.raw)

    def __repr__(self) -> str:
        return f"Polynomial({self.raw})"

    def terms(self) -> Iterator[tuple[tuple[int, ...], Fraction]]:
        """Exponent vectors and coefficients, highest monomial first."""
        for exponents, coefficient in self.raw.terms():
            yield tuple(int(e) for e in exponents), fraction(coefficient)

    def key(self) -> str:
        """A hashable value that is equal for equal polynomials of one ring: FLINT's own print, its quickest walk."""
        if self._key is None:
            self._key = self.raw.str()
        return self._key

    def normalised(self) -> tuple[Fraction, str]:
        """The leading coefficient, and the key of the polynomial divided by it."""
        if not self.raw:
            return Fraction(1), "0"
        lead = fraction(self.raw.leading_coefficient())
        return lead, (self if lead == 1 else self * (1 / lead)).key()

    def degrees(self) -> tuple[int, ...]:
        """The degree in every generator (zeros for the zero polynomial)."""
        return tuple(int(d) for d in self.raw.degrees()) if self.raw else (0,) * len(self.ring.names)

    @property
    def is_constant(self) -> bool:
        """Whether it is a rational number."""
        return bool(self.raw.is_constant())

    @property
    def constant_term(self) -> Fraction:
        """The rational that a constant polynomial is."""
        return fraction(self.raw.leading_coefficient()) if self.raw else Fraction(0)

    def partial(self, generator: int) -> Polynomial:
        """The partial derivative in one generator, all others held."""
        return Polynomial(self.ring, self.raw.derivative(generator), self._mask)


def in_lowest_terms(p: Polynomial, q: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Two polynomials without their common factors."""
    common = p.raw.gcd(q.raw)
    return p.ring.wrap(divmod(p.raw, common)[0]), p.ring.wrap(divmod(q.raw, common)[0])


def fraction(value: fmpq) -> Fraction:
    """A FLINT rational as a Python one."""
    return Fraction(int(value.p), int(value.q))


def determinant(rows: Sequence[Sequence[E]]) -> E:
    """The determinant of a matrix (n, n) of polynomials or other scalars."""
    return minors(rows, [tuple(range(len(rows)))])[0]


def minors(rows: Sequence[Sequence[E]], chosen: Iterable[tuple[int, ...]]) -> list[E]:
    """The determinants of some columns of a matrix, as many as it has rows, by Laplace expansion, every minor once.

    With the rows taken from the last one up, a minor is fixed by its columns; a square matrix has 2^n of them.
    """
    size = len(rows)

    @cache
    def _minor(columns: tuple[int, ...]) -> E:
        row = rows[size - len(columns)]
        if len(columns) == 1:
            return row[columns[0]]
        total: E = row[columns[0]] - row[columns[0]]
        for place, column in enumerate(columns):
            if row[column]:
                rest = row[column] * _minor(columns[:place] + columns[place + 1 :])
                total = total - rest if place % 2 else total + rest
        return total

    return [_minor(columns) for columns in chosen]

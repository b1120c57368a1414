"""Exact polynomials as tape values: sums of products of sines, cosines, variables and rates.

What stands beside such a product, parameters and numbers, is gathered first, so that it is hoisted.
"""

from __future__ import annotations

from functools import cached_property

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Generator, Kind
from derive.algebra.ring import Polynomial
from derive.algebra.tape_domain import QD, QDD, Q, TapeDomain
from derive.algebra.tape_value import Value

_ARGUMENTS = {Kind.VARIABLE: Q, Kind.RATE: QD, Kind.ACCELERATION: QDD}

Monomial = tuple[tuple[int, int], ...]
"""Generator indices with their exponents, ascending."""


class PolynomialTape:
    """Writes the polynomials of one domain on the graph of a tape domain of the same robot.

    Args:
        polynomials: Where the polynomials live.
        tape: Where the values go.
    """

    def __init__(self, polynomials: PolynomialDomain, tape: TapeDomain) -> None:
        self._polynomials = polynomials
        self._tape = tape

    def value(self, p: Polynomial) -> Value:
        """A polynomial, expanded."""
        zero, one = self._tape.number(0), self._tape.number(1)
        groups: dict[Monomial, Value] = {}
        for exponents, coefficient in p.terms():
            used = tuple((i, e) for i, e in enumerate(exponents) if e)
            late = tuple((i, e) for i, e in used if self._late[i])
            early = self._product(tuple((i, e) for i, e in used if not self._late[i]), self._tape.number(coefficient))
            groups[late] = groups.get(late, zero) + early
        return sum((factor * self._product(late, one) for late, factor in groups.items()), zero)

    def _product(self, monomial: Monomial, start: Value) -> Value:
        for i, exponent in monomial:
            start = start * self._values[i] ** exponent
        return start

    @cached_property
    def _late(self) -> list[bool]:
        """Whether a generator depends on the arguments."""
        late = (Kind.SINE, Kind.COSINE, *_ARGUMENTS)
        return [generator.kind in late for generator in self._polynomials.generators]

    @cached_property
    def _values(self) -> list[Value]:
        return [self._generator(generator) for generator in self._polynomials.generators]

    def _generator(self, generator: Generator) -> Value:
        tape, kind = self._tape, generator.kind
        match kind:
            case Kind.SINE:
                return self._angle(generator.joint).sin()
            case Kind.COSINE:
                return self._angle(generator.joint).cos()
            case Kind.VARIABLE | Kind.RATE | Kind.ACCELERATION:
                return tape.argument(_ARGUMENTS[kind], generator.joint)
            case Kind.CONSTANT_COSINE:
                return tape.cosine_sine(generator.argument)[0]
            case Kind.CONSTANT_SINE:
                return tape.cosine_sine(generator.argument)[1]
            case Kind.ROOT | Kind.PRIME_ROOT:
                return tape.constant(generator.argument).sqrt()
            case Kind.INVERSE:
                return 1 / tape.constant(generator.argument)
            case Kind.PARAMETER | Kind.PI:
                return tape.constant(generator.argument)

    def _angle(self, joint: int) -> Value:
        """The sum of joint variables of which a generator is the sine or cosine."""
        polynomials = self._polynomials
        members = polynomials.angles[joint]
        first = polynomials.directions[members[0]]
        turns = (first * polynomials.directions[m] * self._tape.argument(Q, m) for m in members)
        return sum(turns, self._tape.number(0))

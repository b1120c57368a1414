"""Factors that cost nothing per evaluation: numbers, and what depends on run-time parameters alone.

Two of them are the same if they agree as functions: each is known by its value at one random point, modulo a large
prime. Polynomials of degree d that differ agree there with probability d / 2**61 (Schwartz 1980), so sums that cancel
and products in another order are recognised without being expanded.
"""

from __future__ import annotations

from fractions import Fraction

from derive.algebra import constants
from derive.programs.tape.graph import ONE, ZERO, Graph, Ref
from derive.programs.tape.tape import Op, Source

PRIME = 2**61 - 1


def scatter(*key: object) -> int:
    """A fixed pseudo-random residue for a key of strings and whole numbers."""
    text = repr(key).encode()
    value = 0x9E3779B97F4A7C15
    for byte in text:
        value = (value ^ byte) * 0x100000001B3 % PRIME
        value ^= value >> 29
    return value % PRIME


class Coefficients:
    """Arithmetic on the hoisted references of a graph; equal values have equal references.

    Args:
        graph: Where the values live.
    """

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self._residue: dict[int, int] = {}
        self._known: dict[int, Ref] = {0: ZERO}
        self._sums: dict[tuple[Ref, Ref], Ref] = {}
        self._products: dict[tuple[Ref, Ref], Ref] = {}
        self._ratios: dict[tuple[Ref, Ref], Ref | None] = {}

    def residues(self) -> list[int]:
        """The values of all coefficients so far."""
        return list(self._known)

    def find(self, residue: int) -> Ref | None:
        """The coefficient of this value, if there is one."""
        found = self._known.get(residue)
        if found is not None:
            return found
        other = self._known.get(PRIME - residue)
        return None if other is None else other ^ 1

    def same(self, ref: Ref) -> Ref:
        """The reference by which this value is known."""
        residue = self.residue(ref)
        found = self.find(residue)
        if found is None:
            found = self._known[residue] = ref
        return found

    def add(self, a: Ref, b: Ref) -> Ref:
        """A + b."""
        found = self._sums.get((a, b))
        if found is None:
            found = self._sums[a, b] = self.same(self.graph.add(a, b))
        return found

    def multiply(self, a: Ref, b: Ref) -> Ref:
        """A times b."""
        if a == ZERO or b == ZERO:
            return ZERO
        if b >> 1 == 1:
            return a ^ (b & 1)
        if a >> 1 == 1:
            return b ^ (a & 1)
        found = self._products.get((a, b))
        if found is None:
            found = self._products[a, b] = self.same(self.graph.multiply(a, b))
        return found

    def ratio(self, a: Ref, b: Ref) -> Ref | None:
        """A over b where that is a number; None otherwise."""
        if a >> 1 == b >> 1:
            return ONE ^ ((a ^ b) & 1)
        if self.graph.op[a >> 1] is not Op.CONSTANT or self.graph.op[b >> 1] is not Op.CONSTANT:
            return None
        if (a, b) not in self._ratios:
            self._ratios[a, b] = self._divide(a, b)
        return self._ratios[a, b]

    def _divide(self, a: Ref, b: Ref) -> Ref:
        x, y = self.graph.constant_of(a), self.graph.constant_of(b)
        return self.graph.number(constants.multiply(x, constants.reciprocal(y)))

    def residue(self, ref: Ref) -> int:
        """The value at the random point."""
        value = self._residue_of(ref >> 1)
        return (PRIME - value) % PRIME if ref & 1 else value

    def _residue_of(self, index: int) -> int:
        found = self._residue.get(index)
        if found is None:
            found = self._residue[index] = self._evaluate(index)
        return found

    def _evaluate(self, index: int) -> int:
        graph = self.graph
        payload = graph.payload.get(index)
        if isinstance(payload, Source):
            return scatter(payload.kind, payload.index)
        if payload is not None:
            return residue_of_constant(payload)
        return combine(graph.op[index], [self._residue_of(k) for k in graph.operands[index]])


def residue_of_constant(value: constants.Constant) -> int:
    """A rational as it is; any other number at random."""
    if isinstance(value, Fraction):
        return value.numerator * pow(value.denominator, -1, PRIME) % PRIME
    return scatter("constant", *constants.key_of(value))


def combine(op: Op, operands: list[int]) -> int:
    """The residue of an operation; functions are random, but know their symmetry."""
    match op:
        case Op.ADD:
            return (operands[0] + operands[1]) % PRIME
        case Op.SUBTRACT:
            return (operands[0] - operands[1]) % PRIME
        case Op.MULTIPLY:
            return operands[0] * operands[1] % PRIME
        case Op.DIVIDE if operands[1]:
            return operands[0] * pow(operands[1], -1, PRIME) % PRIME
        case Op.NEGATE:
            return -operands[0] % PRIME
        case Op.SINE | Op.COSINE:
            return _on_circle(op, operands[0])
        case Op.SIGN:
            low = min(operands[0], PRIME - operands[0])
            value = scatter(int(op), low)
            return value if low == operands[0] else PRIME - value
    return scatter(int(op), *operands)


def _on_circle(op: Op, angle: int) -> int:
    """Sine or cosine: a random rational point of the unit circle for each angle, mirrored for its negative."""
    low = min(angle, PRIME - angle)
    half = scatter("tangent", low)
    scale = pow(1 + half * half, -1, PRIME)
    if op is Op.COSINE:
        return (1 - half * half) * scale % PRIME
    return (2 * half if low == angle else -2 * half) * scale % PRIME

"""Factors that cost nothing per evaluation: numbers, and what depends on run-time parameters alone.

Two of them are the same if they agree as functions: each is known by its value at one random point, modulo a large
prime. Polynomials of degree d that differ agree there with probability d / 2**61 (Schwartz 1980), so sums that cancel
and products in another order are recognised without being expanded.
"""

from collections.abc import Sequence
from fractions import Fraction

from derive.algebra import constants
from derive.programs.tape.graph import ONE, UNITS, ZERO, Graph, Ref, is_negative, negated, node_of, ref_to, signed
from derive.programs.tape.tape import Op

PRIME = 2**61 - 1


def scatter(*key: object) -> int:
    """A fixed pseudo-random residue."""
    value = 0x9E3779B97F4A7C15
    for byte in repr(key).encode():
        value = (value ^ byte) * 0x100000001B3 % PRIME
        value ^= value >> 29
    return value % PRIME


def residue_of(op: Op, operands: Sequence[int]) -> int:
    """The residue of an operation."""
    first = operands[0]
    # The same for x and -x: even functions depend on it alone, odd ones take their sign from the rest.
    low = min(first, PRIME - first)
    match op:
        case Op.ADD:
            return (first + operands[1]) % PRIME
        case Op.SUBTRACT:
            return (first - operands[1]) % PRIME
        case Op.MULTIPLY:
            return first * operands[1] % PRIME
        case Op.DIVIDE if operands[1]:
            return first * pow(operands[1], -1, PRIME) % PRIME
        case Op.NEGATE:
            return -first % PRIME
        case Op.SINE | Op.COSINE:
            # A random tangent t of half the angle: c = (1 - t^2)/(1 + t^2), s = 2t/(1 + t^2) keep s^2 + c^2 = 1.
            tangent = scatter("tangent", low)
            scale = pow(1 + tangent * tangent, -1, PRIME)
            if op is Op.COSINE:
                return (1 - tangent * tangent) * scale % PRIME
            return (2 * tangent if low == first else -2 * tangent) * scale % PRIME
        case Op.ABSOLUTE:
            return scatter(int(op), low)
        case Op.MAXIMUM | Op.MINIMUM:
            # Symmetric in both operands.
            return scatter(int(op), *sorted(operands))
        case Op.SIGN:
            # Odd: sign(-x) = -sign(x).
            value = scatter(int(op), low)
            return value if low == first else PRIME - value
    return scatter(int(op), *operands)


class Coefficients:
    """Arithmetic on the hoisted references of a graph; equal values have equal references."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self._residues: dict[int, int] = {}
        self._known: dict[int, Ref] = {0: ZERO}
        self._sums: dict[tuple[Ref, Ref], Ref] = {}
        self._products: dict[tuple[Ref, Ref], Ref] = {}
        self._ratios: dict[tuple[Ref, Ref], Ref | None] = {}

    def residues(self) -> list[int]:
        """The values of all coefficients so far."""
        return list(self._known)

    def find(self, residue: int) -> Ref | None:
        """The coefficient of some value, or minus that of its opposite; None where neither is known."""
        if (found := self._known.get(residue)) is not None:
            return found
        other = self._known.get(PRIME - residue)
        return None if other is None else negated(other)

    def same(self, ref: Ref) -> Ref:
        """The reference by which a value is known."""
        residue = self.residue(ref)
        if (found := self.find(residue)) is None:
            found = self._known[residue] = ref
        return found

    def add(self, a: Ref, b: Ref) -> Ref:
        """A sum."""
        found = self._sums.get((a, b))
        if found is None:
            found = self._sums[a, b] = self.same(self.graph.add(a, b))
        return found

    def multiply(self, a: Ref, b: Ref) -> Ref:
        """A product."""
        if ZERO in (a, b) or a in UNITS or b in UNITS:
            return self.graph.multiply(a, b)
        found = self._products.get((a, b))
        if found is None:
            found = self._products[a, b] = self.same(self.graph.multiply(a, b))
        return found

    def ratio(self, a: Ref, b: Ref) -> Ref | None:
        """The quotient a / b; None where that is no number."""
        if node_of(a) == node_of(b):
            return signed(ONE, a != b)
        if (a, b) not in self._ratios:
            # A quotient of parameters would divide at run time, by what may be zero; of numbers it is exact.
            x, y = self.graph.constant_of(a), self.graph.constant_of(b)
            is_number = x is not None and y is not None
            found = self.graph.number(constants.multiply(x, constants.reciprocal(y))) if is_number else None
            self._ratios[a, b] = found
        return self._ratios[a, b]

    def residue(self, ref: Ref) -> int:
        """The value at the random point."""
        node = node_of(ref)
        if (value := self._residues.get(node)) is None:
            source, number = self.graph.sources.get(node), self.graph.constants.get(node)
            if source is not None:
                value = scatter(source.kind, source.index)
            elif isinstance(number, Fraction):
                value = number.numerator * pow(number.denominator, -1, PRIME) % PRIME
            elif number is not None:
                value = scatter("constant", *constants.key_of(number))
            else:
                value = residue_of(self.graph.op[node], [self.residue(ref_to(k)) for k in self.graph.operands[node]])
            self._residues[node] = value
        return (PRIME - value) % PRIME if is_negative(ref) else value

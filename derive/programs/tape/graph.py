"""The interned graph from which tapes are cut: building a value that exists already returns it.

A value is referred to by ``2*index + negative``: the sign is part of the reference, so -x and x are one node, products
and quotients pass signs on, and a sum of two negatives is a negative sum. Commutative operands are in the order of
their creation; numbering depends on nothing else.
"""

from __future__ import annotations

from fractions import Fraction

from derive.algebra import constants
from derive.algebra.constants import Constant
from derive.errors import QuantityError
from derive.programs.tape.tape import FUNCTION_NAMES, PARAMETER, Layer, Node, Op, Source

Ref = int
ZERO: Ref = 0
ONE: Ref = 2
MINUS_ONE: Ref = 3

_ONE = ONE >> 1
_CONSTANT = Layer.CONSTANT
_ADD, _SUBTRACT, _MULTIPLY = Op.ADD, Op.SUBTRACT, Op.MULTIPLY


class Graph:
    """Nodes by index; all methods return references."""

    def __init__(self) -> None:
        self.op: list[Op] = []
        self.operands: list[tuple[int, ...]] = []
        self.layer: list[int] = []
        self.payload: dict[int, Constant | Source] = {}
        self._index: dict[tuple[object, ...], int] = {}
        self.number(Fraction(0))
        self.number(Fraction(1))

    def __len__(self) -> int:
        return len(self.op)

    def node(self, index: int) -> Node:
        """One node, as it stands in a tape (operands in the numbering of this graph)."""
        payload = self.payload.get(index)
        source = payload if isinstance(payload, Source) else None
        value = None if source is not None else payload
        return Node(self.op[index], self.operands[index], Layer(self.layer[index]), value, source)

    def number(self, value: Constant) -> Ref:
        """A constant."""
        negative = value < 0
        if negative:
            value = -value
        key = (Op.CONSTANT, *constants.key_of(value))
        index = self._index.get(key)
        if index is None:
            index = self._append(key, Op.CONSTANT, (), Layer.CONSTANT)
            self.payload[index] = value
        return 2 * index + negative

    def input(self, kind: str, index: int) -> Ref:
        """An argument or a run-time parameter."""
        key = (Op.INPUT, kind, index)
        found = self._index.get(key)
        if found is None:
            found = self._append(key, Op.INPUT, (), Layer.HOISTED if kind == PARAMETER else Layer.BODY)
            self.payload[found] = Source(kind, index)
        return 2 * found

    def constant_of(self, ref: Ref) -> Constant | None:
        """The number behind a reference, or None."""
        if self.op[ref >> 1] is not Op.CONSTANT:
            return None
        value = self.payload[ref >> 1]
        return -value if ref & 1 else value  # type: ignore[operator]

    def add(self, a: Ref, b: Ref) -> Ref:
        """A + b."""
        if a == ZERO:
            return b
        if b == ZERO:
            return a
        first, second = a >> 1, b >> 1
        if first == second:
            return self.multiply(self.number(Fraction(2)), a) if a == b else ZERO
        if self.layer[first] == self.layer[second] == _CONSTANT:
            return self.number(constants.add(self.constant_of(a), self.constant_of(b)))
        sign = a & 1 if first < second else b & 1
        return self._commutative(_SUBTRACT if (a ^ b) & 1 else _ADD, first, second) | sign

    def subtract(self, a: Ref, b: Ref) -> Ref:
        """A - b."""
        return self.add(a, b ^ 1 if b else b)

    def negate(self, a: Ref) -> Ref:
        """-a."""
        return a ^ 1 if a else a

    def multiply(self, a: Ref, b: Ref) -> Ref:
        """A times b."""
        if a == ZERO or b == ZERO:
            return ZERO
        sign = (a ^ b) & 1
        first, second = a >> 1, b >> 1
        if first == _ONE or second == _ONE:
            return 2 * (second if first == _ONE else first) | sign
        if self.layer[first] == _CONSTANT:
            return self._scale(first, second) ^ sign
        if self.layer[second] == _CONSTANT:
            return self._scale(second, first) ^ sign
        return self._commutative(_MULTIPLY, first, second) | sign

    def _scale(self, factor: int, index: int) -> Ref:
        """Constant times value; two constants in a row become one."""
        if self.layer[index] == _CONSTANT:
            return self.number(constants.multiply(self.payload[factor], self.payload[index]))
        if self.op[index] is _MULTIPLY:
            inner = self.constant_of(2 * self.operands[index][0])
            if inner is not None:
                number = self.number(constants.multiply(self.constant_of(2 * factor), inner))
                return self.multiply(number, 2 * self.operands[index][1])
        return self._intern(_MULTIPLY, factor, index)

    def divide(self, a: Ref, b: Ref) -> Ref:
        """A over b; what depends on the arguments may be divided by zero, as floats may.

        Raises:
            QuantityError: b is the constant zero and a does not depend on the arguments, as in a cell.
        """
        divisor = self.constant_of(b)
        if divisor == 0 and self.layer[a >> 1] == Layer.BODY:
            return self._intern(Op.DIVIDE, a >> 1, b >> 1) | (a & 1)
        if divisor is not None:
            return self.multiply(a, self.number(constants.reciprocal(divisor)))
        if a == ZERO:
            return ZERO
        if a >> 1 == b >> 1:
            return ONE | ((a ^ b) & 1)
        return self._intern(Op.DIVIDE, a >> 1, b >> 1) | ((a ^ b) & 1)

    def sine(self, a: Ref) -> Ref:
        """sin(a)."""
        value = self.constant_of(a)
        if value is not None:
            return self.number(constants.sine(value))
        return self._intern(Op.SINE, a >> 1) | (a & 1)

    def cosine(self, a: Ref) -> Ref:
        """cos(a)."""
        value = self.constant_of(a)
        if value is not None:
            return self.number(constants.cosine(value))
        return self._intern(Op.COSINE, a >> 1)

    def root(self, a: Ref) -> Ref:
        """Square root.

        Raises:
            QuantityError: a is a negative constant.
        """
        value = self.constant_of(a)
        if value is not None:
            return self.number(constants.square_root(value))
        index = a >> 1
        if a & 1:
            index = self._intern(Op.NEGATE, index) >> 1
        return self._intern(Op.ROOT, index)

    def sign(self, a: Ref) -> Ref:
        """-1, 0 or 1."""
        value = self.constant_of(a)
        if value is not None:
            return self.number(Fraction((value > 0) - (value < 0)))
        return self._intern(Op.SIGN, a >> 1) | (a & 1)

    def apply(self, op: Op, *operands: Ref) -> Ref:
        """The operation by its kind, folded as if written."""
        match op:
            case Op.ADD:
                return self.add(*operands)
            case Op.SUBTRACT:
                return self.subtract(*operands)
            case Op.MULTIPLY:
                return self.multiply(*operands)
            case Op.DIVIDE:
                return self.divide(*operands)
            case Op.NEGATE:
                return self.negate(*operands)
            case Op.SINE:
                return self.sine(*operands)
            case Op.COSINE:
                return self.cosine(*operands)
            case Op.ROOT:
                return self.root(*operands)
            case Op.SIGN:
                return self.sign(*operands)
        raise QuantityError(f"no operation {op!r} on {len(operands)} values", allowed=f"{list(FUNCTION_NAMES)}")

    def _commutative(self, op: Op, first: int, second: int) -> Ref:
        """An operation (of opposite sign, for a difference) on two nodes, the older first."""
        operands = (first, second) if first < second else (second, first)
        key = (op, operands)
        index = self._index.get(key)
        if index is None:
            index = self._append(key, op, operands, max(self.layer[first], self.layer[second]))
        return 2 * index

    def _intern(self, op: Op, *operands: int) -> Ref:
        key = (op, operands)
        index = self._index.get(key)
        if index is None:
            index = self._append(key, op, operands, max(self.layer[i] for i in operands))
        return 2 * index

    def _append(self, key: tuple[object, ...], op: Op, operands: tuple[int, ...], layer: int) -> int:
        index = len(self.op)
        self._index[key] = index
        self.op.append(op)
        self.operands.append(operands)
        self.layer.append(layer)
        return index

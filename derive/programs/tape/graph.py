"""The interned graph from which tapes are cut: its nodes, references to them, and the operations of formulas.

Building a value that exists already returns it. A value is referred to by a node and a sign (`Ref`): -x and x are one
node, products and quotients pass signs on, and a sum of two negatives is a negative sum. Commutative operands are in
the order of their creation; numbering depends on nothing else.

A case is 1 or 0, so *and* is a product or a minimum, *or* a maximum, and *not* the difference from 1. They are folded
as sums and products are: choices between opposites are opposite, and known cases leave no trace.
"""

from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NewType

from derive.algebra import constants
from derive.algebra.constants import Constant, Key
from derive.programs.tape.tape import PARAMETER, InputSource, Layer, Node, Op

Ref = NewType("Ref", int)
"""A node of a graph with a sign: twice the node's index, one more for its negative. Zero has no negative.

A whole number, because millions are made and compared. What the bits mean is known to this module alone: elsewhere a
reference is taken apart by `node_of` and `is_negative`, and made by `ref_to`, `negated` and `signed`.
"""

ZERO = Ref(0)
ONE = Ref(2)
MINUS_ONE = Ref(3)
UNITS = (ONE, MINUS_ONE)  # factors that cost no multiplication


def ref_to(node: int) -> Ref:
    """The reference to a node."""
    return Ref(node << 1)


def node_of(ref: Ref) -> int:
    """The node behind a reference."""
    return ref >> 1


def is_negative(ref: Ref) -> bool:
    """Whether a reference is to minus its node."""
    return ref & 1 == 1


def negated(ref: Ref) -> Ref:
    """Minus a value."""
    return Ref(ref ^ 1) if ref else ref


def signed(ref: Ref, negative: bool) -> Ref:
    """A value or minus it."""
    return negated(ref) if negative else ref


class Graph:
    """Nodes in the order of their creation; constants are folded, equal operations are made once."""

    def __init__(self) -> None:
        self.op: list[Op] = []
        self.operands: list[tuple[int, ...]] = []  # indices of earlier nodes
        self.layer: list[Layer] = []
        self.constants: dict[int, Constant] = {}
        self.sources: dict[int, InputSource] = {}
        # Values of pairs, as `Value` keeps them: a recursion that is traced many times with small changes finds most of
        # its operations here.
        self.sums: dict[tuple[Ref, Ref], Any] = {}
        self.differences: dict[tuple[Ref, Ref], Any] = {}
        self.products: dict[tuple[Ref, Ref], Any] = {}
        self._nodes: dict[tuple[Op, tuple[int, ...]], Ref] = {}
        self._numbers: dict[Key, Ref] = {}
        self._inputs: dict[InputSource, Ref] = {}
        self.number(Fraction(0))
        self.number(Fraction(1))

    def __len__(self) -> int:
        return len(self.op)

    def node(self, index: int, number: Mapping[int, int]) -> Node:
        """A node as it stands in a tape."""
        operands = tuple([number[k] for k in self.operands[index]])
        return Node(self.op[index], operands, self.layer[index], self.constants.get(index), self.sources.get(index))

    def number(self, value: Constant) -> Ref:
        """The reference to a constant."""
        magnitude = -value if value < 0 else value
        key = constants.key_of(magnitude)
        ref = self._numbers.get(key)
        if ref is None:
            ref = self._numbers[key] = self._append(Op.CONSTANT, (), Layer.CONSTANT)
            self.constants[node_of(ref)] = magnitude
        return ref if magnitude is value else negated(ref)

    def input(self, kind: str, index: int) -> Ref:
        """An argument or a run-time parameter."""
        source = InputSource(kind, index)
        ref = self._inputs.get(source)
        if ref is None:
            layer = Layer.HOISTED if kind == PARAMETER else Layer.BODY
            ref = self._inputs[source] = self._append(Op.INPUT, (), layer)
            self.sources[node_of(ref)] = source
        return ref

    def constant_of(self, ref: Ref) -> Constant | None:
        """The number behind a reference, with its sign; None where the node is no constant."""
        value = self.constants.get(ref >> 1)
        return value if value is None or not ref & 1 else -value

    def add(self, a: Ref, b: Ref) -> Ref:
        """A sum."""
        if a == ZERO:
            return b
        if b == ZERO:
            return a
        first, second = a >> 1, b >> 1
        if first == second:
            return self.multiply(self.number(Fraction(2)), a) if a == b else ZERO
        if self.layer[first] == self.layer[second] == Layer.CONSTANT:
            return self.number(constants.add(self.constant_of(a), self.constant_of(b)))
        if first > second:
            a, b, first, second = b, a, second, first
        return signed(self.intern(Op.SUBTRACT if (a ^ b) & 1 else Op.ADD, first, second), is_negative(a))

    def subtract(self, a: Ref, b: Ref) -> Ref:
        """A difference."""
        return self.add(a, negated(b))

    def multiply(self, a: Ref, b: Ref) -> Ref:
        """A product; of constant factors in a row one is left."""
        if a == ZERO or b == ZERO:
            return ZERO
        if a in UNITS:
            return signed(b, a == MINUS_ONE)
        if b in UNITS:
            return signed(a, b == MINUS_ONE)
        negative = (a ^ b) & 1 == 1
        factor, index = a >> 1, b >> 1
        if self.layer[factor] != Layer.CONSTANT:
            factor, index = index, factor
        if self.layer[factor] != Layer.CONSTANT:
            return signed(self.intern(Op.MULTIPLY, min(factor, index), max(factor, index)), negative)
        if index in self.constants:
            return signed(self.number(constants.multiply(self.constants[factor], self.constants[index])), negative)
        if self.op[index] is Op.MULTIPLY and self.operands[index][0] in self.constants:
            inner, rest = self.operands[index]
            number = self.number(constants.multiply(self.constants[factor], self.constants[inner]))
            return signed(self.multiply(number, ref_to(rest)), negative)
        return signed(self.intern(Op.MULTIPLY, factor, index), negative)

    def divide(self, a: Ref, b: Ref) -> Ref:
        """A quotient; what depends on the arguments may be divided by zero, as floats may."""
        divisor = self.constant_of(b)
        if divisor == 0 and self.layer[a >> 1] == Layer.BODY:
            return signed(self.intern(Op.DIVIDE, a >> 1, b >> 1), is_negative(a))
        if divisor is not None:
            return self.multiply(a, self.number(constants.reciprocal(divisor)))
        if a == ZERO:
            return ZERO
        negative = (a ^ b) & 1 == 1
        if a >> 1 == b >> 1:
            return signed(ONE, negative)
        return signed(self.intern(Op.DIVIDE, a >> 1, b >> 1), negative)

    def sine(self, a: Ref) -> Ref:
        """The sine."""
        if (value := self.constant_of(a)) is not None:
            return self.number(constants.sine(value))
        return signed(self.intern(Op.SINE, a >> 1), is_negative(a))

    def cosine(self, a: Ref) -> Ref:
        """The cosine."""
        if (value := self.constant_of(a)) is not None:
            return self.number(constants.cosine(value))
        return self.intern(Op.COSINE, a >> 1)

    def root(self, a: Ref) -> Ref:
        """The square root, which needs a change of sign of its own under it."""
        if (value := self.constant_of(a)) is not None:
            return self.number(constants.square_root(value))
        return self.intern(Op.ROOT, self.plain(a))

    def sign(self, a: Ref) -> Ref:
        """The sign of a value."""
        if (value := self.constant_of(a)) is not None:
            return self.number(Fraction((value > 0) - (value < 0)))
        return signed(self.intern(Op.SIGN, a >> 1), is_negative(a))

    def arctangent(self, y: Ref, x: Ref) -> Ref:
        """atan2(y, x), in [-pi, pi] [rad], odd in y."""
        up, right = self.constant_of(y), self.constant_of(x)
        if up is not None and right is not None:
            return self.number(constants.arctangent(up, right))
        return signed(self.intern(Op.ARCTANGENT, y >> 1, self.plain(x)), is_negative(y))

    def absolute(self, a: Ref) -> Ref:
        """The absolute value."""
        if (value := self.constant_of(a)) is not None:
            return self.number(abs(value))
        index = a >> 1
        return ref_to(index) if self.op[index] in (Op.ABSOLUTE, Op.ROOT) else self.intern(Op.ABSOLUTE, index)

    def plain(self, a: Ref) -> int:
        """The node of a value for operations that no sign passes through; a negative one is negated first."""
        if not is_negative(a):
            return a >> 1
        value = self.constant_of(a)
        if value is None:
            return node_of(self.intern(Op.NEGATE, a >> 1))
        key = constants.key_of(value)
        if key not in self._numbers:
            self._numbers[key] = self._append(Op.CONSTANT, (), Layer.CONSTANT)
            self.constants[node_of(self._numbers[key])] = value
        return node_of(self._numbers[key])

    def intern(self, op: Op, *operands: int) -> Ref:
        """An operation on nodes, made once; nothing is folded."""
        key = (op, operands)
        ref = self._nodes.get(key)
        if ref is None:
            ref = self._nodes[key] = self._append(op, operands, max([self.layer[i] for i in operands]))
        return ref

    def _append(self, op: Op, operands: tuple[int, ...], layer: Layer) -> Ref:
        self.op.append(op)
        self.operands.append(operands)
        self.layer.append(layer)
        return ref_to(len(self.op) - 1)

    # -- comparisons, cases and choices: what stands for an *if* in programs without branches

    def less(self, a: Ref, b: Ref) -> Ref:
        """A comparison."""
        left, right = self.constant_of(a), self.constant_of(b)
        if left is not None and right is not None:
            return ONE if constants.less(left, right) else ZERO
        if a == b:
            return ZERO
        if is_negative(a) and (is_negative(b) or b == ZERO):
            a, b = negated(b), negated(a)
        elif a == ZERO and is_negative(b):
            a, b = negated(b), ZERO
        return self.intern(Op.LESS, self.plain(a), self.plain(b))

    def opposite(self, case: Ref) -> Ref:
        """The opposite of a case; that of the opposite is the case."""
        return ref_to(self.operands[case >> 1][1]) if self._is_opposite(case) else self.subtract(ONE, case)

    def is_case(self, a: Ref) -> bool:
        """Whether a value is 1 or 0 by the way in which it is written: a comparison, or *and*, *or*, *not* of such."""
        if a in (ZERO, ONE):
            return True
        if is_negative(a):
            return False
        op, operands = self.op[a >> 1], self.operands[a >> 1]
        if op in (Op.MULTIPLY, Op.MAXIMUM, Op.MINIMUM):
            return all(self.is_case(ref_to(k)) for k in operands)
        return op is Op.LESS or (self._is_opposite(a) and self.is_case(ref_to(operands[1])))

    def _is_opposite(self, case: Ref) -> bool:
        return self.op[case >> 1] is Op.SUBTRACT and self.operands[case >> 1][0] == node_of(ONE)

    def select(self, case: Ref, a: Ref, b: Ref) -> Ref:
        """One of two values; the other one may be anything."""
        known = self.constant_of(case)
        if known is not None or a == b:
            return b if known == 0 else a
        index = case >> 1
        if self._is_opposite(case):
            return self.select(self.opposite(case), b, a)
        if a == ONE and b == ZERO:
            return case
        negative = is_negative(a if self.layer[b >> 1] is Layer.CONSTANT and a != ZERO else b)
        if negative:  # choices between opposites are opposite
            a, b = negated(a), negated(b)
        return signed(self.intern(Op.SELECT, index, self.plain(a), self.plain(b)), negative)

    def is_nowhere_negative(self, a: Ref) -> bool:
        """Whether a value is at least 0 by the way in which it is written: squares, roots, their sums and the like."""
        stack = [a]
        while stack:
            ref = stack.pop()
            op, operands = self.op[ref >> 1], self.operands[ref >> 1]
            is_square = op is Op.MULTIPLY and operands[0] == operands[1]
            if is_negative(ref) or (op is Op.CONSTANT and self.constants[ref >> 1] < 0):
                return False
            if op in (Op.ADD, Op.MULTIPLY) and not is_square:
                stack += map(ref_to, operands)
            elif not is_square and op not in (Op.CONSTANT, Op.ROOT, Op.ABSOLUTE, Op.LESS):
                return False
        return True

    def extreme(self, op: Op, a: Ref, b: Ref) -> Ref:
        """The larger or the smaller of two values."""
        left, right = self.constant_of(a), self.constant_of(b)
        if left is not None and right is not None:
            return b if constants.less(left, right) == (op is Op.MAXIMUM) else a
        if a == b:
            return a
        for one, other in ((a, b), (b, a)):
            if one in (ZERO, ONE) and self.is_case(other):
                return other if (one == ZERO) == (op is Op.MAXIMUM) else one
        if op is Op.MAXIMUM and ZERO in (a, b) and self.is_nowhere_negative(a if b == ZERO else b):
            return a if b == ZERO else b
        negative = (is_negative(a) or a == ZERO) and (is_negative(b) or b == ZERO)
        first, second = sorted(self.plain(negated(ref) if negative else ref) for ref in (a, b))
        dual = Op.MINIMUM if op is Op.MAXIMUM else Op.MAXIMUM
        return signed(self.intern(dual if negative else op, first, second), negative)

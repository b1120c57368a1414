"""The interned graph from which tapes are cut, and its values with Python's operators, the scalars of recursions.

Building a value that exists already returns it. A value is referred to by a node and a sign (`Ref`): -x and x are one
node, products and quotients pass signs on, and a sum of two negatives is a negative sum. Commutative operands are in
the order of their creation; numbering depends on nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import NewType

from derive.algebra import constants
from derive.algebra.constants import Constant, Key
from derive.programs.tape.tape import PARAMETER, Layer, Node, Op, Source

Ref = NewType("Ref", int)
"""A node of a graph with a sign: twice the node's index, one more for its negative. Zero has no negative.

A whole number, because millions are made and compared. What the bits mean is known to this module alone: elsewhere a
reference is taken apart by `node_of` and `is_negative`, and made by `ref_to`, `negated` and `signed`.
"""

ZERO = Ref(0)
ONE = Ref(2)
MINUS_ONE = Ref(3)
UNITS = (ONE, MINUS_ONE)
"""Factors that cost no multiplication."""


def ref_to(node: int) -> Ref:
    """The reference to a node.

    Args:
        node: Its index.

    Returns:
        The positive one.
    """
    return Ref(node << 1)


def node_of(ref: Ref) -> int:
    """The node behind a reference.

    Returns:
        The node's index.
    """
    return ref >> 1


def is_negative(ref: Ref) -> bool:
    """Whether a reference is to minus its node.

    Returns:
        True for -x, False for x and for zero.
    """
    return ref & 1 == 1


def negated(ref: Ref) -> Ref:
    """Minus a value.

    Args:
        ref: A reference to x.

    Returns:
        The reference to -x; for zero, zero.
    """
    return Ref(ref ^ 1) if ref else ref


def signed(ref: Ref, negative: bool) -> Ref:
    """A value or minus it.

    Args:
        ref: A reference to x.
        negative: Whether -x is wanted.

    Returns:
        The reference to x or -x.
    """
    return negated(ref) if negative else ref


class Graph:
    """Nodes in the order of their creation; constants are folded, equal operations are made once.

    Attributes:
        op: What makes each node.
        operands: Indices of earlier nodes.
        layer: On what each node depends.
        constants: The numbers of constant nodes.
        sources: Where input nodes come from.
        sums: Values added before, by their references; `differences` and `products` likewise. A recursion that is
            traced many times with small changes finds most of its operations here.
    """

    def __init__(self) -> None:
        self.op: list[Op] = []
        self.operands: list[tuple[int, ...]] = []
        self.layer: list[Layer] = []
        self.constants: dict[int, Constant] = {}
        self.sources: dict[int, Source] = {}
        self.sums: dict[tuple[Ref, Ref], Value] = {}
        self.differences: dict[tuple[Ref, Ref], Value] = {}
        self.products: dict[tuple[Ref, Ref], Value] = {}
        self._nodes: dict[tuple[Op, tuple[int, ...]], Ref] = {}
        self._numbers: dict[Key, Ref] = {}
        self._inputs: dict[Source, Ref] = {}
        self.number(Fraction(0))
        self.number(Fraction(1))

    def __len__(self) -> int:
        return len(self.op)

    def node(self, index: int, number: Mapping[int, int]) -> Node:
        """A node as it stands in a tape.

        Args:
            index: Its index here.
            number: The indices of its operands in the tape.

        Returns:
            The node.
        """
        operands = tuple([number[k] for k in self.operands[index]])
        return Node(self.op[index], operands, self.layer[index], self.constants.get(index), self.sources.get(index))

    def number(self, value: Constant) -> Ref:
        """The reference to a constant.

        Args:
            value: Exact, or to 256 bits.
        """
        magnitude = -value if value < 0 else value
        key = constants.key_of(magnitude)
        ref = self._numbers.get(key)
        if ref is None:
            ref = self._numbers[key] = self._append(Op.CONSTANT, (), Layer.CONSTANT)
            self.constants[node_of(ref)] = magnitude
        return ref if magnitude is value else negated(ref)

    def input(self, kind: str, index: int) -> Ref:
        """An argument or a run-time parameter.

        Args:
            kind: `PARAMETER`, or the name of an argument.
            index: Place in it, from 0.

        Returns:
            Its reference.
        """
        source = Source(kind, index)
        ref = self._inputs.get(source)
        if ref is None:
            layer = Layer.HOISTED if kind == PARAMETER else Layer.BODY
            ref = self._inputs[source] = self._append(Op.INPUT, (), layer)
            self.sources[node_of(ref)] = source
        return ref

    def constant_of(self, ref: Ref) -> Constant | None:
        """The number behind a reference.

        Args:
            ref: Any reference.

        Returns:
            The number with its sign; None where the node is no constant.
        """
        value = self.constants.get(ref >> 1)
        return value if value is None or not ref & 1 else -value

    def add(self, a: Ref, b: Ref) -> Ref:
        """A sum.

        Args:
            a: First summand.
            b: Second summand.

        Returns:
            a + b.
        """
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
        return signed(self._intern(Op.SUBTRACT if (a ^ b) & 1 else Op.ADD, first, second), is_negative(a))

    def subtract(self, a: Ref, b: Ref) -> Ref:
        """A difference.

        Args:
            a: From which b is subtracted.
            b: The subtrahend.

        Returns:
            a - b.
        """
        return self.add(a, negated(b))

    def multiply(self, a: Ref, b: Ref) -> Ref:
        """A product; of constant factors in a row one is left.

        Args:
            a: First factor.
            b: Second factor.

        Returns:
            a times b.
        """
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
            return signed(self._intern(Op.MULTIPLY, min(factor, index), max(factor, index)), negative)
        if index in self.constants:
            return signed(self.number(constants.multiply(self.constants[factor], self.constants[index])), negative)
        if self.op[index] is Op.MULTIPLY and self.operands[index][0] in self.constants:
            inner, rest = self.operands[index]
            number = self.number(constants.multiply(self.constants[factor], self.constants[inner]))
            return signed(self.multiply(number, ref_to(rest)), negative)
        return signed(self._intern(Op.MULTIPLY, factor, index), negative)

    def divide(self, a: Ref, b: Ref) -> Ref:
        """A quotient; what depends on the arguments may be divided by zero, as floats may.

        Args:
            a: The dividend.
            b: The divisor.

        Returns:
            a over b.

        Raises:
            QuantityError: b is the constant zero and a does not depend on the arguments, as in a cell.
        """
        divisor = self.constant_of(b)
        if divisor == 0 and self.layer[a >> 1] == Layer.BODY:
            return signed(self._intern(Op.DIVIDE, a >> 1, b >> 1), is_negative(a))
        if divisor is not None:
            return self.multiply(a, self.number(constants.reciprocal(divisor)))
        if a == ZERO:
            return ZERO
        negative = (a ^ b) & 1 == 1
        if a >> 1 == b >> 1:
            return signed(ONE, negative)
        return signed(self._intern(Op.DIVIDE, a >> 1, b >> 1), negative)

    def sine(self, a: Ref) -> Ref:
        """The sine.

        Args:
            a: An angle [rad].

        Returns:
            sin(a).
        """
        value = self.constant_of(a)
        if value is not None:
            return self.number(constants.sine(value))
        return signed(self._intern(Op.SINE, a >> 1), is_negative(a))

    def cosine(self, a: Ref) -> Ref:
        """The cosine.

        Args:
            a: An angle [rad].

        Returns:
            cos(a).
        """
        value = self.constant_of(a)
        if value is not None:
            return self.number(constants.cosine(value))
        return self._intern(Op.COSINE, a >> 1)

    def root(self, a: Ref) -> Ref:
        """The square root, which needs a change of sign of its own under it.

        Args:
            a: What it is taken of.

        Returns:
            sqrt(a).

        Raises:
            QuantityError: a is a negative constant.
        """
        value = self.constant_of(a)
        if value is not None:
            return self.number(constants.square_root(value))
        return self._intern(Op.ROOT, self._plain(a))

    def sign(self, a: Ref) -> Ref:
        """The sign of a value.

        Returns:
            -1, 0 or 1.
        """
        value = self.constant_of(a)
        if value is not None:
            return self.number(Fraction((value > 0) - (value < 0)))
        return signed(self._intern(Op.SIGN, a >> 1), is_negative(a))

    def arctangent(self, y: Ref, x: Ref) -> Ref:
        """The angle of a point of the plane, odd in the ordinate.

        Args:
            y: Ordinate.
            x: Abscissa.

        Returns:
            atan2(y, x), in [-pi, pi] [rad].
        """
        up, right = self.constant_of(y), self.constant_of(x)
        if up is not None and right is not None:
            return self.number(constants.arctangent(up, right))
        return signed(self._intern(Op.ARCTANGENT, y >> 1, self._plain(x)), is_negative(y))

    def less(self, a: Ref, b: Ref) -> Ref:
        """A comparison.

        Args:
            a: A value.
            b: Another.

        Returns:
            1 where a < b, else 0.
        """
        left, right = self.constant_of(a), self.constant_of(b)
        if left is not None and right is not None:
            return ONE if constants.less(left, right) else ZERO
        if a == b:
            return ZERO
        if is_negative(a) and (is_negative(b) or b == ZERO):
            a, b = negated(b), negated(a)
        elif a == ZERO and is_negative(b):
            a, b = negated(b), ZERO
        return self._intern(Op.LESS, self._plain(a), self._plain(b))

    def opposite(self, case: Ref) -> Ref:
        """The opposite of a case; that of the opposite is the case.

        Args:
            case: 1 or 0.

        Returns:
            1 - case.
        """
        return ref_to(self.operands[case >> 1][1]) if self._is_opposite(case) else self.subtract(ONE, case)

    def is_case(self, a: Ref) -> bool:
        """Whether a value is 1 or 0 by the way in which it is written: a comparison, or *and*, *or*, *not* of such.

        Args:
            a: Any reference.

        Returns:
            False also where it is not known.
        """
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
        """One of two values; the other one may be anything.

        Args:
            case: 1 or 0.
            a: The value where it is 1.
            b: The value where it is 0.

        Returns:
            a or b.
        """
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
        return signed(self._intern(Op.SELECT, index, self._plain(a), self._plain(b)), negative)

    def maximum(self, a: Ref, b: Ref) -> Ref:
        """The larger of two values.

        Args:
            a: A value.
            b: Another.

        Returns:
            max(a, b).
        """
        return self._extreme(Op.MAXIMUM, Op.MINIMUM, a, b)

    def minimum(self, a: Ref, b: Ref) -> Ref:
        """The smaller of two values.

        Args:
            a: A value.
            b: Another.

        Returns:
            min(a, b).
        """
        return self._extreme(Op.MINIMUM, Op.MAXIMUM, a, b)

    def absolute(self, a: Ref) -> Ref:
        """The absolute value.

        Args:
            a: A value.

        Returns:
            abs(a).
        """
        value = self.constant_of(a)
        if value is not None:
            return self.number(abs(value))
        index = a >> 1
        return ref_to(index) if self.op[index] in (Op.ABSOLUTE, Op.ROOT) else self._intern(Op.ABSOLUTE, index)

    def is_nowhere_negative(self, a: Ref) -> bool:
        """Whether a value is at least 0 by the way in which it is written: squares, roots, their sums and the like.

        Args:
            a: Any reference.

        Returns:
            False also where it is not known.
        """
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

    def apply(self, op: Op, operands: Sequence[Ref]) -> Ref:
        """The operation by its kind, folded as if written.

        Args:
            op: What is done, no leaf.
            operands: To what.

        Returns:
            The result.
        """
        return _METHODS[op](self, *operands)

    def _extreme(self, op: Op, opposite: Op, a: Ref, b: Ref) -> Ref:
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
        first, second = sorted(self._plain(negated(ref) if negative else ref) for ref in (a, b))
        return signed(self._intern(opposite if negative else op, first, second), negative)

    def _plain(self, a: Ref) -> int:
        """The node of a value, a change of sign where it has one."""
        if not is_negative(a):
            return a >> 1
        value = self.constant_of(a)
        if value is None:
            return node_of(self._intern(Op.NEGATE, a >> 1))
        key = constants.key_of(value)
        if key not in self._numbers:
            self._numbers[key] = self._append(Op.CONSTANT, (), Layer.CONSTANT)
            self.constants[node_of(self._numbers[key])] = value
        return node_of(self._numbers[key])

    def _intern(self, op: Op, *operands: int) -> Ref:
        """An operation on nodes; it is known with its operands in this order."""
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


_METHODS: dict[Op, Callable[..., Ref]] = {
    Op.ADD: Graph.add,
    Op.SUBTRACT: Graph.subtract,
    Op.MULTIPLY: Graph.multiply,
    Op.DIVIDE: Graph.divide,
    Op.NEGATE: lambda graph, a: negated(a),
    Op.SINE: Graph.sine,
    Op.COSINE: Graph.cosine,
    Op.ROOT: Graph.root,
    Op.SIGN: Graph.sign,
    Op.ARCTANGENT: Graph.arctangent,
    Op.LESS: Graph.less,
    Op.SELECT: Graph.select,
    Op.MAXIMUM: Graph.maximum,
    Op.MINIMUM: Graph.minimum,
    Op.ABSOLUTE: Graph.absolute,
}


class Value:
    """A reference into a graph with Python's operators; immutable: the scalar with which recursions are traced.

    Args:
        graph: Where the value lives.
        ref: The value.
    """

    __slots__ = ("graph", "ref")

    def __init__(self, graph: Graph, ref: Ref) -> None:
        self.graph = graph
        self.ref = ref

    def __add__(self, other: Value | int | Fraction, /) -> Value:
        graph = self.graph
        pair = self.ref, other.ref if isinstance(other, Value) else graph.number(Fraction(other))
        found = graph.sums.get(pair)
        if found is None:
            found = graph.sums[pair] = Value(graph, graph.add(*pair))
        return found

    __radd__ = __add__

    def __sub__(self, other: Value | int | Fraction, /) -> Value:
        graph = self.graph
        pair = self.ref, other.ref if isinstance(other, Value) else graph.number(Fraction(other))
        found = graph.differences.get(pair)
        if found is None:
            found = graph.differences[pair] = Value(graph, graph.subtract(*pair))
        return found

    def __rsub__(self, other: Value | int | Fraction, /) -> Value:
        return Value(self.graph, self.graph.subtract(self._other(other), self.ref))

    def __mul__(self, other: Value | int | Fraction, /) -> Value:
        graph = self.graph
        pair = self.ref, other.ref if isinstance(other, Value) else graph.number(Fraction(other))
        found = graph.products.get(pair)
        if found is None:
            found = graph.products[pair] = Value(graph, graph.multiply(*pair))
        return found

    __rmul__ = __mul__

    def __truediv__(self, other: Value | int | Fraction, /) -> Value:
        return Value(self.graph, self.graph.divide(self.ref, self._other(other)))

    def __rtruediv__(self, other: Value | int | Fraction, /) -> Value:
        return Value(self.graph, self.graph.divide(self._other(other), self.ref))

    def __neg__(self) -> Value:
        return Value(self.graph, negated(self.ref))

    def __pow__(self, exponent: int, /) -> Value:
        """Integer powers by repeated squaring; a negative one divides."""
        if exponent < 0:
            return 1 / self ** (-exponent)
        result, square = Value(self.graph, ONE), self
        while exponent:
            if exponent & 1:
                result = result * square
            exponent >>= 1
            if exponent:
                square = square * square
        return result

    def sin(self) -> Value:
        """The sine of an angle [rad]."""
        return Value(self.graph, self.graph.sine(self.ref))

    def cos(self) -> Value:
        """The cosine of an angle [rad]."""
        return Value(self.graph, self.graph.cosine(self.ref))

    def sqrt(self) -> Value:
        """The square root."""
        return Value(self.graph, self.graph.root(self.ref))

    def sign(self) -> Value:
        """-1, 0 or 1."""
        return Value(self.graph, self.graph.sign(self.ref))

    def arctangent(self, x: Value | int) -> Value:
        """The angle of the point whose ordinate this is.

        Args:
            x: The abscissa.

        Returns:
            atan2 of this and x [rad].
        """
        return Value(self.graph, self.graph.arctangent(self.ref, self._other(x)))

    def less(self, other: Value | int | Fraction) -> Value:
        """A comparison.

        Args:
            other: Another value.

        Returns:
            1 where this is less than it, else 0.
        """
        return Value(self.graph, self.graph.less(self.ref, self._other(other)))

    def select(self, a: Value | int | Fraction, b: Value | int | Fraction) -> Value:
        """One of two values, this being the case.

        Args:
            a: The value where this is 1.
            b: The value where this is 0.

        Returns:
            a or b.
        """
        return Value(self.graph, self.graph.select(self.ref, self._other(a), self._other(b)))

    def opposite(self) -> Value:
        """0 where this is 1, 1 where it is 0."""
        return Value(self.graph, self.graph.opposite(self.ref))

    def maximum(self, other: Value | int | Fraction) -> Value:
        """The larger of two values.

        Args:
            other: The second.

        Returns:
            Their maximum.
        """
        return Value(self.graph, self.graph.maximum(self.ref, self._other(other)))

    def minimum(self, other: Value | int | Fraction) -> Value:
        """The smaller of two values.

        Args:
            other: The second.

        Returns:
            Their minimum.
        """
        return Value(self.graph, self.graph.minimum(self.ref, self._other(other)))

    @property
    def depends_on_arguments(self) -> bool:
        """Whether it is computed anew in every evaluation."""
        return self.graph.layer[self.ref >> 1] is Layer.BODY

    def __abs__(self) -> Value:
        return Value(self.graph, self.graph.absolute(self.ref))

    def __repr__(self) -> str:
        """``v7``, or ``-v7``."""
        return f"{'-' if is_negative(self.ref) else ''}v{node_of(self.ref)}"

    def _other(self, other: Value | int | Fraction) -> Ref:
        return other.ref if isinstance(other, Value) else self.graph.number(Fraction(other))

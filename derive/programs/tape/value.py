"""Values of a graph with Python's operators: the scalars with which recursions are traced."""

from __future__ import annotations

from fractions import Fraction

from derive.programs.tape.graph import ONE, Graph, Ref, is_negative, negated, node_of
from derive.programs.tape.tape import Op


class Value:
    """A reference into a graph with Python's operators; immutable."""

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
        """atan2 of this and x [rad]."""
        return Value(self.graph, self.graph.arctangent(self.ref, self._other(x)))

    def less(self, other: Value | int | Fraction) -> Value:
        """A comparison."""
        return Value(self.graph, self.graph.less(self.ref, self._other(other)))

    def select(self, a: Value | int | Fraction, b: Value | int | Fraction) -> Value:
        """One of two values, this being the case."""
        return Value(self.graph, self.graph.select(self.ref, self._other(a), self._other(b)))

    def opposite(self) -> Value:
        """0 where this is 1, 1 where it is 0."""
        return Value(self.graph, self.graph.opposite(self.ref))

    def maximum(self, other: Value | int | Fraction) -> Value:
        """The larger of two values."""
        return Value(self.graph, self.graph.extreme(Op.MAXIMUM, self.ref, self._other(other)))

    def minimum(self, other: Value | int | Fraction) -> Value:
        """The smaller of two values."""
        return Value(self.graph, self.graph.extreme(Op.MINIMUM, self.ref, self._other(other)))

    def __abs__(self) -> Value:
        return Value(self.graph, self.graph.absolute(self.ref))

    def __repr__(self) -> str:
        """``v7``, or ``-v7``."""
        return f"{'-' if is_negative(self.ref) else ''}v{node_of(self.ref)}"

    def _other(self, other: Value | int | Fraction) -> Ref:
        return other.ref if isinstance(other, Value) else self.graph.number(Fraction(other))

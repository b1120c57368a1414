"""A tape value with Python's operators: the scalar type with which recursions are traced."""

from __future__ import annotations

from fractions import Fraction

from derive.programs.tape.graph import Graph, Ref


class Value:
    """A reference into a graph; immutable."""

    __slots__ = ("graph", "ref")

    def __init__(self, graph: Graph, ref: Ref) -> None:
        """Refer to ``ref`` of ``graph``."""
        self.graph = graph
        self.ref = ref

    def __add__(self, other: Value | int | Fraction, /) -> Value:
        """Self + other."""
        graph = self.graph
        return Value(graph, graph.add(self.ref, other.ref if isinstance(other, Value) else _number(graph, other)))

    __radd__ = __add__

    def __sub__(self, other: Value | int | Fraction, /) -> Value:
        """Self - other."""
        graph = self.graph
        return Value(graph, graph.subtract(self.ref, other.ref if isinstance(other, Value) else _number(graph, other)))

    def __rsub__(self, other: Value | int | Fraction, /) -> Value:
        """Other - self."""
        return Value(self.graph, self.graph.subtract(_ref(self.graph, other), self.ref))

    def __mul__(self, other: Value | int | Fraction, /) -> Value:
        """Self times other."""
        graph = self.graph
        return Value(graph, graph.multiply(self.ref, other.ref if isinstance(other, Value) else _number(graph, other)))

    __rmul__ = __mul__

    def __truediv__(self, other: Value | int | Fraction, /) -> Value:
        """Self over other."""
        return Value(self.graph, self.graph.divide(self.ref, _ref(self.graph, other)))

    def __rtruediv__(self, other: Value | int | Fraction, /) -> Value:
        """Other over self."""
        return Value(self.graph, self.graph.divide(_ref(self.graph, other), self.ref))

    def __neg__(self) -> Value:
        """-self."""
        return Value(self.graph, self.graph.negate(self.ref))

    def __pow__(self, exponent: int, /) -> Value:
        """Integer powers by repeated squaring; a negative one divides."""
        if exponent < 0:
            return 1 / self ** (-exponent)
        result, square = Value(self.graph, self.graph.number(Fraction(1))), self
        while exponent:
            if exponent & 1:
                result = result * square
            exponent >>= 1
            if exponent:
                square = square * square
        return result

    def sin(self) -> Value:
        """The sine, radians."""
        return Value(self.graph, self.graph.sine(self.ref))

    def cos(self) -> Value:
        """The cosine, radians."""
        return Value(self.graph, self.graph.cosine(self.ref))

    def sqrt(self) -> Value:
        """The square root."""
        return Value(self.graph, self.graph.root(self.ref))

    def sign(self) -> Value:
        """-1, 0 or 1."""
        return Value(self.graph, self.graph.sign(self.ref))

    def __repr__(self) -> str:
        """``v7``, or ``-v7``."""
        return f"{'-' if self.ref & 1 else ''}v{self.ref >> 1}"


def _ref(graph: Graph, other: Value | int | Fraction) -> Ref:
    return other.ref if isinstance(other, Value) else _number(graph, other)


def _number(graph: Graph, number: int | Fraction) -> Ref:
    return graph.number(Fraction(number))

"""A tape value with Python's operators: the scalar type with which recursions are traced."""

from __future__ import annotations

from fractions import Fraction
from typing import Self

from derive.algebra.tape_graph import Graph, Ref


class Value:
    """A reference into a graph; immutable."""

    __slots__ = ("graph", "ref")

    def __init__(self, graph: Graph, ref: Ref) -> None:
        """Refer to ``ref`` of ``graph``."""
        self.graph = graph
        self.ref = ref

    def __add__(self, other: Value | int | Fraction, /) -> Self:
        """Self + other."""
        return self._make(self.graph.add(self.ref, self._ref(other)))

    __radd__ = __add__

    def __sub__(self, other: Value | int | Fraction, /) -> Self:
        """Self - other."""
        return self._make(self.graph.subtract(self.ref, self._ref(other)))

    def __rsub__(self, other: Value | int | Fraction, /) -> Self:
        """Other - self."""
        return self._make(self.graph.subtract(self._ref(other), self.ref))

    def __mul__(self, other: Value | int | Fraction, /) -> Self:
        """Self times other."""
        return self._make(self.graph.multiply(self.ref, self._ref(other)))

    __rmul__ = __mul__

    def __truediv__(self, other: Value | int | Fraction, /) -> Self:
        """Self over other."""
        return self._make(self.graph.divide(self.ref, self._ref(other)))

    def __rtruediv__(self, other: Value | int | Fraction, /) -> Self:
        """Other over self."""
        return self._make(self.graph.divide(self._ref(other), self.ref))

    def __neg__(self) -> Self:
        """-self."""
        return self._make(self.graph.negate(self.ref))

    def __pow__(self, exponent: int, /) -> Self:
        """Integer powers by repeated squaring; a negative one divides."""
        if exponent < 0:
            return 1 / self ** (-exponent)
        result, square = self._make(self.graph.number(Fraction(1))), self
        while exponent:
            if exponent & 1:
                result = result * square
            exponent >>= 1
            if exponent:
                square = square * square
        return result

    def sin(self) -> Self:
        """The sine, radians."""
        return self._make(self.graph.sine(self.ref))

    def cos(self) -> Self:
        """The cosine, radians."""
        return self._make(self.graph.cosine(self.ref))

    def sqrt(self) -> Self:
        """The square root."""
        return self._make(self.graph.root(self.ref))

    def sign(self) -> Self:
        """-1, 0 or 1."""
        return self._make(self.graph.sign(self.ref))

    def __repr__(self) -> str:
        """``v7``, or ``-v7``."""
        return f"{'-' if self.ref & 1 else ''}v{self.ref >> 1}"

    def _make(self, ref: Ref) -> Self:
        return type(self)(self.graph, ref)

    def _ref(self, other: Value | int | Fraction) -> Ref:
        if isinstance(other, Value):
            return other.ref
        return self.graph.number(Fraction(other))

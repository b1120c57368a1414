"""On what values depend and how large they are: what a difference must not lose to rounding.

v = x - y may be exact algebra and still ruin v, if x and y hold something that cancels: a mass that has nothing to do
with v, or a length a thousand times larger. So a difference is allowed only between values that depend on nothing but
what v depends on and that are not much larger than v at some random points.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random

from derive.algebra.tape import FUNCTION_NAMES, Op, Source
from derive.algebra.tape_constant import Constant
from derive.algebra.tape_graph import Graph, Ref
from derive.algebra.tape_network import Network, Opaque, Operand, Polynomial

_POINTS = 3
_RATIO = 64.0
"""How much larger than a difference its operands may be: six bits are lost at most."""

_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "sin": math.sin,
    "cos": math.cos,
    "sqrt": lambda x: math.sqrt(abs(x)),
    "sign": lambda x: math.copysign(1.0, x),
}

Support = int
"""A bit for each input and parameter."""

Values = tuple[float, ...]


class Scale:
    """Supports and sizes of the variables of a network as it stands.

    Args:
        network: The network.
    """

    def __init__(self, network: Network) -> None:
        self._network = network
        self._graph = network.coefficients.graph
        self._bits: dict[object, int] = {}
        self._coefficients: dict[int, tuple[Support, Values]] = {}
        self._random = Random(0)
        self._variables: dict[int, tuple[Support, Values]] = {}
        for variable in network.order():
            self._variables[variable] = self._variable(variable)

    def allows(self, variable: int, definition: Polynomial) -> bool:
        """Whether a sum may define a variable without harm to its accuracy."""
        if any(v not in self._variables for monomial in definition for v in monomial):
            return False
        support, sizes = self._variables[variable]
        for monomial, coefficient in definition.items():
            part, values = self._term(monomial, coefficient)
            if part & ~support:
                return False
            if not all(abs(value) <= _RATIO * abs(size) for value, size in zip(values, sizes, strict=True)):
                return False
        return True

    def _variable(self, variable: int) -> tuple[Support, Values]:
        definition = self._network.definition[variable]
        if isinstance(definition, Opaque):
            if definition.op is None:
                return self._input(("argument", definition.source))
            return _applied(definition.op, [self._operand(operand) for operand in definition.operands])
        terms = [self._term(monomial, coefficient) for monomial, coefficient in definition.items()]
        return _union(terms), tuple(map(sum, zip(*(values for _, values in terms), strict=True)))

    def _term(self, monomial: tuple[int, ...], coefficient: Ref) -> tuple[Support, Values]:
        parts = [self._coefficient(coefficient), *(self._variables[v] for v in monomial)]
        return _union(parts), tuple(map(math.prod, zip(*(values for _, values in parts), strict=True)))

    def _operand(self, operand: Operand) -> tuple[Support, Values]:
        return self._term(() if operand.variable is None else (operand.variable,), operand.coefficient)

    def _input(self, key: object) -> tuple[Support, Values]:
        bit = self._bits.setdefault(key, len(self._bits))
        return 1 << bit, tuple(self._random.uniform(0.5, 2.0) for _ in range(_POINTS))

    def _coefficient(self, ref: Ref) -> tuple[Support, Values]:
        found = self._coefficients.get(ref >> 1)
        if found is None:
            found = self._coefficients[ref >> 1] = self._evaluated(self._graph, ref >> 1)
        return (found[0], tuple(-value for value in found[1])) if ref & 1 else found

    def _evaluated(self, graph: Graph, index: int) -> tuple[Support, Values]:
        payload = graph.payload.get(index)
        if isinstance(payload, Source):
            return self._input((payload.kind, payload.index))
        if payload is not None:
            return 0, (_float(payload),) * _POINTS
        return _applied(graph.op[index], [self._coefficient(2 * k) for k in graph.operands[index]])


def _union(parts: list[tuple[Support, Values]]) -> Support:
    support = 0
    for part, _ in parts:
        support |= part
    return support


def _applied(op: Op, operands: list[tuple[Support, Values]]) -> tuple[Support, Values]:
    columns = zip(*(values for _, values in operands), strict=True)
    return _union(operands), tuple(_apply(op, *column) for column in columns)


def _apply(op: Op, a: float, b: float = 0.0) -> float:
    match op:
        case Op.ADD:
            return a + b
        case Op.SUBTRACT:
            return a - b
        case Op.MULTIPLY:
            return a * b
        case Op.DIVIDE:
            return a / b if b else math.nan
        case Op.NEGATE:
            return -a
    return _FUNCTIONS[FUNCTION_NAMES[op]](a)


def _float(value: Constant) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.nan

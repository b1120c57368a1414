"""Values written in terms of two others that exist, where their definition costs more than one operation.

Whether values agree is known from their residues, so identities count that no rewriting shows: the trace of an inertia
tensor is the same in every frame, the square of a cosine is one less the square of the sine.

On what values depend and how large they are: what a difference must not lose to rounding.

v = x - y may be exact algebra and still ruin v, if x and y hold something that cancels: a mass that has nothing to do
with v, or a length a thousand times larger. So a difference is allowed only between values that depend on nothing but
what v depends on and that are not much larger than v at some random points.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from random import Random

from derive.algebra.constants import Constant
from derive.programs.optimise.coefficients import PRIME
from derive.programs.optimise.network import Monomial, Network, Opaque, Operand, Polynomial
from derive.programs.tape.graph import ONE, Graph, Ref
from derive.programs.tape.tape import FUNCTION_NAMES, Op, Source

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


class Resubstitution:
    """Shorter definitions of the variables of a network as it stands.

    Args:
        network: The network; later changes of it are not known here.
    """

    def __init__(self, network: Network) -> None:
        self._network = network
        self._scale = Scale(network)
        self._values = [(v, network.residue[v]) for v in network.definition if v >= 0 and network.residue[v]]
        self._known = {r for residue in network.coefficients.residues() for r in (residue, PRIME - residue)}
        self._known.update(r for _, residue in self._values for r in (residue, PRIME - residue))
        self._inverses = [(v, pow(residue, -1, PRIME)) for v, residue in self._values]

    def candidates(self) -> list[int]:
        """Variables whose definition, with what it alone uses, costs more than one operation."""
        return [v for v, p in self._network.polynomials() if self._is_dear(p)]

    def _is_dear(self, polynomial: Polynomial) -> bool:
        network = self._network
        if network.cost_of(polynomial) > 1:
            return True
        return any(len(network.users[v]) == 1 and network.polynomial(v) for monomial in polynomial for v in monomial)

    def alternatives(self, variable: int) -> Iterator[Polynomial]:
        """Other definitions of a variable, each of one operation: sums, differences and products of two values."""
        network, known = self._network, self._known
        value = network.residue[variable]
        network.work += len(self._values) // 16
        plus = [v for v, residue in self._values if (value - residue) % PRIME in known]
        minus = [v for v, residue in self._values if (value + residue) % PRIME in known]
        times = [v for v, inverse in self._inverses if value * inverse % PRIME in known]
        for other, sign in [*((v, 0) for v in plus), *((v, 1) for v in minus)]:
            residue = network.residue[other]
            rest = network.find((value + residue if sign else value - residue) % PRIME)
            if rest is not None and other != variable != rest.variable != other:
                yield {(other,): ONE ^ sign, _monomial(rest): rest.coefficient}
        for other in times:
            rest = network.find(value * pow(network.residue[other], -1, PRIME) % PRIME)
            if rest is not None and other != variable != rest.variable:
                yield {tuple(sorted((other, *_monomial(rest)))): rest.coefficient}

    def fits(self, variable: int, definition: Polynomial) -> bool:
        """Whether a definition is new, of variables that are in use and do not need this one, and is as accurate."""
        network = self._network
        if network.polynomial(variable) == definition:
            return False
        parts = [v for monomial in definition for v in monomial]
        if not all(v in network.definition and not network.needs(v, variable) for v in parts):
            return False
        return self._scale.allows(variable, definition)


def _monomial(operand: Operand) -> Monomial:
    return () if operand.variable is None else (operand.variable,)

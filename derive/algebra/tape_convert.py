"""From an interned graph to a network of polynomials and back."""

from __future__ import annotations

from collections.abc import Sequence

from derive.algebra.tape import LEAVES, Layer, Op
from derive.algebra.tape_build import copy_leaf, reachable
from derive.algebra.tape_coefficients import Coefficients
from derive.algebra.tape_graph import ONE, ZERO, Graph, Ref
from derive.algebra.tape_network import ROOT, Monomial, Network, Opaque, Operand, Polynomial

_POLYNOMIAL = (Op.ADD, Op.SUBTRACT, Op.MULTIPLY)


def network_of(graph: Graph, outputs: Sequence[Ref]) -> Network:
    """The network of ``outputs``; what depends on parameters alone becomes coefficients."""
    coefficients = Coefficients(Graph())
    network = Network(coefficients)
    values: dict[int, Operand] = {}
    for i in reachable(graph, outputs):
        if graph.op[i] in LEAVES and graph.layer[i] == Layer.BODY:
            values[i] = Operand(network.create(Opaque(None, (), i)), ONE)
        elif graph.layer[i] < Layer.BODY:
            values[i] = Operand(None, _hoisted(graph, i, values, coefficients))
        else:
            values[i] = _body(graph, i, values, network)
    network.define(ROOT, Opaque(None, tuple(_signed(values[r >> 1], r & 1) for r in outputs)))
    network.settle()
    return network


def _hoisted(graph: Graph, i: int, values: dict[int, Operand], coefficients: Coefficients) -> Ref:
    if graph.op[i] in LEAVES:
        return coefficients.same(copy_leaf(graph, i, coefficients.graph))
    operands = (values[k].coefficient for k in graph.operands[i])
    return coefficients.same(coefficients.graph.apply(graph.op[i], *operands))


def _body(graph: Graph, i: int, values: dict[int, Operand], network: Network) -> Operand:
    operands = [values[k] for k in graph.operands[i]]
    op = graph.op[i]
    if op not in _POLYNOMIAL:
        return Operand(network.create(Opaque(op, tuple(operands))), ONE)
    a, b = operands
    if op is Op.SUBTRACT:
        b = _signed(b, 1)
    result: Polynomial = {}
    if op is Op.MULTIPLY:
        coefficient = network.coefficients.multiply(a.coefficient, b.coefficient)
        monomial = tuple(sorted((*_monomial(a), *_monomial(b))))
        network.plus(result, monomial, coefficient)
    else:
        network.plus(result, _monomial(a), a.coefficient)
        network.plus(result, _monomial(b), b.coefficient)
    return Operand(network.create(result), ONE)


def _monomial(operand: Operand) -> Monomial:
    return () if operand.variable is None else (operand.variable,)


def _signed(operand: Operand, negative: int) -> Operand:
    if operand.coefficient == ZERO:
        return operand
    return Operand(operand.variable, operand.coefficient ^ (negative & 1))


def graph_of(network: Network, old: Graph) -> tuple[Graph, tuple[Ref, ...]]:
    """The operations of a network in a graph, coefficients first."""
    return _Writer(network, old).run()


class _Writer:
    def __init__(self, network: Network, old: Graph) -> None:
        self.network = network
        self.old = old
        self.new = network.coefficients.graph
        self.refs: dict[int, Ref] = {}

    def run(self) -> tuple[Graph, tuple[Ref, ...]]:
        """The graph and the outputs in it."""
        for variable in self._order():
            self.refs[variable] = self._value(variable)
        root = self.network.definition[ROOT]
        assert isinstance(root, Opaque)
        return self.new, tuple(self._operand(operand) for operand in root.operands)

    def _order(self) -> list[int]:
        """Variables after those they need, depth first from the outputs."""
        order: list[int] = []
        done: set[int] = set()
        stack = [ROOT]
        while stack:
            variable = stack[-1]
            waiting = [k for k in self._needs(variable) if k not in done]
            if waiting:
                stack.extend(reversed(waiting))
                continue
            stack.pop()
            if variable not in done and variable != ROOT:
                done.add(variable)
                order.append(variable)
        return order

    def _needs(self, variable: int) -> list[int]:
        definition = self.network.definition[variable]
        if isinstance(definition, Opaque):
            return [o.variable for o in definition.operands if o.variable is not None]
        return list(dict.fromkeys(v for monomial in definition for v in monomial))

    def _operand(self, operand: Operand) -> Ref:
        if operand.variable is None:
            return operand.coefficient
        return self.refs[operand.variable] ^ (operand.coefficient & 1)

    def _value(self, variable: int) -> Ref:
        definition = self.network.definition[variable]
        if not isinstance(definition, Opaque):
            return self._polynomial(definition)
        if definition.op is None:
            return copy_leaf(self.old, definition.source, self.new)
        return self.new.apply(definition.op, *(self._operand(operand) for operand in definition.operands))

    def _polynomial(self, polynomial: Polynomial) -> Ref:
        terms = [self._term(m, k) for m, k in polynomial.items()]
        result = ZERO
        for ref in sorted(terms, key=lambda ref: (self.new.layer[ref >> 1], ref)):
            result = self.new.add(result, ref)
        return result

    def _term(self, monomial: Monomial, coefficient: Ref) -> Ref:
        result = coefficient
        for ref in sorted(self.refs[v] for v in monomial):
            result = self.new.multiply(result, ref)
        return result

"""From a network of polynomials back to an interned graph."""

from __future__ import annotations

from derive.algebra.tape_build import copy_leaf
from derive.algebra.tape_graph import ZERO, Graph, Ref
from derive.algebra.tape_network import ROOT, Monomial, Network, Opaque, Operand, Polynomial


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
        for variable in self.network.order():
            self.refs[variable] = self._value(variable)
        root = self.network.definition[ROOT]
        assert isinstance(root, Opaque)
        return self.new, tuple(self._operand(operand) for operand in root.operands)

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

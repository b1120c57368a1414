"""From an interned graph to a network of polynomials.

From a network of polynomials back to an interned graph.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from derive.programs.optimise.coefficients import Coefficients
from derive.programs.optimise.network import ROOT, Definition, Monomial, Network, Opaque, Operand, Polynomial
from derive.programs.tape.build import copy_leaf, reachable
from derive.programs.tape.graph import ONE, ZERO, Graph, Ref
from derive.programs.tape.tape import LEAVES, Layer, Op

_SUMS = (Op.ADD, Op.SUBTRACT)


def network_of(graph: Graph, outputs: Sequence[Ref], body: Layer = Layer.BODY) -> Network:
    """The network of ``outputs``.

    Sums in sums and products in products or sums, where the inner one serves nothing else, are taken as one.

    Args:
        graph: A graph.
        outputs: References into it.
        body: The layer from which values are variables; what is below becomes coefficients.
    """
    return _Reader(graph, outputs, body).run()


class _Reader:
    def __init__(self, graph: Graph, outputs: Sequence[Ref], body: Layer) -> None:
        self.old = graph
        self.body = body
        self.outputs = outputs
        self.order = reachable(graph, outputs)
        self.coefficients = Coefficients(Graph())
        self.network = Network(self.coefficients)
        self.values: dict[int, Operand] = {}
        self.uses: Counter[int] = Counter(ref >> 1 for ref in outputs)
        self.user: dict[int, Op] = {}
        for i in self.order:
            for k in graph.operands[i]:
                self.uses[k] += 1
                self.user[k] = graph.op[i]

    def run(self) -> Network:
        """The network."""
        for i in self.order:
            if not self._absorbed(i):
                self.values[i] = self._value(i)
        outputs = tuple(_signed(self.values[ref >> 1], ref & 1) for ref in self.outputs)
        self.network.define(ROOT, Opaque(None, outputs))
        self.network.settle()
        return self.network

    def _absorbed(self, i: int) -> bool:
        """Whether a sum or product is part of a larger one and of nothing else."""
        op, user = self.old.op[i], self.user.get(i)
        if self.uses[i] != 1 or user is None or self.old.layer[i] < self.body:
            return False
        return (op in _SUMS and user in _SUMS) or (op is Op.MULTIPLY and user in (*_SUMS, Op.MULTIPLY))

    def _value(self, i: int) -> Operand:
        op = self.old.op[i]
        if self.old.layer[i] < self.body:
            return Operand(None, self._coefficient(i))
        if op in LEAVES:
            return Operand(self.network.create(Opaque(None, (), i)), ONE)
        if op in _SUMS or op is Op.MULTIPLY:
            return self._variable(self._polynomial(i))
        return self._variable(Opaque(op, tuple(self.values[k] for k in self.old.operands[i])))

    def _variable(self, definition: Definition) -> Operand:
        """A new variable, unless the value is zero or known."""
        known = self.network.find(self.network.evaluate(definition))
        return known or Operand(self.network.create(definition), ONE)

    def _coefficient(self, i: int) -> Ref:
        if self.old.op[i] in LEAVES:
            return self.coefficients.same(copy_leaf(self.old, i, self.coefficients.graph))
        operands = (self.values[k].coefficient for k in self.old.operands[i])
        return self.coefficients.same(self.coefficients.graph.apply(self.old.op[i], *operands))

    def _polynomial(self, root: int) -> Polynomial:
        """A sum of products, or one product."""
        result: Polynomial = {}
        stack = [(False, root)]
        while stack:
            negative, i = stack.pop()
            if self.old.op[i] in _SUMS and (i == root or self._absorbed(i)):
                left, right = self.old.operands[i]
                stack.append((negative ^ (self.old.op[i] is Op.SUBTRACT), right))
                stack.append((negative, left))
            else:
                monomial, coefficient = self._term(i, i == root)
                if coefficient != ZERO:
                    self.network.plus(result, monomial, coefficient ^ negative)
        return result

    def _term(self, root: int, is_root: bool) -> tuple[Monomial, Ref]:
        factors: list[int] = []
        coefficient = ONE
        stack = [root]
        while stack:
            i = stack.pop()
            if self.old.op[i] is Op.MULTIPLY and ((i == root and is_root) or self._absorbed(i)):
                stack.extend(self.old.operands[i])
                continue
            operand = self.values[i]
            coefficient = self.coefficients.multiply(coefficient, operand.coefficient)
            if operand.variable is not None:
                factors.append(operand.variable)
        return tuple(sorted(factors)), coefficient


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

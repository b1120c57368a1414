"""From an interned graph to a network of polynomials."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from derive.algebra.tape import LEAVES, Layer, Op
from derive.algebra.tape_build import copy_leaf, reachable
from derive.algebra.tape_coefficients import Coefficients
from derive.algebra.tape_graph import ONE, ZERO, Graph, Ref
from derive.algebra.tape_network import ROOT, Definition, Monomial, Network, Opaque, Operand, Polynomial

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

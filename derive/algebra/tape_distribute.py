"""Constant factors taken into sums whose terms have constant factors already: k*(a*x + b*y) -> (k*a)*x + (k*b)*y.

That saves the outer product: k*a and k*b are numbers, or are computed once per set of parameters.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from derive.algebra.tape import LEAVES, Layer, Op
from derive.algebra.tape_build import copy_leaf, reachable
from derive.algebra.tape_graph import Graph, Ref

_SUMS = (Op.ADD, Op.SUBTRACT)


def distribute(graph: Graph, outputs: Sequence[Ref]) -> tuple[Graph, tuple[Ref, ...]]:
    """The same values, with constant factors inside sums where that is free."""
    return _Distribution(graph, outputs).run()


class _Distribution:
    def __init__(self, graph: Graph, outputs: Sequence[Ref]) -> None:
        self.old = graph
        self.new = Graph()
        self.outputs = outputs
        self.order = reachable(graph, outputs)
        self.uses = Counter(ref >> 1 for ref in outputs)
        self.uses.update(k for i in self.order for k in graph.operands[i])
        self.moved: dict[int, Ref] = {}

    def run(self) -> tuple[Graph, tuple[Ref, ...]]:
        """The new graph and the outputs in it."""
        for i in self.order:
            self.moved[i] = self._move(i)
        new = self.new
        return new, tuple(new.negate(self.moved[r >> 1]) if r & 1 else self.moved[r >> 1] for r in self.outputs)

    def _move(self, i: int) -> Ref:
        op, operands = self.old.op[i], self.old.operands[i]
        if op in LEAVES:
            return copy_leaf(self.old, i, self.new)
        if op is Op.MULTIPLY:
            for factor, other in (operands, operands[::-1]):
                if self._early(factor) and self.old.op[other] in _SUMS and self._takes(other):
                    return self._scaled(self.moved[factor], other)
        return self.new.apply(op, *(self.moved[k] for k in operands))

    def _early(self, i: int) -> bool:
        return self.old.layer[i] < Layer.BODY

    def _takes(self, root: int) -> bool:
        """Whether every term of a sum has a constant factor to merge with, and serves nothing else."""
        stack = [root]
        while stack:
            i = stack.pop()
            op, operands = self.old.op[i], self.old.operands[i]
            if self._early(i):
                continue
            if self.uses[i] != 1:
                return False
            if op in _SUMS:
                stack.extend(operands)
            elif op is not Op.MULTIPLY or not any(self._early(k) for k in operands):
                return False
        return True

    def _scaled(self, factor: Ref, i: int) -> Ref:
        """The factor times a sum that takes it; sums are as deep as they have terms, which is few."""
        op, operands, new = self.old.op[i], self.old.operands[i], self.new
        if self._early(i):
            return new.multiply(factor, self.moved[i])
        if op in _SUMS:
            return new.apply(op, *(self._scaled(factor, k) for k in operands))
        early, late = operands if self._early(operands[0]) else operands[::-1]
        return new.multiply(new.multiply(factor, self.moved[early]), self.moved[late])

"""Exact derivatives of graph values: every node once, in the graph that holds the values.

A derivative is made of nodes of the same graph, so it shares all that the values have computed already, and what does
not depend on the input costs nothing. The graph is differentiated as it stands; a graph that has been improved first
has fewer nodes to differentiate (`improved`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from derive.algebra.tape import LEAVES, Op
from derive.algebra.tape_build import copy_leaf, reachable
from derive.algebra.tape_graph import ZERO, Graph, Ref
from derive.algebra.tape_improve import improve
from derive.algebra.tape_value import Value


def derivative(values: Sequence[Value], rates: Mapping[Value, Value]) -> list[Value]:
    """d value / dt for given rates of inputs.

    Args:
        values: Of one graph.
        rates: For inputs of that graph, their rates of change; other inputs do not change.
    """
    if not values:
        return []
    graph = values[0].graph
    refs = [value.ref for value in values]
    tangents = {source.ref >> 1: rate.ref ^ (source.ref & 1) for source, rate in rates.items() if rate.ref != ZERO}
    for i in reachable(graph, refs):
        if i not in tangents and graph.op[i] not in LEAVES:
            tangent = _tangent(graph, i, tangents)
            if tangent != ZERO:
                tangents[i] = tangent
    found = (tangents.get(ref >> 1, ZERO) for ref in refs)
    return [Value(graph, graph.negate(t) if ref & 1 else t) for ref, t in zip(refs, found, strict=True)]


def gradient_columns(values: Sequence[Value], inputs: Sequence[Value]) -> list[list[Value]]:
    """The matrix d value_i / d input_j, row by row."""
    if not values:
        return []
    one = Value(values[0].graph, values[0].graph.number(Fraction(1)))
    columns = [derivative(values, {source: one}) for source in inputs]
    return [list(row) for row in zip(*columns, strict=True)]


def improved(values: Sequence[Value]) -> list[Value]:
    """The same values from fewer operations, in the same graph."""
    if not values:
        return []
    graph = values[0].graph
    fresh, refs = improve(graph, [value.ref for value in values])
    moved: dict[int, Ref] = {}
    for i in reachable(fresh, refs):
        if fresh.op[i] in LEAVES:
            moved[i] = copy_leaf(fresh, i, graph)
        else:
            moved[i] = graph.apply(fresh.op[i], *(moved[k] for k in fresh.operands[i]))
    return [Value(graph, graph.negate(moved[r >> 1]) if r & 1 else moved[r >> 1]) for r in refs]


def _tangent(graph: Graph, i: int, tangents: Mapping[int, Ref]) -> Ref:
    """The rate of change of a node from those of its operands."""
    operands = graph.operands[i]
    rates = [tangents.get(k, ZERO) for k in operands]
    if not any(rates):
        return ZERO
    a, da = 2 * operands[0], rates[0]
    match graph.op[i]:
        case Op.ADD:
            return graph.add(da, rates[1])
        case Op.SUBTRACT:
            return graph.subtract(da, rates[1])
        case Op.MULTIPLY:
            b, db = 2 * operands[1], rates[1]
            return graph.add(graph.multiply(da, b), graph.multiply(a, db))
        case Op.DIVIDE:
            b, db = 2 * operands[1], rates[1]
            return graph.divide(graph.subtract(da, graph.multiply(2 * i, db)), b)
        case Op.NEGATE:
            return graph.negate(da)
        case Op.SINE:
            return graph.multiply(graph.cosine(a), da)
        case Op.COSINE:
            return graph.negate(graph.multiply(graph.sine(a), da))
        case Op.ROOT:
            return graph.divide(da, graph.add(2 * i, 2 * i))
        case _:
            return ZERO

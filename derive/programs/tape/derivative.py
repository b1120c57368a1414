"""Exact derivatives of graph values: every node once, in the graph that holds the values.

A derivative is made of nodes of the same graph, so it shares all that the values have computed already, and what does
not depend on the input costs nothing. The graph is differentiated as it stands; a graph that has been improved first
has fewer nodes to differentiate.
"""

from collections.abc import Mapping, Sequence

from derive.programs.tape.build import reachable
from derive.programs.tape.graph import ONE, ZERO, Graph, Ref, is_negative, negated, node_of, ref_to, signed
from derive.programs.tape.tape import LEAVES, Op
from derive.programs.tape.value import Value


def derivative(values: Sequence[Value], rates: Mapping[Value, Value]) -> list[Value]:
    """Rates of change of values (forward mode)."""
    if not values:
        return []
    graph = values[0].graph
    refs = [value.ref for value in values]
    # A rate belongs to the node; where the reference is to minus the node, so is the rate.
    pairs = ((source.ref, rate.ref) for source, rate in rates.items() if rate)
    tangents = {node_of(source): signed(rate, is_negative(source)) for source, rate in pairs}
    # In the order of creation: operands have their rates before their users.
    for i in reachable(graph, refs):
        if i not in tangents and graph.op[i] not in LEAVES:
            tangent = _tangent(graph, i, tangents)
            if tangent != ZERO:
                tangents[i] = tangent
    return [Value(graph, signed(tangents.get(node_of(ref), ZERO), is_negative(ref))) for ref in refs]


def gradient(value: Value, inputs: Sequence[Value]) -> list[Value]:
    """The partial derivatives of one value (reverse mode): each node costs a few operations, however many inputs."""
    graph = value.graph
    adjoints = {node_of(value.ref): signed(ONE, is_negative(value.ref))}
    for i in reversed(reachable(graph, [value.ref])):
        for k in set(graph.operands[i]) if i in adjoints else ():
            adjoints[k] = graph.add(adjoints.get(k, ZERO), graph.multiply(adjoints[i], _tangent(graph, i, {k: ONE})))
    return [Value(graph, signed(adjoints.get(node_of(x.ref), ZERO), is_negative(x.ref))) for x in inputs]


def gradient_columns(values: Sequence[Value], inputs: Sequence[Value]) -> list[list[Value]]:
    """The matrix of partial derivatives."""
    if not values:
        return []
    one = Value(values[0].graph, ONE)
    return [list(row) for row in zip(*[derivative(values, {source: one}) for source in inputs], strict=True)]


def _tangent(graph: Graph, i: int, tangents: Mapping[int, Ref]) -> Ref:
    """The rate of change of a node from those of its operands."""
    operands = graph.operands[i]
    rates = [tangents.get(k, ZERO) for k in operands]
    if not any(rates):
        return ZERO
    a, da = ref_to(operands[0]), rates[0]
    match graph.op[i]:
        case Op.ADD:
            return graph.add(da, rates[1])
        case Op.SUBTRACT:
            return graph.subtract(da, rates[1])
        case Op.MULTIPLY:
            # d(a b) = da b + a db
            b, db = ref_to(operands[1]), rates[1]
            return graph.add(graph.multiply(da, b), graph.multiply(a, db))
        case Op.DIVIDE:
            # d(a / b) = (da - (a / b) db) / b, with the quotient that exists
            b, db = ref_to(operands[1]), rates[1]
            return graph.divide(graph.subtract(da, graph.multiply(ref_to(i), db)), b)
        case Op.NEGATE:
            return negated(da)
        case Op.SINE:
            return graph.multiply(graph.cosine(a), da)
        case Op.COSINE:
            return negated(graph.multiply(graph.sine(a), da))
        case Op.ROOT:
            # d sqrt(a) = da / (2 sqrt(a))
            return graph.divide(da, graph.add(ref_to(i), ref_to(i)))
        case Op.ARCTANGENT:
            # d atan2(y, x) = (x dy - y dx) / (x^2 + y^2), with y in a
            x, dx = ref_to(operands[1]), rates[1]
            square = graph.add(graph.multiply(a, a), graph.multiply(x, x))
            return graph.divide(graph.subtract(graph.multiply(x, da), graph.multiply(a, dx)), square)
        case Op.SELECT:
            # Cases are constant almost everywhere: the rate of the one that holds.
            return graph.select(a, rates[1], rates[2])
        case Op.MAXIMUM:
            return graph.select(graph.less(a, ref_to(operands[1])), rates[1], da)
        case Op.MINIMUM:
            return graph.select(graph.less(a, ref_to(operands[1])), da, rates[1])
        case Op.ABSOLUTE:
            return graph.multiply(graph.sign(a), da)
        case _:
            return ZERO

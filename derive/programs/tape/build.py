"""From a traced graph to a tape: numbers put in and folded, unneeded nodes left out, the rest put in order."""

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import replace

from derive.algebra.constants import Constant
from derive.programs.tape import cases
from derive.programs.tape.graph import Graph, Ref, is_negative, negated, node_of, signed
from derive.programs.tape.schedule import schedule
from derive.programs.tape.tape import LEAVES, PARAMETER, InputSource, Node, Op, Output, Tape

# For each run-time parameter of a graph what stands in its place: another input, or a number.
Replacements = Mapping[int, InputSource | Constant]
_OPERATIONS: Mapping[Op, Callable[..., Ref]] = {
    Op.ADD: Graph.add,
    Op.SUBTRACT: Graph.subtract,
    Op.MULTIPLY: Graph.multiply,
    Op.DIVIDE: Graph.divide,
    Op.NEGATE: lambda graph, a: negated(a),
    Op.SINE: Graph.sine,
    Op.COSINE: Graph.cosine,
    Op.ROOT: Graph.root,
    Op.SIGN: Graph.sign,
    Op.ARCTANGENT: Graph.arctangent,
    Op.LESS: cases.less,
    Op.SELECT: cases.select,
    **{op: lambda graph, a, b, op=op: cases.extreme(graph, op, a, b) for op in (Op.MAXIMUM, Op.MINIMUM)},
    Op.ABSOLUTE: Graph.absolute,
}


def reachable(graph: Graph, outputs: Iterable[Ref], known: Container[int] = ()) -> list[int]:
    """The nodes that some outputs need."""
    operands = graph.operands
    seen = {ref >> 1 for ref in outputs if ref >> 1 not in known}
    stack = list(seen)
    while stack:
        for operand in operands[stack.pop()]:
            if operand not in seen and operand not in known:
                seen.add(operand)
                stack.append(operand)
    return sorted(seen)


def copy_leaf(graph: Graph, index: int, fresh: Graph, parameters: Replacements | None = None) -> Ref:
    """Make an input or a constant again in another graph."""
    source = graph.sources.get(index)
    if source is None:
        return fresh.number(graph.constants[index])
    if parameters is not None and source.kind == PARAMETER:
        value = parameters[source.index]
        return fresh.input(value.kind, value.index) if isinstance(value, InputSource) else fresh.number(value)
    return fresh.input(source.kind, source.index)


def apply(graph: Graph, op: Op, operands: Sequence[Ref]) -> Ref:
    """An operation by its kind, folded as if written."""
    return _OPERATIONS[op](graph, *operands)


def copy(
    graph: Graph, outputs: Sequence[Ref], fresh: Graph, known: dict[int, Ref], parameters: Replacements | None = None
) -> tuple[Ref, ...]:
    """Make values again in another graph, folded there as if they were written anew."""
    for i in reachable(graph, outputs, known):
        op = graph.op[i]
        if op in LEAVES:
            known[i] = copy_leaf(graph, i, fresh, parameters)
        else:
            known[i] = apply(fresh, op, [known[k] for k in graph.operands[i]])
    return tuple(signed(known[node_of(ref)], is_negative(ref)) for ref in outputs)


def bake(graph: Graph, outputs: Sequence[Ref], parameters: Replacements) -> tuple[Graph, tuple[Ref, ...]]:
    """Put numbers in the place of a graph's parameters, and fold again."""
    fresh = Graph()
    return fresh, copy(graph, outputs, fresh, {}, parameters)


def cut(graph: Graph, outputs: Sequence[Ref]) -> Tape:
    """The tape of some outputs: what they need, in an order in which few values are alive at a time."""
    order = schedule(graph, outputs)
    number = {old: new for new, old in enumerate(order)}
    nodes = [graph.node(i, number) for i in order]
    tape = Tape(tuple(nodes), tuple(Output(number[node_of(ref)], is_negative(ref)) for ref in outputs))
    results = tuple(
        Output(output.node, False) if output.negative and _turn(nodes, tape.use_counts, output.node) else output
        for output in tape.outputs
    )
    return Tape(tuple(nodes), results)


def _turn(nodes: list[Node], uses: Sequence[int], index: int) -> bool:
    """Change the sign of a value that serves nothing else, if a difference in it can take it: -(a - b) is b - a."""
    stack = [index]
    while stack:
        i = stack.pop()
        node = nodes[i]
        if uses[i] != 1:
            continue
        if node.op is Op.SUBTRACT:
            nodes[i] = replace(node, operands=node.operands[::-1])
            return True
        if node.op in (Op.MULTIPLY, Op.DIVIDE):
            stack.extend(reversed(node.operands))
    return False

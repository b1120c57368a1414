"""From a traced graph to tapes: numbers put in, folded again, improved, put in order."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from derive.algebra.tape import LEAVES, PARAMETER, Node, Op, Output, Source, Tape
from derive.algebra.tape_graph import Graph, Ref
from derive.algebra.tape_schedule import schedule
from derive.algebra.tape_signs import absorb_signs

Leaf = Callable[[Graph, int, Graph], Ref]


def reachable(graph: Graph, outputs: Iterable[Ref]) -> list[int]:
    """Indices of the nodes that the outputs need, ascending: operands come first."""
    seen = {ref >> 1 for ref in outputs}
    stack = list(seen)
    while stack:
        for operand in graph.operands[stack.pop()]:
            if operand not in seen:
                seen.add(operand)
                stack.append(operand)
    return sorted(seen)


def rebuild(graph: Graph, outputs: Sequence[Ref], leaf: Leaf) -> tuple[Graph, tuple[Ref, ...]]:
    """The same values in a new graph, folded again, with other leaves.

    Args:
        graph: The old graph.
        outputs: References into it.
        leaf: Makes a leaf: called with the old graph, the index of the leaf and the new graph.

    Returns:
        The new graph and the outputs in it.
    """
    fresh = Graph()
    moved: dict[int, Ref] = {}
    for i in reachable(graph, outputs):
        if graph.op[i] in LEAVES:
            moved[i] = leaf(graph, i, fresh)
        else:
            moved[i] = fresh.apply(graph.op[i], *(moved[k] for k in graph.operands[i]))
    return fresh, tuple(fresh.negate(moved[r >> 1]) if r & 1 else moved[r >> 1] for r in outputs)


def copy_leaf(graph: Graph, index: int, fresh: Graph) -> Ref:
    """The leaf as it is."""
    payload = graph.payload[index]
    if isinstance(payload, Source):
        return fresh.input(payload.kind, payload.index)
    return fresh.number(payload)


def bake(
    graph: Graph, outputs: Sequence[Ref], parameters: Mapping[int, Callable[[Graph], Ref]]
) -> tuple[Graph, tuple[Ref, ...]]:
    """Replace parameters by what ``parameters`` makes of them, and fold again.

    Args:
        graph: A graph traced with symbols.
        outputs: References into it.
        parameters: For each parameter index, what makes its replacement in the new graph.

    Returns:
        The new graph and the outputs in it.
    """

    def leaf(old: Graph, index: int, fresh: Graph) -> Ref:
        payload = old.payload[index]
        if isinstance(payload, Source) and payload.kind == PARAMETER:
            return parameters[payload.index](fresh)
        return copy_leaf(old, index, fresh)

    return rebuild(graph, outputs, leaf)


def cut(graph: Graph, outputs: Sequence[Ref]) -> Tape:
    """The tape of ``outputs``: what they need, in an order in which few values are alive at a time."""
    order = schedule(graph, outputs)
    number = {old: new for new, old in enumerate(order)}
    nodes = tuple(_renumbered(graph.node(i), number) for i in order)
    return absorb_signs(Tape(nodes, tuple(Output(number[r >> 1], bool(r & 1)) for r in outputs)))


def _renumbered(node: Node, number: Mapping[int, int]) -> Node:
    return Node(node.op, tuple(number[k] for k in node.operands), node.layer, node.value, node.source)


def cost(graph: Graph, outputs: Sequence[Ref]) -> tuple[int, int]:
    """Operations of the body and of the hoisted work, by which candidates are compared."""
    counts = [0, 0, 0]
    for i in reachable(graph, outputs):
        if graph.op[i] not in LEAVES and graph.op[i] not in (Op.NEGATE, Op.SIGN):
            counts[graph.layer[i]] += 1
    return counts[2], counts[1]

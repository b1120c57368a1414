"""From a traced graph to tapes: numbers put in, folded again, improved, put in order.

Changes of sign taken into differences: -(a - b) is b - a, so that outputs need none.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import replace

from derive.programs.tape.graph import Graph, Ref
from derive.programs.tape.schedule import schedule
from derive.programs.tape.tape import LEAVES, PARAMETER, Node, Op, Output, Source, Tape


def absorb_signs(tape: Tape) -> Tape:
    """The same tape with fewer negative outputs; operations and their results do not change but for signs."""
    nodes = list(tape.nodes)
    outputs = tuple(
        Output(output.node, False) if output.negative and _turn(nodes, tape.use_counts, output.node) else output
        for output in tape.outputs
    )
    return Tape(tuple(nodes), outputs)


def _turn(nodes: list[Node], uses: Sequence[int], index: int) -> bool:
    """Change the sign of a value that serves nothing else, if a difference in it can take it."""
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


def reachable(graph: Graph, outputs: Iterable[Ref], known: Container[int] = ()) -> list[int]:
    """Indices of the nodes that the outputs need, ascending: operands come first.

    Args:
        graph: A graph.
        outputs: References into it.
        known: Nodes that are left out, with what they alone need.
    """
    operands = graph.operands
    seen = {ref >> 1 for ref in outputs if ref >> 1 not in known}
    stack = list(seen)
    while stack:
        for operand in operands[stack.pop()]:
            if operand not in seen and operand not in known:
                seen.add(operand)
                stack.append(operand)
    return sorted(seen)


def copy_leaf(graph: Graph, index: int, fresh: Graph) -> Ref:
    """The leaf as it is."""
    payload = graph.payload[index]
    if isinstance(payload, Source):
        return fresh.input(payload.kind, payload.index)
    return fresh.number(payload)


Replacements = Mapping[int, Callable[[Graph], Ref]]
"""For each parameter index, what makes its replacement in a new graph."""


class Baker:
    """Replaces parameters of a graph and folds again, in one new graph for all that is asked of it.

    Args:
        graph: A graph traced with symbols; it may grow.
        parameters: What to put in their places.
    """

    def __init__(self, graph: Graph, parameters: Replacements) -> None:
        self._old = graph
        self._parameters = parameters
        self._new = Graph()
        self._moved: dict[int, Ref] = {}

    def bake(self, outputs: Sequence[Ref]) -> tuple[Graph, tuple[Ref, ...]]:
        """The new graph and some outputs in it."""
        old, new, moved = self._old, self._new, self._moved
        for i in reachable(old, outputs, moved):
            op = old.op[i]
            moved[i] = self._leaf(i) if op in LEAVES else new.apply(op, *[moved[k] for k in old.operands[i]])
        return new, tuple(new.negate(moved[r >> 1]) if r & 1 else moved[r >> 1] for r in outputs)

    def _leaf(self, index: int) -> Ref:
        payload = self._old.payload[index]
        if isinstance(payload, Source) and payload.kind == PARAMETER:
            return self._parameters[payload.index](self._new)
        return copy_leaf(self._old, index, self._new)


def bake(graph: Graph, outputs: Sequence[Ref], parameters: Replacements) -> tuple[Graph, tuple[Ref, ...]]:
    """Replace parameters by what ``parameters`` makes of them, and fold again.

    Args:
        graph: A graph traced with symbols.
        outputs: References into it.
        parameters: What to put in their places.

    Returns:
        The new graph and the outputs in it.
    """
    return Baker(graph, parameters).bake(outputs)


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

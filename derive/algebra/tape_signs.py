"""Changes of sign taken into differences: -(a - b) is b - a, so that outputs need none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from derive.algebra.tape import Node, Op, Output, Tape


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

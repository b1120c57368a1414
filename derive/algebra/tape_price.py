"""What a traced graph will cost, before it is improved: enough to tell good formulations from bad ones."""

from __future__ import annotations

from collections.abc import Sequence

from derive.algebra.tape import FUNCTION_COST, LEAVES, Layer, Op
from derive.algebra.tape_build import reachable
from derive.algebra.tape_graph import Graph, Ref

_FREE = (*LEAVES, Op.NEGATE, Op.SIGN)
_DEAR = (Op.SINE, Op.COSINE)


def price(graph: Graph, outputs: Sequence[Ref]) -> tuple[int, int]:
    """Cost as in `derive.algebra.tape.Operations.cost`, and how many nodes were looked at."""
    nodes = reachable(graph, outputs)
    body = [graph.op[i] for i in nodes if graph.layer[i] == Layer.BODY]
    total = sum(FUNCTION_COST if op in _DEAR else 1 for op in body if op not in _FREE)
    return total, len(nodes)

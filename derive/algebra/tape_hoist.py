"""The hoisted part of a program improved like a body, with the parameters for arguments."""

from __future__ import annotations

from collections.abc import Sequence

from derive.algebra.tape import LEAVES, Layer
from derive.algebra.tape_build import copy_leaf, cost, reachable
from derive.algebra.tape_convert import network_of
from derive.algebra.tape_graph import Graph, Ref
from derive.algebra.tape_search import Search
from derive.algebra.tape_write import graph_of


def improve_hoisted(graph: Graph, outputs: Sequence[Ref], effort: int) -> tuple[Graph, tuple[Ref, ...]]:
    """The same program with cheaper hoisted work, where a search finds any.

    Args:
        graph: A graph.
        outputs: References into it.
        effort: Divisors that trials may look at.
    """
    order = reachable(graph, outputs)
    results = _results(graph, order, outputs)
    if not results:
        return graph, tuple(outputs)
    network = network_of(graph, [2 * i for i in results], Layer.HOISTED)
    Search(network).run(effort)
    fresh, moved = graph_of(network, graph)
    found = _grafted(graph, order, outputs, fresh, dict(zip(results, moved, strict=True)))
    return found if cost(*found) < cost(graph, outputs) else (graph, tuple(outputs))


def _results(graph: Graph, order: Sequence[int], outputs: Sequence[Ref]) -> list[int]:
    """Hoisted values that the body or an output uses."""
    used = {ref >> 1 for ref in outputs}
    used.update(k for i in order if graph.layer[i] == Layer.BODY for k in graph.operands[i])
    return sorted(i for i in used if graph.layer[i] == Layer.HOISTED and graph.op[i] not in LEAVES)


def _grafted(
    graph: Graph, order: Sequence[int], outputs: Sequence[Ref], fresh: Graph, moved: dict[int, Ref]
) -> tuple[Graph, tuple[Ref, ...]]:
    """The body of the old graph on the hoisted values of the new one."""
    for i in order:
        if i in moved or (graph.layer[i] == Layer.HOISTED and graph.op[i] not in LEAVES):
            continue
        if graph.op[i] in LEAVES:
            moved[i] = copy_leaf(graph, i, fresh)
        else:
            moved[i] = fresh.apply(graph.op[i], *(moved[k] for k in graph.operands[i]))
    return fresh, tuple(fresh.negate(moved[ref >> 1]) if ref & 1 else moved[ref >> 1] for ref in outputs)

"""Cheaper programs for the same values: as networks of polynomials in which shared parts are searched for.

The hoisted part of a program improved like a body, with the parameters for arguments.
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.programs.optimise.convert import graph_of, network_of
from derive.programs.optimise.network import Opaque
from derive.programs.optimise.search import Search
from derive.programs.tape.build import copy_leaf, cost, reachable
from derive.programs.tape.graph import Graph, Ref
from derive.programs.tape.tape import FUNCTION_COST, LEAVES, Layer, Op


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


EFFORT = 16_000
"""Divisors looked at by trials before the search ends: about a tenth of a second."""

_COSTS = {Op.DIVIDE: 1, Op.ROOT: 1, Op.SINE: FUNCTION_COST, Op.COSINE: FUNCTION_COST}

_HOISTED = EFFORT // 4

_DRAFT = EFFORT // 4


def improve(graph: Graph, outputs: Sequence[Ref], effort: int = EFFORT) -> tuple[Graph, tuple[Ref, ...]]:
    """The same values for fewer operations.

    Args:
        graph: A graph.
        outputs: References into it.
        effort: How long to search.
    """
    improvement = Improvement(graph, outputs)
    improvement.search(effort)
    return improvement.result()


class Improvement:
    """The improvement of one program, which may be taken further step by step.

    Args:
        graph: A graph.
        outputs: References into it.
    """

    def __init__(self, graph: Graph, outputs: Sequence[Ref]) -> None:
        self._graph = graph
        self._outputs = tuple(outputs)
        self._network = network_of(graph, outputs)
        self._search = Search(self._network)

    def draft(self) -> None:
        """Search for a short time."""
        self._search.run(_DRAFT)

    def cost(self) -> int:
        """`Operations.cost` of the program found so far."""
        functions = [d.op for d in self._network.definition.values() if isinstance(d, Opaque) and d.op is not None]
        return self._network.cost + sum(_COSTS.get(op, 0) for op in functions)

    def search(self, effort: int) -> None:
        """Search for long."""
        self._search.run(effort // 2)
        self._search.resubstitute(effort)
        self._search.run(effort // 2)

    def result(self) -> tuple[Graph, tuple[Ref, ...]]:
        """The cheapest program found so far, its hoisted work improved too."""
        found = graph_of(self._network, self._graph)
        best = found if cost(*found) < cost(self._graph, self._outputs) else (self._graph, self._outputs)
        return improve_hoisted(*best, _HOISTED)

    def close(self) -> None:
        """Let go of what refers to itself, so that its memory is free at once."""
        self._network.watcher = None

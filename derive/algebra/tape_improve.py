"""Cheaper programs for the same values: as networks of polynomials in which shared parts are searched for."""

from __future__ import annotations

from collections.abc import Sequence

from derive.algebra.tape import FUNCTION_COST, Op
from derive.algebra.tape_build import cost
from derive.algebra.tape_convert import network_of
from derive.algebra.tape_graph import Graph, Ref
from derive.algebra.tape_hoist import improve_hoisted
from derive.algebra.tape_network import Opaque
from derive.algebra.tape_search import Search
from derive.algebra.tape_write import graph_of

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

"""Cheaper programs for the same values: as networks of polynomials in which shared parts are searched for.

The hoisted part of a program is improved like a body, with the parameters for arguments.
"""

from collections.abc import Sequence

from derive.programs.optimise.convert import graph_of, network_of
from derive.programs.optimise.search import Search
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.build import copy, reachable
from derive.programs.tape.cost import program_cost
from derive.programs.tape.graph import Graph, Ref, node_of, ref_to
from derive.programs.tape.tape import LEAVES, Layer
from derive.programs.tape.value import Value


def improve(graph: Graph, outputs: Sequence[Ref]) -> tuple[Graph, tuple[Ref, ...]]:
    """The same values for fewer operations."""
    improvement = Improvement(graph, outputs)
    improvement.search()
    return improvement.result()


def improved_values(values: Sequence[Value]) -> list[Value]:
    """The same values from fewer operations, in the same graph."""
    if not values:
        return []
    graph = values[0].graph
    fresh, refs = improve(graph, [value.ref for value in values])
    return [Value(graph, ref) for ref in copy(fresh, refs, graph, {})]


class Improvement:
    """The improvement of one program, which may be taken further step by step."""

    def __init__(self, graph: Graph, outputs: Sequence[Ref]) -> None:
        self._graph = graph
        self._outputs = tuple(outputs)
        self._network = network_of(graph, outputs)
        self._search = Search(self._network)

    @property
    def cost(self) -> int:
        """Cost of the body of the program found so far."""
        return self._network.cost

    def draft(self) -> None:
        """Search for a short time."""
        self._search.run(POLICY.draft_work)

    def search(self, work: int = POLICY.search_work) -> None:
        """Search for long."""
        self._search.run(work // 2)
        self._search.resubstitute(work)
        self._search.run(work // 2)

    def result(self) -> tuple[Graph, tuple[Ref, ...]]:
        """The cheapest program found so far, its hoisted work improved too."""
        graph, outputs = _cheaper((self._graph, self._outputs), graph_of(self._network, self._graph))
        order = reachable(graph, outputs)
        used = {node_of(ref) for ref in outputs}
        used.update(k for i in order if graph.layer[i] is Layer.BODY for k in graph.operands[i])
        results = sorted(i for i in used if graph.layer[i] is Layer.HOISTED and graph.op[i] not in LEAVES)
        if not results:
            return graph, outputs
        network = network_of(graph, [ref_to(i) for i in results], Layer.HOISTED)
        Search(network).run(POLICY.hoisted_work)
        fresh, moved = graph_of(network, graph)
        return _cheaper((graph, outputs), (fresh, copy(graph, outputs, fresh, dict(zip(results, moved, strict=True)))))

    def close(self) -> None:
        """Cut the network's reference to what watches it: without this circle its memory is free at once."""
        self._network.watcher = None


def _cheaper(old: tuple[Graph, tuple[Ref, ...]], new: tuple[Graph, tuple[Ref, ...]]) -> tuple[Graph, tuple[Ref, ...]]:
    return new if program_cost(*new) < program_cost(*old) else old

"""The way of traced outputs to a tape for one robot.

What a traced graph will cost, before it is improved: enough to tell good formulations from bad ones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from derive.algebra.constants import exact_number
from derive.programs.effort import Effort
from derive.programs.optimise.improve import EFFORT, Improvement
from derive.programs.tape.build import Baker, bake, cut, reachable
from derive.programs.tape.graph import Graph, Ref
from derive.programs.tape.tape import FUNCTION_COST, LEAVES, PARAMETER, Layer, Op, Tape
from derive.robot.expression import Expression
from derive.robot.names import free_symbols, number_of, robot_symbols
from derive.robot.robot import Robot

_FREE = (*LEAVES, Op.NEGATE, Op.SIGN)
_DEAR = (Op.SINE, Op.COSINE)


def price(graph: Graph, outputs: Sequence[Ref]) -> tuple[int, int]:
    """Cost as in `derive.programs.tape.tape.Operations.cost`, and how many nodes were looked at."""
    nodes = reachable(graph, outputs)
    body = [graph.op[i] for i in nodes if graph.layer[i] == Layer.BODY]
    total = sum(FUNCTION_COST if op in _DEAR else 1 for op in body if op not in _FREE)
    return total, len(nodes)


_CLOSE = 1.03
"""Costs that a longer search may bring below the best one, in terms of it."""

_FINALISTS = 2

_LARGE = 20_000
"""Operations from which a longer search finds little for its time."""


class Finisher:
    """Puts the robot's numbers into a graph traced with its symbols, improves it and cuts tapes.

    Args:
        robot: The robot.
        graph: The graph that a `TapeDomain` of this robot has filled.
        effort: How long programs are improved.
    """

    def __init__(self, robot: Robot, graph: Graph, effort: Effort = Effort.FULL) -> None:
        self._effort = effort
        self._graph = graph
        self._replacements = _replacements(robot)
        self._priced = Baker(graph, self._replacements)

    def price(self, outputs: Sequence[Ref]) -> tuple[int, int]:
        """What some outputs cost before they are improved, and how many nodes were looked at."""
        return price(*self._priced.bake(outputs))

    def tape(self, outputs: Sequence[Ref]) -> Tape:
        """The tape of some outputs."""
        return self.cheapest([outputs])[1]

    def cheapest(self, candidates: Sequence[Sequence[Ref]], *, search: bool = True) -> tuple[int, Tape]:
        """The tape of least `Operations.cost` among candidates that compute the same, and which one it is.

        All are improved quickly; a longer search is spent on those close to the best, unless none is worth it.
        """
        if self._effort is Effort.QUICK:
            return self._cheapest_as_traced(candidates)
        drafts = [Improvement(*bake(self._graph, outputs, self._replacements)) for outputs in candidates]
        costs = [self._drafted(draft) for draft in drafts]
        close = [i for i, cost in enumerate(costs) if cost <= _CLOSE * min(costs)]
        close.sort(key=costs.__getitem__)
        finalists = close[: 1 if min(costs) > _LARGE else _FINALISTS]
        if search and min(costs) <= _LARGE:
            for i in finalists:
                drafts[i].search(EFFORT)
        winner = min(sorted(finalists), key=lambda i: drafts[i].cost())
        tape = cut(*drafts[winner].result())
        for draft in drafts:
            draft.close()
        return winner, tape

    def _cheapest_as_traced(self, candidates: Sequence[Sequence[Ref]]) -> tuple[int, Tape]:
        programs = [bake(self._graph, outputs, self._replacements) for outputs in candidates]
        winner = min(range(len(programs)), key=lambda i: price(*programs[i])[0])
        return winner, cut(*programs[winner])

    def _drafted(self, draft: Improvement) -> int:
        draft.draft()
        return draft.cost()


def _replacements(robot: Robot) -> dict[int, Callable[[Graph], Ref]]:
    """For each symbol its number, or its place in the parameter vector."""
    free = {name: k for k, name in enumerate(free_symbols(robot))}
    numbers = number_of(robot)
    return {
        i: _input(free[name]) if name in free else _number(numbers[name]) for i, name in enumerate(robot_symbols(robot))
    }


def _input(index: int) -> Callable[[Graph], Ref]:
    return lambda graph: graph.input(PARAMETER, index)


def _number(expression: Expression) -> Callable[[Graph], Ref]:
    value = exact_number(expression, {})
    assert value is not None, "the loader admits only numbers as parameters"
    return lambda graph: graph.number(value)

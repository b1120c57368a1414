"""The cheapest combination of ways to compute some values that share work.

Every group of outputs has options, each a complete way to compute the group. What two choices have in common is
computed once, so the cost of a combination is that of the union of the nodes that its options need.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import reduce
from operator import or_

from derive.programs.tape.build import reachable
from derive.programs.tape.graph import Graph, Ref, node_of
from derive.programs.tape.tape import OPERATION_COST, Layer

# The ways to compute one group of outputs; each gives the same outputs in the same order.
Options = Sequence[Sequence[Ref]]


def choose(graph: Graph, groups: Sequence[Options]) -> tuple[int, ...]:
    """For every group the option to take.

    A local search: from several starts, one group after another changes to what is cheapest beside the others, until
    none does. It does not always find the best, but no combination with one change is better.
    """
    needs = _Needs(graph, groups)
    _, best = min((needs.settled(start) for start in needs.starts()), key=lambda found: found[0])
    return tuple(places[k] for places, k in zip(needs.places, best, strict=True))


class _Needs:
    """The body's operations that each option needs, as bits of an integer."""

    def __init__(self, graph: Graph, groups: Sequence[Options]) -> None:
        bits: dict[int, int] = {}
        self._of_cost: dict[int, int] = {}  # the operations of each cost
        free = 1
        for i in reachable(graph, (ref for options in groups for option in options for ref in option)):
            mask = _union(bits[k] for k in graph.operands[i])
            cost = OPERATION_COST[graph.op[i]]
            if graph.layer[i] is Layer.BODY and cost:
                mask |= free
                self._of_cost[cost] = self._of_cost.get(cost, 0) | free
                free <<= 1
            bits[i] = mask
        self.places: list[list[int]] = []
        self.groups: list[list[int]] = []
        for options in groups:
            masks = [_union(bits[node_of(ref)] for ref in option) for option in options]
            kept: list[int] = []
            for place, mask in enumerate(masks):
                if any(masks[k] & ~mask == 0 for k in kept):
                    continue
                kept = [k for k in kept if mask & ~masks[k]] + [place]
            self.places.append(kept)
            self.groups.append([masks[place] for place in kept])

    def _cost(self, needed: int) -> int:
        return sum([cost * (needed & mask).bit_count() for cost, mask in self._of_cost.items()])

    def _cheapest(self, group: int, beside: int) -> int:
        """The option of a group that adds least to what is needed anyway, the first of equals."""
        costs = [self._cost(beside | option) for option in self.groups[group]]
        return costs.index(min(costs))

    def starts(self) -> Iterator[list[int]]:
        """The same place in every group; what is cheapest beside the groups before, and beside those after."""
        for place in range(max(map(len, self.groups), default=0)):
            yield [min(place, len(options) - 1) for options in self.groups]
        count = len(self.groups)
        for order in (range(count), range(count - 1, -1, -1)):
            found, needed = [0] * count, 0
            for group in order:
                found[group] = self._cheapest(group, needed)
                needed |= self.groups[group][found[group]]
            yield found

    def settled(self, found: list[int]) -> tuple[int, list[int]]:
        """A combination that no change of one group improves, with its cost before it."""
        groups = self.groups
        spent = self._cost(_union(groups[g][k] for g, k in enumerate(found)))
        changed = True
        while changed:
            changed = False
            for group in range(len(found)):
                beside = _union(groups[g][k] for g, k in enumerate(found) if g != group)
                place = self._cheapest(group, beside)
                now = self._cost(beside | groups[group][place])
                if now < spent:
                    found[group], spent, changed = place, now, True
        return spent, found


def _union(masks: Iterable[int]) -> int:
    return reduce(or_, masks, 0)

"""The cheapest combination of ways to compute some values that share work.

Every group of outputs has options, each a complete way to compute the group. What two choices have in common is
computed once, so the cost of a combination is that of the union of the nodes that its options need.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.programs.tape.build import reachable
from derive.programs.tape.graph import Graph, Ref
from derive.programs.tape.tape import FUNCTION_COST, LEAVES, Layer, Op

Options = Sequence[Sequence[Ref]]
"""The ways to compute one group of outputs; each gives the same outputs in the same order."""

_FREE = (*LEAVES, Op.NEGATE, Op.SIGN)
_DEAR = (Op.SINE, Op.COSINE)


def choose(graph: Graph, groups: Sequence[Options]) -> tuple[int, ...]:
    """For every group the place of the option to take.

    A local search: from several starts, one group after another changes to what is cheapest beside the others, until
    none does. It does not always find the best, but no combination with one change is better.

    Args:
        graph: Where the options live.
        groups: At least one option each.
    """
    needs = _Needs(graph, groups)
    _, best = min((_settled(needs, start) for start in _starts(needs)), key=lambda found: found[0])
    return tuple(places[k] for places, k in zip(needs.places, best, strict=True))


class _Needs:
    """The body's operations that each option needs, as bits of an integer."""

    def __init__(self, graph: Graph, groups: Sequence[Options]) -> None:
        bits: dict[int, int] = {}
        place = 0
        self.dear = 0
        for i in reachable(graph, (ref for options in groups for option in options for ref in option)):
            mask = 0
            for k in graph.operands[i]:
                mask |= bits[k]
            if graph.layer[i] is Layer.BODY and graph.op[i] not in _FREE:
                mask |= 1 << place
                self.dear |= (graph.op[i] in _DEAR) << place
                place += 1
            bits[i] = mask
        self.places: list[list[int]] = []
        self.groups: list[list[int]] = []
        for options in groups:
            masks = [_union(bits[ref >> 1] for ref in option) for option in options]
            kept = _least(masks)
            self.places.append(kept)
            self.groups.append([masks[place] for place in kept])

    def cost(self, needed: int) -> int:
        """Operations, with sines and cosines as dear as in `derive.programs.tape.tape.Operations.cost`."""
        return needed.bit_count() + (FUNCTION_COST - 1) * (needed & self.dear).bit_count()

    def cheapest(self, group: int, beside: int) -> int:
        """The option of a group that adds least to what is needed anyway, the first of equals."""
        costs = [self.cost(beside | option) for option in self.groups[group]]
        return costs.index(min(costs))


def _least(masks: Sequence[int]) -> list[int]:
    """Places of the options that need no more than some other needs too; of equals the first."""
    kept: list[int] = []
    for place, mask in enumerate(masks):
        if any(masks[k] & ~mask == 0 for k in kept):
            continue
        kept = [k for k in kept if mask & ~masks[k]] + [place]
    return kept


def _union(masks: Iterator[int] | Sequence[int]) -> int:
    total = 0
    for mask in masks:
        total |= mask
    return total


def _starts(needs: _Needs) -> Iterator[list[int]]:
    """The same place in every group; what is cheapest beside the groups before, and beside those after."""
    most = max((len(options) for options in needs.groups), default=0)
    for place in range(most):
        yield [min(place, len(options) - 1) for options in needs.groups]
    count = len(needs.groups)
    for order in (range(count), range(count - 1, -1, -1)):
        found, needed = [0] * count, 0
        for group in order:
            found[group] = needs.cheapest(group, needed)
            needed |= needs.groups[group][found[group]]
        yield found


def _settled(needs: _Needs, start: list[int]) -> tuple[int, tuple[int, ...]]:
    """A combination that no change of one group improves, with its cost."""
    found = list(start)
    spent = needs.cost(_union([needs.groups[g][k] for g, k in enumerate(found)]))
    changed = True
    while changed:
        changed = False
        for group in range(len(found)):
            beside = _union([needs.groups[g][k] for g, k in enumerate(found) if g != group])
            place = needs.cheapest(group, beside)
            now = needs.cost(beside | needs.groups[group][place])
            if now < spent:
                found[group], spent, changed = place, now, True
    return spent, tuple(found)

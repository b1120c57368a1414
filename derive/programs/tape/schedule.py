"""An order of the operations in which few values are alive at a time, so that they stay in registers and cache.

Candidates: depth first from the outputs, with either operand first; and each of these with what can be computed without
a further live value moved forward. The order with the lowest peak is taken, the lowest sum of live values among equals.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from heapq import heappop, heappush

from derive.programs.tape.graph import Graph, Ref, node_of
from derive.programs.tape.tape import LEAVES, Layer


def schedule(graph: Graph, outputs: Sequence[Ref]) -> list[int]:
    """What some outputs need, operands before their users.

    Args:
        graph: A graph.
        outputs: References into it.

    Returns:
        Indices of nodes.
    """
    roots = [node_of(ref) for ref in outputs]
    plain = _depth_first(graph, roots, {})
    needs = _values_needed(graph, plain)
    orders = [plain, _depth_first(graph, roots, needs), _depth_first(graph, roots[::-1], needs)]
    orders += [_eager(graph, order) for order in orders]
    return min(orders, key=lambda order: live(graph, order))


def live(graph: Graph, order: Sequence[int]) -> tuple[int, int]:
    """How many values of the body an order keeps alive.

    Args:
        graph: A graph.
        order: Indices of nodes, operands before their users.

    Returns:
        The most at a time, and the sum over all steps.
    """
    work = _work(graph, order)
    last: dict[int, int] = {}
    for step, i in enumerate(order):
        for k in graph.operands[i]:
            last[k] = step
    peak = alive = total = 0
    for step, i in enumerate(order):
        if i in work:
            alive -= sum([last[k] == step and k in work for k in dict.fromkeys(graph.operands[i])])
            peak, total = max(peak, alive + 1), total + alive + 1
            alive += i in last
    return peak, total


def _work(graph: Graph, order: Sequence[int]) -> set[int]:
    """Nodes whose values are kept in a local variable: the operations of the body."""
    return {i for i in order if graph.layer[i] is Layer.BODY and graph.op[i] not in LEAVES}


def _depth_first(graph: Graph, roots: Sequence[int], rank: Mapping[int, int]) -> list[int]:
    """Each root in turn, after what it needs; the operand of highest rank first."""
    order: list[int] = []
    done: set[int] = set()
    for root in roots:
        stack = [root]
        while stack:
            index = stack[-1]
            waiting = [k for k in graph.operands[index] if k not in done]
            if waiting:
                waiting.sort(key=lambda k: -rank.get(k, 0))
                stack.extend(reversed(waiting))
                continue
            stack.pop()
            if index not in done:
                done.add(index)
                order.append(index)
    return order


def _values_needed(graph: Graph, order: Sequence[int]) -> dict[int, int]:
    """How many live values each node needs if it were a tree (Sethi and Ullman 1970)."""
    work = _work(graph, order)
    needs: dict[int, int] = {}
    for i in order:
        parts = sorted([needs[k] for k in graph.operands[i]], reverse=True)
        needs[i] = max([need + k for k, need in enumerate(parts)], default=0)
        if i in work:
            needs[i] = max(needs[i], 1)
    return needs


def _eager(graph: Graph, order: Sequence[int]) -> list[int]:
    """The order, with nodes moved forward that take up no more room than they give back."""
    work = _work(graph, order)
    place = {i: step for step, i in enumerate(order)}
    operands = {i: tuple(dict.fromkeys(graph.operands[i])) for i in order}
    users: dict[int, list[int]] = {i: [] for i in order}
    for i in order:
        for k in operands[i]:
            users[k].append(i)
    uses_left = {i: len(row) for i, row in users.items()}
    missing = {i: len(operands[i]) for i in order}
    done: dict[int, None] = {}
    free: list[tuple[int, int]] = []

    def _offer_users(i: int) -> None:
        for user in users[i]:
            if user in work and user not in done and not missing[user]:
                ended = sum([uses_left[k] == 1 and k in work for k in operands[user]])
                if ended >= bool(users[user]):
                    heappush(free, (place[user], user))

    for i in order:
        while free or i not in done:
            node = heappop(free)[1] if free else i
            if node in done:
                continue
            done[node] = None
            for user in users[node]:
                missing[user] -= 1
            for k in operands[node]:
                uses_left[k] -= 1
                if uses_left[k] == 1:
                    _offer_users(k)
            _offer_users(node)
    return list(done)

"""An order of the operations in which few values are alive at a time, so that they stay in registers and cache.

Candidates: depth first from the outputs, with either operand first; and each of these with what can be computed without
a further live value moved forward. The order with the lowest peak is taken, the lowest sum of live values among equals.
"""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heappop, heappush

from derive.programs.tape.graph import Graph, Ref
from derive.programs.tape.tape import LEAVES, Layer


def schedule(graph: Graph, outputs: Sequence[Ref]) -> list[int]:
    """What the outputs need, operands before their users.

    Args:
        graph: A graph.
        outputs: References into it.

    Returns:
        Indices of nodes.
    """
    roots = [ref >> 1 for ref in outputs]
    plain = depth_first(graph, roots, {})
    heights = _needs(graph, plain)
    orders = [plain, depth_first(graph, roots, heights), depth_first(graph, roots[::-1], heights)]
    orders += [_eager(graph, order) for order in orders]
    return min(orders, key=lambda order: live(graph, order))


def depth_first(graph: Graph, roots: Sequence[int], rank: dict[int, int]) -> list[int]:
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


def _needs(graph: Graph, order: Sequence[int]) -> dict[int, int]:
    """How many live values each node needs if it were a tree (Sethi and Ullman 1970)."""
    needs: dict[int, int] = {}
    for i in order:
        parts = sorted((needs[k] for k in graph.operands[i]), reverse=True)
        needs[i] = max((need + k for k, need in enumerate(parts)), default=0)
        if _is_work(graph, i):
            needs[i] = max(needs[i], 1)
    return needs


def _is_work(graph: Graph, i: int) -> bool:
    return graph.layer[i] == Layer.BODY and graph.op[i] not in LEAVES


def live(graph: Graph, order: Sequence[int]) -> tuple[int, int]:
    """The most values of the body alive at a time, and the sum of live values over all steps."""
    last: dict[int, int] = {}
    for step, i in enumerate(order):
        for k in graph.operands[i]:
            last[k] = step
    peak = alive = total = 0
    for step, i in enumerate(order):
        if not _is_work(graph, i):
            continue
        alive -= sum(last[k] == step and _is_work(graph, k) for k in dict.fromkeys(graph.operands[i]))
        peak, total = max(peak, alive + 1), total + alive + 1
        alive += i in last
    return peak, total


def _eager(graph: Graph, order: Sequence[int]) -> list[int]:
    """The order, with nodes moved forward that take up no more room than they give back."""
    return _Eager(graph, order).run()


class _Eager:
    def __init__(self, graph: Graph, order: Sequence[int]) -> None:
        self.graph = graph
        self.order = order
        self.place = {i: step for step, i in enumerate(order)}
        self.users: dict[int, list[int]] = {i: [] for i in order}
        for i in order:
            for k in dict.fromkeys(graph.operands[i]):
                self.users[k].append(i)
        self.left = {i: len(users) for i, users in self.users.items()}
        self.missing = {i: len(set(graph.operands[i])) for i in order}
        self.done: dict[int, None] = {}
        self.free: list[tuple[int, int]] = []

    def run(self) -> list[int]:
        """The new order."""
        for i in self.order:
            while self.free:
                _, eager = heappop(self.free)
                if eager not in self.done:
                    self._do(eager)
            if i not in self.done:
                self._do(i)
        return list(self.done)

    def _do(self, i: int) -> None:
        self.done[i] = None
        for user in self.users[i]:
            self.missing[user] -= 1
        for k in dict.fromkeys(self.graph.operands[i]):
            self.left[k] -= 1
            if self.left[k] == 1:
                self._offer_users(k)
        self._offer_users(i)

    def _offer_users(self, i: int) -> None:
        for user in self.users[i]:
            if user not in self.done and not self.missing[user] and self._is_free(user):
                heappush(self.free, (self.place[user], user))

    def _is_free(self, i: int) -> bool:
        if not _is_work(self.graph, i):
            return False
        ends = sum(self.left[k] == 1 and _is_work(self.graph, k) for k in dict.fromkeys(self.graph.operands[i]))
        return ends >= bool(self.users[i])

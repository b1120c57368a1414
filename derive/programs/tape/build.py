"""From a traced graph to a tape: numbers put in and folded, unneeded nodes left out, the rest put in order.

The order is one in which few values are alive at a time, so that they stay in registers and cache. Candidates: depth
first from the outputs, with either operand first; and each of these with what can be computed without a further live
value moved forward. The one with the lowest peak is taken, the lowest sum of live values among equals.
"""

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from heapq import heappop, heappush

from derive.algebra.constants import Constant
from derive.programs.tape.graph import Graph, Ref, is_negative, negated, node_of, signed
from derive.programs.tape.tape import LEAVES, OPERATION_COST, PARAMETER, InputSource, Layer, Node, Op, Output, Tape

Operands = Sequence[Sequence[int]]  # what each node takes, by its number
# Of each operation of the body the operands that are such operations too, each once; None for any other node.
Work = Sequence[Sequence[int] | None]
# For each run-time parameter of a graph what stands in its place: another input, or a number.
Replacements = Mapping[int, InputSource | Constant]
_OPERATIONS: Mapping[Op, Callable[..., Ref]] = {
    Op.ADD: Graph.add,
    Op.SUBTRACT: Graph.subtract,
    Op.MULTIPLY: Graph.multiply,
    Op.DIVIDE: Graph.divide,
    Op.NEGATE: lambda graph, a: negated(a),
    Op.SINE: Graph.sine,
    Op.COSINE: Graph.cosine,
    Op.ROOT: Graph.root,
    Op.SIGN: Graph.sign,
    Op.ARCTANGENT: Graph.arctangent,
    Op.LESS: Graph.less,
    Op.SELECT: Graph.select,
    **{op: lambda graph, a, b, op=op: graph.extreme(op, a, b) for op in (Op.MAXIMUM, Op.MINIMUM)},
    Op.ABSOLUTE: Graph.absolute,
}


def schedule(graph: Graph, outputs: Sequence[Ref]) -> list[int]:
    """What some outputs need, operands before their users."""
    # Depth first as it stands, only to number the nodes: operands have smaller numbers than users.
    roots = [node_of(ref) for ref in outputs]
    nodes = _depth_first(roots, graph.operands)
    number = {node: k for k, node in enumerate(nodes)}  # from here on, nodes are numbered in this order
    roots = [number[root] for root in roots]
    operands = [[number[k] for k in graph.operands[node]] for node in nodes]
    # The operations of the body: nodes whose values are kept in a local variable.
    is_work = [graph.layer[node] is Layer.BODY and graph.op[node] not in LEAVES for node in nodes]
    work: Work = [
        [k for k in dict.fromkeys(taken) if is_work[k]] if is_work[i] else None for i, taken in enumerate(operands)
    ]
    # Who of the body waits for whom.
    users: list[list[int]] = [[] for _ in nodes]
    for k, taken in enumerate(operands):
        for operand in dict.fromkeys(taken) if work[k] is not None else ():
            users[operand].append(k)
    # Sethi and Ullman (1970): the operand that needs more registers comes first, since its result occupies but one.
    needs: list[int] = []  # how many live values each node would need if it were a tree
    for taken, own in zip(operands, work, strict=True):
        # Operand k is computed while k results are held already, the neediest first.
        parts = sorted([needs[k] for k in taken], reverse=True)
        needs.append(max([*(need + k for k, need in enumerate(parts)), int(own is not None)]))
    highest_first = [sorted(taken, key=needs.__getitem__, reverse=True) for taken in operands]
    orders = [list(range(len(nodes))), *(_depth_first(some, highest_first) for some in (roots, roots[::-1]))]
    orders += [_eager(order, work, users) for order in orders]
    return [nodes[k] for k in min(orders, key=lambda order: _live(work, order))]


def _live(work: Work, order: Sequence[int]) -> tuple[int, int]:
    """From the last operation to the first: a value is alive from there on to where it is made."""
    is_alive = bytearray(len(work))
    peak = total = alive = 0
    # Backwards, the last use of a value is met first: there it becomes alive, and it dies where it is made.
    for i in reversed(order):
        taken = work[i]
        if taken is not None:
            alive -= is_alive[i]
            total += alive + 1
            if alive >= peak:
                peak = alive + 1
            for k in taken:
                if not is_alive[k]:
                    is_alive[k] = 1
                    alive += 1
    return peak, total


def _depth_first(roots: Iterable[int], operands: Operands) -> list[int]:
    """Each root in turn, after what it needs, one operand after the other."""
    done: dict[int, None] = {}
    for root in roots:
        stack = [root]
        while stack:
            # A root stays on the stack until its operands are done.
            waiting = [k for k in operands[stack[-1]] if k not in done]
            if waiting:
                stack += waiting[::-1]
            else:
                done[stack.pop()] = None
    return list(done)


def _eager(order: Sequence[int], work: Work, users: Operands) -> list[int]:
    """The order, with operations moved forward that take up no more room than they give back."""
    place = [0] * len(order)
    missing = [0] * len(order)
    # How many operands each operation still waits for, and where it stands in the order.
    for step, i in enumerate(order):
        place[i] = step
        for user in users[i]:
            missing[user] += 1
    uses_left = [len(row) for row in users]
    is_done = bytearray(len(order))
    done: list[int] = []
    free: list[int] = []  # places of what may come at once

    def _offer_users(i: int) -> None:
        for user in users[i]:
            taken = work[user]
            if missing[user] or is_done[user] or taken is None:
                continue
            # It frees as many values as its own result takes up: the operands whose last use it is.
            if len([k for k in taken if uses_left[k] == 1]) >= bool(users[user]):
                heappush(free, place[user])

    for i in order:
        while free or not is_done[i]:
            # What takes up no room comes before the next one of the order.
            node = order[heappop(free)] if free else i
            if is_done[node]:
                continue
            is_done[node] = 1
            done.append(node)
            for user in users[node]:
                missing[user] -= 1
            for k in work[node] or ():
                uses_left[k] -= 1
                # Its last user may now end it.
                if uses_left[k] == 1:
                    _offer_users(k)
            _offer_users(node)
    return done


def reachable(graph: Graph, outputs: Iterable[Ref], known: Container[int] = ()) -> list[int]:
    """The nodes that some outputs need."""
    operands = graph.operands
    seen = {ref >> 1 for ref in outputs if ref >> 1 not in known}
    stack = list(seen)
    while stack:
        for operand in operands[stack.pop()]:
            if operand not in seen and operand not in known:
                seen.add(operand)
                stack.append(operand)
    return sorted(seen)


@dataclass(frozen=True, order=True, slots=True)
class Cost:
    """The cost of a program that stands in a graph; programs are compared by their body, then by their hoisted work."""

    body: int  # of what is computed in every evaluation
    hoisted: int  # of what is computed once per set of run-time parameters
    nodes: int = field(compare=False)  # how many nodes were looked at to find this


def program_cost(graph: Graph, outputs: Sequence[Ref]) -> Cost:
    """The cost of some outputs, what they share counted once."""
    nodes = reachable(graph, outputs)
    costs = dict.fromkeys(Layer, 0)
    for i in nodes:
        costs[graph.layer[i]] += OPERATION_COST[graph.op[i]]
    return Cost(costs[Layer.BODY], costs[Layer.HOISTED], len(nodes))


def copy_leaf(graph: Graph, index: int, fresh: Graph, parameters: Replacements | None = None) -> Ref:
    """Make an input or a constant again in another graph."""
    source = graph.sources.get(index)
    if source is None:
        return fresh.number(graph.constants[index])
    if parameters is not None and source.kind == PARAMETER:
        value = parameters[source.index]
        return fresh.input(value.kind, value.index) if isinstance(value, InputSource) else fresh.number(value)
    return fresh.input(source.kind, source.index)


def apply(graph: Graph, op: Op, operands: Sequence[Ref]) -> Ref:
    """An operation by its kind, folded as if written."""
    return _OPERATIONS[op](graph, *operands)


def copy(
    graph: Graph, outputs: Sequence[Ref], fresh: Graph, known: dict[int, Ref], parameters: Replacements | None = None
) -> tuple[Ref, ...]:
    """Make values again in another graph, folded there as if they were written anew."""
    for i in reachable(graph, outputs, known):
        op = graph.op[i]
        if op in LEAVES:
            known[i] = copy_leaf(graph, i, fresh, parameters)
        else:
            known[i] = apply(fresh, op, [known[k] for k in graph.operands[i]])
    return tuple(signed(known[node_of(ref)], is_negative(ref)) for ref in outputs)


def bake(graph: Graph, outputs: Sequence[Ref], parameters: Replacements) -> tuple[Graph, tuple[Ref, ...]]:
    """Put numbers in the place of a graph's parameters, and fold again."""
    fresh = Graph()
    return fresh, copy(graph, outputs, fresh, {}, parameters)


def cut(graph: Graph, outputs: Sequence[Ref]) -> Tape:
    """The tape of some outputs: what they need, in an order in which few values are alive at a time."""
    order = schedule(graph, outputs)
    number = {old: new for new, old in enumerate(order)}
    nodes = [graph.node(i, number) for i in order]
    tape = Tape(tuple(nodes), tuple(Output(number[node_of(ref)], is_negative(ref)) for ref in outputs))
    results = tuple(
        Output(output.node, False) if output.negative and _turn(nodes, tape.use_counts, output.node) else output
        for output in tape.outputs
    )
    return Tape(tuple(nodes), results)


def _turn(nodes: list[Node], uses: Sequence[int], index: int) -> bool:
    """Change the sign of a value that serves nothing else, if a difference in it can take it: -(a - b) is b - a."""
    stack = [index]
    while stack:
        i = stack.pop()
        node = nodes[i]
        if uses[i] != 1:
            continue
        if node.op is Op.SUBTRACT:
            nodes[i] = replace(node, operands=node.operands[::-1])
            return True
        if node.op in (Op.MULTIPLY, Op.DIVIDE):
            stack.extend(reversed(node.operands))
    return False

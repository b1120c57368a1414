"""Comparisons, cases and choices on a graph: what stands for an *if* in programs without branches.

A case is 1 or 0, so *and* is a product or a minimum, *or* a maximum, and *not* the difference from 1. They are folded
as sums and products are: choices between opposites are opposite, and known cases leave no trace.
"""

from derive.algebra import constants
from derive.programs.tape.graph import ONE, ZERO, Graph, Ref, is_negative, negated, node_of, ref_to, signed
from derive.programs.tape.tape import Layer, Op


def less(graph: Graph, a: Ref, b: Ref) -> Ref:
    """A comparison."""
    left, right = graph.constant_of(a), graph.constant_of(b)
    if left is not None and right is not None:
        return ONE if constants.less(left, right) else ZERO
    if a == b:
        return ZERO
    if is_negative(a) and (is_negative(b) or b == ZERO):
        a, b = negated(b), negated(a)
    elif a == ZERO and is_negative(b):
        a, b = negated(b), ZERO
    return graph.intern(Op.LESS, graph.plain(a), graph.plain(b))


def opposite(graph: Graph, case: Ref) -> Ref:
    """The opposite of a case; that of the opposite is the case."""
    return ref_to(graph.operands[case >> 1][1]) if _is_opposite(graph, case) else graph.subtract(ONE, case)


def is_case(graph: Graph, a: Ref) -> bool:
    """Whether a value is 1 or 0 by the way in which it is written: a comparison, or *and*, *or*, *not* of such."""
    if a in (ZERO, ONE):
        return True
    if is_negative(a):
        return False
    op, operands = graph.op[a >> 1], graph.operands[a >> 1]
    if op in (Op.MULTIPLY, Op.MAXIMUM, Op.MINIMUM):
        return all(is_case(graph, ref_to(k)) for k in operands)
    return op is Op.LESS or (_is_opposite(graph, a) and is_case(graph, ref_to(operands[1])))


def _is_opposite(graph: Graph, case: Ref) -> bool:
    return graph.op[case >> 1] is Op.SUBTRACT and graph.operands[case >> 1][0] == node_of(ONE)


def select(graph: Graph, case: Ref, a: Ref, b: Ref) -> Ref:
    """One of two values; the other one may be anything."""
    known = graph.constant_of(case)
    if known is not None or a == b:
        return b if known == 0 else a
    index = case >> 1
    if _is_opposite(graph, case):
        return select(graph, opposite(graph, case), b, a)
    if a == ONE and b == ZERO:
        return case
    negative = is_negative(a if graph.layer[b >> 1] is Layer.CONSTANT and a != ZERO else b)
    if negative:  # choices between opposites are opposite
        a, b = negated(a), negated(b)
    return signed(graph.intern(Op.SELECT, index, graph.plain(a), graph.plain(b)), negative)


def is_nowhere_negative(graph: Graph, a: Ref) -> bool:
    """Whether a value is at least 0 by the way in which it is written: squares, roots, their sums and the like."""
    stack = [a]
    while stack:
        ref = stack.pop()
        op, operands = graph.op[ref >> 1], graph.operands[ref >> 1]
        is_square = op is Op.MULTIPLY and operands[0] == operands[1]
        if is_negative(ref) or (op is Op.CONSTANT and graph.constants[ref >> 1] < 0):
            return False
        if op in (Op.ADD, Op.MULTIPLY) and not is_square:
            stack += map(ref_to, operands)
        elif not is_square and op not in (Op.CONSTANT, Op.ROOT, Op.ABSOLUTE, Op.LESS):
            return False
    return True


def extreme(graph: Graph, op: Op, a: Ref, b: Ref) -> Ref:
    """The larger or the smaller of two values."""
    left, right = graph.constant_of(a), graph.constant_of(b)
    if left is not None and right is not None:
        return b if constants.less(left, right) == (op is Op.MAXIMUM) else a
    if a == b:
        return a
    for one, other in ((a, b), (b, a)):
        if one in (ZERO, ONE) and is_case(graph, other):
            return other if (one == ZERO) == (op is Op.MAXIMUM) else one
    if op is Op.MAXIMUM and ZERO in (a, b) and is_nowhere_negative(graph, a if b == ZERO else b):
        return a if b == ZERO else b
    negative = (is_negative(a) or a == ZERO) and (is_negative(b) or b == ZERO)
    first, second = sorted(graph.plain(negated(ref) if negative else ref) for ref in (a, b))
    dual = Op.MINIMUM if op is Op.MAXIMUM else Op.MAXIMUM
    return signed(graph.intern(dual if negative else op, first, second), negative)

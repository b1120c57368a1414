"""Straight-line programs: every operation once, in an order in which operands come first.

A tape is what is printed. It holds no joint of any robot and knows no language: nodes, and the outputs as nodes with a
sign. Nodes are in three layers: constants (exact numbers, folded), hoisted work (depends on run-time parameters alone,
done once per call) and the body (depends on the arguments). A change of sign is not an operation: the sign is kept
beside the operand, and only outputs, square roots and the choice among cases ever need one.
"""

import operator
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from enum import IntEnum
from functools import cached_property
from typing import Any

from derive.algebra.constants import Constant


class Op(IntEnum):
    """What a node does."""

    CONSTANT = 0
    INPUT = 1
    ADD = 2
    SUBTRACT = 3
    MULTIPLY = 4
    DIVIDE = 5
    NEGATE = 6
    SINE = 7
    COSINE = 8
    ROOT = 9
    SIGN = 10
    ARCTANGENT = 11
    LESS = 12
    SELECT = 13
    MAXIMUM = 14
    MINIMUM = 15
    ABSOLUTE = 16

    __hash__ = int.__hash__  # that of an enumeration hashes the name, which takes long


LEAVES = (Op.CONSTANT, Op.INPUT)


class Layer(IntEnum):
    """On what a node depends: on nothing, on run-time parameters alone, or on the arguments."""

    CONSTANT = 0
    HOISTED = 1
    BODY = 2


OPERATION_COST: Mapping[Op, int] = {
    **dict.fromkeys(Op, 1),
    **dict.fromkeys((Op.CONSTANT, Op.INPUT, Op.NEGATE, Op.SIGN, Op.ABSOLUTE), 0),
    **dict.fromkeys((Op.SINE, Op.COSINE, Op.ARCTANGENT), 25),
}
"""By what candidates are compared, here and nowhere else; `program_cost` and `polynomial_cost` add it up.

Vectorised over configurations, a sine and a cosine of one angle take as long as 50 to 100 multiplications and
additions, so one more pair must save many of them.
"""

# What languages call the functions that every program may use.
FUNCTION_NAMES = {Op.SINE: "sin", Op.COSINE: "cos", Op.ROOT: "sqrt", Op.SIGN: "sign"}
_CASES = (Op.LESS, Op.SELECT, Op.MAXIMUM, Op.MINIMUM)
BRANCHING_NAMES = {Op.ARCTANGENT: "atan2"} | {op: op.name.lower() for op in (*_CASES, Op.ABSOLUTE)}
"""What languages call the functions of programs that tell cases apart.

`less` is 1 or 0, and so is what says which case holds: products and maxima of such are *and* and *or*.
`select(case, a, b)` is a where the case is not 0, else b; the other one may be anything, not a number too.
"""

ALL_NAMES = FUNCTION_NAMES | BRANCHING_NAMES  # all of them
# What languages have as operators.
ARITHMETIC: Mapping[Op, Callable[..., Any]] = {
    Op.ADD: operator.add,
    Op.SUBTRACT: operator.sub,
    Op.MULTIPLY: operator.mul,
    Op.DIVIDE: operator.truediv,
    Op.NEGATE: operator.neg,
}
# Kind of the inputs that are run-time parameters; any other kind is the name of an argument, such as ``q``.
PARAMETER = "parameter"


@dataclass(frozen=True, slots=True)
class InputSource:
    """Where an input comes from."""

    kind: str  # `PARAMETER`, or the name of an argument
    index: int  # place in it, from 0


@dataclass(frozen=True, slots=True)
class Node:
    """One value of a tape."""

    op: Op  # what makes it
    operands: tuple[int, ...]  # indices of earlier nodes
    layer: Layer  # on what it depends
    value: Constant | None = None  # the number, of a constant
    source: InputSource | None = None  # the input, of an input


@dataclass(frozen=True, slots=True)
class Output:
    """A node with a sign."""

    node: int
    negative: bool


@dataclass(frozen=True, slots=True)
class Operations:
    """How many operations a program costs; signs are free, equal values are computed once."""

    mul: int = 0
    add: int = 0
    div: int = 0
    sin: int = 0
    cos: int = 0
    sqrt: int = 0
    atan2: int = 0
    cases: int = 0

    @property
    def arithmetic(self) -> int:
        """Multiplications, additions and divisions."""
        return self.mul + self.add + self.div

    @property
    def total(self) -> int:
        """All of them."""
        return sum(self.as_dict().values())

    @property
    def cost(self) -> int:
        """By which candidates are compared: each operation at its `OPERATION_COST`."""
        return sum(OPERATION_COST[_COUNTED[name][0]] * count for name, count in self.as_dict().items())

    def as_dict(self) -> dict[str, int]:
        """Counts by name, in the order of the manifest; what tells cases apart is left out where there are none."""
        counts = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: count for name, count in counts.items() if count or name not in _ONLY_WITH_CASES}


_COUNTED = {
    "mul": (Op.MULTIPLY,),
    "add": (Op.ADD, Op.SUBTRACT),
    "div": (Op.DIVIDE,),
    "sin": (Op.SINE,),
    "cos": (Op.COSINE,),
    "sqrt": (Op.ROOT,),
    "atan2": (Op.ARCTANGENT,),
    "cases": _CASES,
}

_ONLY_WITH_CASES = ("atan2", "cases")


@dataclass(frozen=True)
class Tape:
    """A straight-line program."""

    nodes: tuple[Node, ...]  # operands before the nodes that use them; no node is without use
    outputs: tuple[Output, ...]  # the results, row by row

    @cached_property
    def operations(self) -> Operations:
        """Operations per evaluation, hoisted work left out."""
        return self._count(Layer.BODY)

    @cached_property
    def hoisted_operations(self) -> Operations:
        """Operations on run-time parameters alone."""
        return self._count(Layer.HOISTED)

    @cached_property
    def use_counts(self) -> tuple[int, ...]:
        """How often each node is an operand or an output."""
        counts = [0] * len(self.nodes)
        for node in self.nodes:
            for operand in node.operands:
                counts[operand] += 1
        for output in self.outputs:
            counts[output.node] += 1
        return tuple(counts)

    @cached_property
    def hoisted_results(self) -> tuple[int, ...]:
        """Parameters and hoisted values that the body or an output uses, in order."""
        used = {output.node for output in self.outputs}
        for node in self.nodes:
            if node.layer is Layer.BODY:
                used.update(node.operands)
        return tuple(i for i in sorted(used) if self.nodes[i].layer is Layer.HOISTED)

    @cached_property
    def parameters(self) -> tuple[int, ...]:
        """Indices of the run-time parameters in use, ascending."""
        sources = (node.source for node in self.nodes if node.source is not None)
        return tuple(sorted(source.index for source in sources if source.kind == PARAMETER))

    def _count(self, layer: Layer) -> Operations:
        counts = Counter(node.op for node in self.nodes if node.layer is layer)
        return Operations(**{name: sum(counts[op] for op in ops) for name, ops in _COUNTED.items()})


def evaluate(tape: Tape, inputs: Mapping[str, Sequence[Any]], arithmetic: Mapping[str, Any]) -> list[Any]:
    """Run a tape on any numbers."""
    functions = {**ARITHMETIC, **{op: arithmetic[name] for op, name in ALL_NAMES.items() if name in arithmetic}}
    values: list[Any] = []
    for node in tape.nodes:
        if node.op is Op.CONSTANT:
            value = arithmetic["number"](node.value)
        elif node.source is not None:
            value = inputs[node.source.kind][node.source.index]
        else:
            value = functions[node.op](*(values[i] for i in node.operands))
        values.append(value)
    return [-values[o.node] if o.negative else values[o.node] for o in tape.outputs]

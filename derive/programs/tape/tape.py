"""Straight-line programs: every operation once, in an order in which operands come first.

A tape is what is printed. It holds no joint of any robot and knows no language: nodes, and the outputs as nodes with a
sign. Nodes are in three layers: constants (exact numbers, folded), hoisted work (depends on run-time parameters alone,
done once per call) and the body (depends on the arguments). A change of sign is not an operation: the sign is kept
beside the operand, and only outputs and square roots ever need one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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


LEAVES = (Op.CONSTANT, Op.INPUT)
BINARY = (Op.ADD, Op.SUBTRACT, Op.MULTIPLY, Op.DIVIDE)


class Layer(IntEnum):
    """On what a node depends: on nothing, on run-time parameters alone, or on the arguments."""

    CONSTANT = 0
    HOISTED = 1
    BODY = 2


FUNCTION_COST = 25
"""Operations that a sine or a cosine is worth."""

PARAMETER = "parameter"
"""Kind of the inputs that are run-time parameters; any other kind is the name of an argument, such as ``q``."""


@dataclass(frozen=True, slots=True)
class Source:
    """Where an input comes from.

    Attributes:
        kind: `PARAMETER`, or the name of an argument.
        index: Place in it, from 0.
    """

    kind: str
    index: int


@dataclass(frozen=True, slots=True)
class Node:
    """One value of a tape.

    Attributes:
        op: What makes it.
        operands: Indices of earlier nodes.
        layer: On what it depends.
        value: The number, of a constant.
        source: The input, of an input.
    """

    op: Op
    operands: tuple[int, ...]
    layer: Layer
    value: Constant | None = None
    source: Source | None = None


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
        """By which candidates are compared: operations, with sines and cosines at `FUNCTION_COST` each.

        Vectorised over configurations, a sine and a cosine of one angle take as long as 50 to 100 multiplications and
        additions, so one more pair must save many of them.
        """
        return self.arithmetic + self.sqrt + FUNCTION_COST * (self.sin + self.cos)

    def as_dict(self) -> dict[str, int]:
        """Counts by name, in the order of the manifest."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


_COUNTED = {
    Op.MULTIPLY: "mul",
    Op.ADD: "add",
    Op.SUBTRACT: "add",
    Op.DIVIDE: "div",
    Op.SINE: "sin",
    Op.COSINE: "cos",
    Op.ROOT: "sqrt",
}


@dataclass(frozen=True)
class Tape:
    """A straight-line program.

    Attributes:
        nodes: Operands before the nodes that use them; no node is without use.
        outputs: The results, row by row.
    """

    nodes: tuple[Node, ...]
    outputs: tuple[Output, ...]

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
        counts: dict[str, int] = {}
        for node in self.nodes:
            if node.layer is layer and node.op in _COUNTED:
                name = _COUNTED[node.op]
                counts[name] = counts.get(name, 0) + 1
        return Operations(**counts)


def evaluate(tape: Tape, inputs: Mapping[str, Sequence[Any]], arithmetic: Mapping[str, Any]) -> list[Any]:
    """Run a tape on any numbers.

    Args:
        tape: The program.
        inputs: Values by kind: ``q``, ..., and `PARAMETER`.
        arithmetic: ``number`` (from an exact constant), ``sin``, ``cos``, ``sqrt``, ``sign``.

    Returns:
        The outputs.
    """
    values: list[Any] = []
    for node in tape.nodes:
        values.append(_evaluate_node(node, values, inputs, arithmetic))
    return [-values[o.node] if o.negative else values[o.node] for o in tape.outputs]


def _evaluate_node(
    node: Node, values: list[Any], inputs: Mapping[str, Sequence[Any]], arithmetic: Mapping[str, Any]
) -> Any:
    operands = [values[i] for i in node.operands]
    match node.op:
        case Op.CONSTANT:
            return arithmetic["number"](node.value)
        case Op.INPUT:
            assert node.source is not None
            return inputs[node.source.kind][node.source.index]
        case Op.ADD:
            return operands[0] + operands[1]
        case Op.SUBTRACT:
            return operands[0] - operands[1]
        case Op.MULTIPLY:
            return operands[0] * operands[1]
        case Op.DIVIDE:
            return operands[0] / operands[1]
        case Op.NEGATE:
            return -operands[0]
        case _:
            return arithmetic[FUNCTION_NAMES[node.op]](operands[0])


FUNCTION_NAMES = {Op.SINE: "sin", Op.COSINE: "cos", Op.ROOT: "sqrt", Op.SIGN: "sign"}

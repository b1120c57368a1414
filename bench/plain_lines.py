"""A tape as plain NumPy lines, one statement per operation: what a code printer without further thought writes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bench.robots import Array
from derive.algebra.constants import to_float
from derive.programs.program import Function
from derive.programs.tape.tape import FUNCTION_NAMES, Layer, Node, Op

_SIGNS = {Op.ADD: "+", Op.SUBTRACT: "-", Op.MULTIPLY: "*", Op.DIVIDE: "/"}


def plain_lines(function: Function) -> str:
    """A module with one function ``lines(out, q, qd, qdd)`` of columns, (N,) each; ``out`` is (N, *shape).

    Raises:
        NotImplementedError: The robot has parameters without a number.
    """
    names: dict[int, str] = {}
    body = []
    for i, node in enumerate(function.tape.nodes):
        if node.layer is Layer.HOISTED:
            raise NotImplementedError("free parameters are left out")
        names[i] = _leaf(node) or f"t{i}"
        if names[i] == f"t{i}":
            body.append(f"    t{i} = {_written(node, [names[k] for k in node.operands])}")
    width = function.shape[-1]
    for place, output in enumerate(function.tape.outputs):
        entry = f"{place}" if len(function.shape) == 1 else f"{place // width}, {place % width}"
        body.append(f"    out[:, {entry}] = {'-' if output.negative else ''}{names[output.node]}")
    head = ["from numpy import cos, sign, sin, sqrt", "", "", f"def lines(out, {', '.join(function.arguments)}):"]
    return "\n".join([*head, *body, "    return out", ""])


def _leaf(node: Node) -> str | None:
    if node.value is not None:
        return f"({to_float(node.value)!r})"
    return f"{node.source.kind}[{node.source.index}]" if node.source is not None else None


def _written(node: Node, operands: Sequence[str]) -> str:
    if node.op is Op.NEGATE:
        return f"-{operands[0]}"
    if node.op in _SIGNS:
        return f"{operands[0]} {_SIGNS[node.op]} {operands[1]}"
    return f"{FUNCTION_NAMES[node.op]}({operands[0]})"


def columns(array: Array) -> list[Any]:
    """The columns of (N, n), each contiguous."""
    return [column.copy() for column in array.T]

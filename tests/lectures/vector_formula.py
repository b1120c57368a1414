"""Evaluates printed vector equations such as ``cross(wd, p) + 2*cross(w, z_prev*qd)``; nothing is executed."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

OPERATIONS: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.MatMult: lambda a, b: a @ b,
}


def vector_value(text: str, values: Mapping[str, Any]) -> Any:
    """The value of an equation's right-hand side."""
    return _value(ast.parse(text, mode="eval").body, values)


def _value(node: ast.expr, values: Mapping[str, Any]) -> Any:
    match node:
        case ast.BinOp(left, operator, right):
            return OPERATIONS[type(operator)](_value(left, values), _value(right, values))
        case ast.UnaryOp(ast.USub(), operand):
            return -_value(operand, values)
        case ast.Call(ast.Name("cross"), [a, b], []):
            return np.cross(_value(a, values), _value(b, values))
        case ast.Name(name):
            return values[name]
        case ast.Constant(int() | float() as number):
            return number
    raise ValueError(ast.dump(node))

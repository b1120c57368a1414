"""The float value of a SymPy expression: every shared subexpression once, no code generated."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import sympy

_FUNCTIONS = {
    sympy.sin: math.sin,
    sympy.cos: math.cos,
    sympy.tan: math.tan,
    sympy.atan: math.atan,
    sympy.acos: math.acos,
    sympy.asin: math.asin,
    sympy.Abs: abs,
    sympy.atan2: math.atan2,
    sympy.sign: lambda x: float(np.sign(x)),
    sympy.Pow: pow,
    sympy.Add: lambda *x: math.fsum(x),
    sympy.Mul: lambda *x: math.prod(x),
}


def evaluate(expression: Any, values: Mapping[str, float]) -> Any:
    known: dict[Any, float] = {}
    if hasattr(expression, "shape"):
        entries = [_value(x, values, known) for x in expression]
        return np.array(entries, dtype=float).reshape(expression.shape)
    return _value(sympy.sympify(expression), values, known)


def _value(expression: Any, values: Mapping[str, float], known: dict[Any, float]) -> float:
    stack = [expression]
    while stack:
        node = stack[-1]
        if node in known:
            stack.pop()
        elif node.is_Symbol:
            known[node] = values[node.name]
        elif not node.args:
            known[node] = float(node)
        elif missing := [a for a in node.args if a not in known]:
            stack.extend(missing)
        else:
            known[node] = _FUNCTIONS[node.func](*(known[a] for a in node.args))
    return known[expression]

"""Operations of printed Python code, found by parsing it; nothing is run."""

from __future__ import annotations

import ast
from collections import Counter

from bench.counting.counts import Counts

_BINARY = {ast.Mult: "mul", ast.Add: "add", ast.Sub: "add", ast.Div: "div"}
_TRIGONOMETRIC = {"sin", "cos"}


def count_python(source: str, function: str) -> Counts:
    """Operations of one function of a module.

    Args:
        source: Text of the module.
        function: Name of a straight-line function in it.

    Returns:
        Every operator once for each time that it is written; equal calls of sine or cosine count once.
    """
    for node in ast.parse(source).body:
        if isinstance(node, ast.FunctionDef) and node.name == function:
            return count_nodes(node)
    raise KeyError(function)


def count_nodes(tree: ast.AST) -> Counts:
    """Operations of a piece of code."""
    counter: Counter[str] = Counter()
    calls: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp):
            counter.update(_binary(node))
        elif isinstance(node, ast.Call):
            calls.add(ast.unparse(node))
    names = [name for name in map(_called, calls) if name not in ("absolute", "sign")]  # free
    counter["trig"] = sum(name in _TRIGONOMETRIC for name in names)
    counter["other"] = len(names) - counter["trig"]
    return Counts(**counter)


def _binary(node: ast.BinOp) -> dict[str, int]:
    """An operator; a power with a whole exponent k is k - 1 multiplications."""
    if isinstance(node.op, ast.Pow):
        exponent = ast.literal_eval(node.right)
        if not isinstance(exponent, int) or exponent < 1:
            raise ValueError(f"not a count of multiplications: {ast.unparse(node)}")
        return {"mul": exponent - 1}
    return {_BINARY[type(node.op)]: 1}


def _called(text: str) -> str:
    return text.split("(", 1)[0].rsplit(".", 1)[-1]

"""What an expression in a xacro file may say: numbers, texts, lists and the functions that xacro offers for them.

xacro hands expressions to Python without its builtins. That keeps nobody in: a generator knows the frame that runs it,
and names within a lambda are not looked at, so a file from elsewhere could run any command. Expressions are looked at
here before xacro sees them, each time it is about to evaluate one, since one expansion may write the next.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

# Names that lead from values to the program that runs.
INNER = re.compile(r"__|(gi|cr|ag|tb)_(frame|code|yieldfrom|await|next)$|f_(back|builtins|code|globals|locals|trace)$")
OPENERS = ("type", "vars")  # functions of xacro that do the same


def forbidden(expression: str) -> str | None:
    """The name for which an expression is not evaluated.

    Returns:
        The name; None where there is none, or where it is no expression, which xacro says itself.
    """
    try:
        tree = ast.parse(expression.strip(), mode="eval")
    except (SyntaxError, ValueError):
        return None
    names = (str(getattr(node, "attr", "") or getattr(node, "id", "")) for node in ast.walk(tree))
    return next((name for name in names if INNER.match(name)), None)


@contextmanager
def guarded() -> Iterator[list[str]]:
    """Have xacro evaluate no expression that says more than it may, as long as the context lasts."""
    import xacro
    from xacro import substitution_args

    offered: dict[str, Any] = xacro._global_symbols["python"]
    kept, braces, parentheses = dict(offered), xacro.safe_eval, substitution_args._eval
    for name in OPENERS:
        offered.pop(name, None)
    refused: list[str] = []
    xacro.safe_eval, substitution_args._eval = (_only_allowed(each, refused) for each in (braces, parentheses))
    try:
        yield refused
    finally:
        xacro.safe_eval, substitution_args._eval = braces, parentheses
        offered.update(kept)


def _only_allowed(evaluator: Callable[..., Any], refused: list[str]) -> Callable[..., Any]:
    """An evaluator of xacro that refuses names which lead out of the file, and notes them."""

    def _checked(expression: str, *context: Any) -> Any:
        name = forbidden(expression)
        if name is not None:
            refused.append(name)
            raise ValueError(f"an expression uses {name}")
        return evaluator(expression, *context)

    return _checked

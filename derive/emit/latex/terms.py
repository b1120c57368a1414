"""Named intermediate terms: brackets that occur more than once get a symbol of their own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import sympy

SHORTEST = 3
"""Terms of a bracket that gets a name when it occurs twice."""

OFTEN = 4
"""Uses after which a bracket of two products gets one too."""

Definition = tuple[Any, Any]


def extract(expressions: Sequence[Any]) -> tuple[list[Definition], list[Any]]:
    """Names the brackets that several places share.

    Args:
        expressions: Entries of one quantity.

    Returns:
        Definitions (symbol, expression), each using earlier symbols only, and the entries with the symbols in them. The
        symbols are called ``_1``, ``_2``, ..., which no name of a user can be.
    """
    uses: Counter[Any] = Counter()
    for expression in expressions:
        _count(expression, uses, root=True)
    shared = [bracket for bracket, count in uses.items() if _is_worth(bracket, count)]
    shared.sort(key=_depth)
    names: dict[Any, Any] = {}
    definitions = []
    for index, bracket in enumerate(shared, 1):
        symbol = sympy.Symbol(f"_{index}")
        definitions.append((symbol, _replaced(bracket, names)))
        names[bracket] = symbol
    return definitions, [_replaced(expression, names) for expression in expressions]


def needed(definitions: Sequence[Definition], expressions: Sequence[Any]) -> list[Definition]:
    """The definitions that some expressions use, directly or through each other."""
    wanted = {symbol for expression in expressions for symbol in expression.free_symbols}
    kept = []
    for symbol, value in reversed(definitions):
        if symbol in wanted:
            kept.append((symbol, value))
            wanted |= value.free_symbols
    return kept[::-1]


def _count(expression: Any, uses: Counter[Any], root: bool) -> None:
    """Counts brackets; the inside of one that was met before is not counted again."""
    if expression.is_Add and not root:
        uses[expression] += 1
        if uses[expression] > 1:
            return
    for argument in expression.args:
        if argument.args:
            _count(argument, uses, root=False)


def _is_worth(bracket: Any, uses: int) -> bool:
    if len(bracket.args) >= SHORTEST:
        return uses > 1
    return uses >= OFTEN and any(len(term.args) > SHORTEST - 1 for term in bracket.args)


def _depth(expression: Any) -> int:
    """Levels of sums; a bracket is deeper than the brackets in it."""
    inner = max((_depth(argument) for argument in expression.args), default=0)
    return inner + bool(expression.is_Add)


def _replaced(expression: Any, names: dict[Any, Any]) -> Any:
    """The expression with symbols for the brackets inside it; the outermost sum stays."""
    if not names or not expression.args:
        return expression
    if not expression.is_Add:
        return _substituted(expression, names)
    return expression.func(*(_substituted(term, names) for term in expression.args), evaluate=False)


def _substituted(expression: Any, names: dict[Any, Any]) -> Any:
    if expression in names:
        return names[expression]
    if not expression.args:
        return expression
    arguments = tuple(_substituted(argument, names) for argument in expression.args)
    if all(new is old for new, old in zip(arguments, expression.args, strict=True)):
        return expression
    if expression.is_Add or expression.is_Mul:
        return expression.func(*arguments, evaluate=False)
    return expression.func(*arguments)

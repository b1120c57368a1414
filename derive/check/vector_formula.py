"""Printed vector equations such as ``cross(wd, p) + 2*cross(w, z_prev*qd)`` as trees.

The smallest change that repairs a printed vector equation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import islice
from typing import Any

import numpy as np
from lark import Lark, Token
from lark.exceptions import UnexpectedInput
from lark.visitors import Transformer_NonRecursive

from derive.check.diagnosis import Repair
from derive.check.edits import Kind
from derive.errors import CheckError, Location, quoted
from derive.robot.expression import Name
from derive.robot.parser import place

Array = Any

MAX_LENGTH = 400
"""Characters; three times the longest equation of the books, and no tree of them is too deep."""

GRAMMAR = """
start: sum
sum: first ((PLUS | MINUS) product)*
first: product | MINUS product -> negative
product: atom ((TIMES | AT) atom)*
?atom: NAME -> name
     | NUMBER -> number
     | "cross" "(" sum "," sum ")" -> cross
     | "(" sum ")" -> group
PLUS: "+"
MINUS: "-"
TIMES: "*"
AT: "@"
NAME: /(?!cross\\b)[A-Za-z][A-Za-z0-9_]*/
NUMBER: /[0-9]+(\\.[0-9]+)?/
%ignore /[ \\t\\r\\n]+/
"""


@dataclass(frozen=True, slots=True)
class Vector:
    """A node: a name, a number, or an operation on the nodes below.

    Attributes:
        operation: ``name``, ``number``, ``+``, ``*``, ``@``, ``cross`` or ``-`` (of one part).
        text: The name, or the digits.
        parts: The nodes below.
    """

    operation: str
    text: str = ""
    parts: tuple[Vector, ...] = ()

    def __str__(self) -> str:
        match self.operation:
            case "name" | "number":
                return self.text
            case "cross":
                return f"cross({self.parts[0]}, {self.parts[1]})"
            case "-":
                return f"-{_bracketed(self.parts[0])}"
            case "+":
                rest = (f" - {str(p)[1:]}" if p.operation == "-" else f" + {p}" for p in self.parts[1:])
                return str(self.parts[0]) + "".join(rest)
            case _:
                sign = " @ " if self.operation == "@" else "*"
                return sign.join(map(_bracketed, self.parts))


def _bracketed(part: Vector) -> str:
    return f"({part})" if part.operation in "+-" else str(part)


def read_vector(text: str, where: Location) -> Vector:
    """A printed vector equation's right-hand side.

    Args:
        text: Sums, products with numbers (``*``), products with matrices (``@``), ``cross(a, b)``.
        where: Where its first character stands.

    Raises:
        CheckError: Outside the grammar.
    """
    if len(text) > MAX_LENGTH:
        raise CheckError("vector equation too long", allowed=f"at most {MAX_LENGTH} characters", location=where)
    try:
        return _Builder().transform(_parser().parse(text))
    except UnexpectedInput as error:
        at = min(getattr(error, "pos_in_stream", None) or 0, len(text))
        found, there = f"vector equation {quoted(text, 80)}", place(text, at, where)
        raise CheckError(found, allowed="names, numbers, + - * @, cross(a, b)", location=there) from None


def value_of(e: Vector, values: Mapping[str, Array]) -> Array:
    """The value of an equation; KeyError for an unknown name, ValueError where shapes do not fit."""
    match e.operation:
        case "name":
            return values[e.text]
        case "number":
            return float(e.text)
    parts = [value_of(part, values) for part in e.parts]
    return _OPERATIONS[e.operation](parts)


def nodes(e: Vector) -> Iterator[tuple[Vector, Callable[[Vector], Vector]]]:
    """Every node with the function that puts another in its place."""
    yield e, lambda new: new
    for i, part in enumerate(e.parts):
        for node, put in nodes(part):
            yield node, _putter(e, i, put)


def _putter(e: Vector, i: int, put: Callable[[Vector], Vector]) -> Callable[[Vector], Vector]:
    return lambda new: replace(e, parts=(*e.parts[:i], put(new), *e.parts[i + 1 :]))


def _times(parts: list[Array]) -> Array:
    return parts[0] * parts[1]


def _added(parts: list[Array]) -> Array:
    if len({np.shape(part) for part in parts}) > 1:
        raise ValueError("a sum of vectors and scalars")
    return sum(parts[1:], start=parts[0])


def _cross(parts: list[Array]) -> Array:
    a, b = parts
    if np.shape(a) != (3,) or np.shape(b) != (3,):
        raise ValueError("a cross product of something else than vectors")
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


_OPERATIONS: Mapping[str, Callable[[list[Array]], Array]] = {
    "+": _added,
    "-": lambda parts: -parts[0],
    "*": _times,
    "@": lambda parts: parts[0] @ parts[1],
    "cross": _cross,
}


@cache
def _parser() -> Lark:
    return Lark(GRAMMAR, parser="lalr")


class _Builder(Transformer_NonRecursive[Token, Vector]):
    def start(self, children: list[Any]) -> Vector:
        return children[0]  # type: ignore[no-any-return]

    first = group = start

    def negative(self, children: list[Any]) -> Vector:
        return Vector("-", parts=(children[1],))

    def sum(self, children: list[Any]) -> Vector:
        if len(children) == 1:
            return children[0]  # type: ignore[no-any-return]
        pairs = zip(children[1::2], children[2::2], strict=True)
        signed = [Vector("-", parts=(term,)) if sign == "-" else term for sign, term in pairs]
        return Vector("+", parts=(children[0], *signed))

    def product(self, children: list[Any]) -> Vector:
        found = children[0]
        for sign, factor in zip(children[1::2], children[2::2], strict=True):
            found = Vector(str(sign), parts=(found, factor))
        return found  # type: ignore[no-any-return]

    def cross(self, children: list[Any]) -> Vector:
        return Vector("cross", parts=tuple(children))

    def name(self, children: list[Any]) -> Vector:
        return Vector("name", str(children[0]))

    def number(self, children: list[Any]) -> Vector:
        return Vector("number", str(children[0]))


Holds = Callable[[Vector], bool]
Change = tuple[Kind, str, Vector]

MAX_TRIES = 10_000


def diagnose_vector(printed: Vector, names: Sequence[str], holds: Holds) -> Repair | None:
    """One change that makes an equation hold, or two names of the same letter.

    Args:
        printed: The printed right-hand side.
        names: What may stand in it.
        holds: Whether an equation is right.
    """
    for make in (_signs, _relatives, _operations, _others):
        for kind, text, changed in islice(make(printed, names), MAX_TRIES):
            if holds(changed):
                return Repair((kind,), text, Name(str(changed)))
    return _two_names(printed, names, holds)


def _two_names(printed: Vector, names: Sequence[str], holds: Holds) -> Repair | None:
    pairs = (
        (kind, f"2 changes: {first}; {second}", twice)
        for kind, first, changed in _relatives(printed, names)
        for _, second, twice in _relatives(changed, names)
    )
    for kind, text, twice in islice(pairs, MAX_TRIES):
        if holds(twice):
            return Repair((kind, kind), text, Name(str(twice)))
    return None


def _signs(e: Vector, _: Sequence[str]) -> Iterator[Change]:
    for node, put in nodes(e):
        if node.operation == "+":
            for i, term in enumerate(node.parts):
                other = term.parts[0] if term.operation == "-" else Vector("-", parts=(term,))
                parts = (*node.parts[:i], other, *node.parts[i + 1 :])
                yield Kind.SIGN, f"sign of {term}", put(Vector("+", parts=parts))


def _relatives(e: Vector, names: Sequence[str]) -> Iterator[Change]:
    """Names with the same first letter: another dot, another index."""
    yield from _renamed(e, names, Kind.INDEX, lambda a, b: a[0] == b[0])


def _others(e: Vector, names: Sequence[str]) -> Iterator[Change]:
    yield from _renamed(e, names, Kind.SYMBOL, lambda a, b: a[0] != b[0])


def _renamed(e: Vector, names: Sequence[str], kind: Kind, fits: Callable[[str, str], bool]) -> Iterator[Change]:
    for node, put in nodes(e):
        if node.operation == "name":
            for name in names:
                if name != node.text and fits(name, node.text):
                    yield kind, f"{kind.words}: {name} instead of {node.text}", put(Vector("name", name))


def _operations(e: Vector, _: Sequence[str]) -> Iterator[Change]:
    """A cross product where a sum is meant, and the other way round."""
    for node, put in nodes(e):
        if node.operation == "cross" or (node.operation == "+" and len(node.parts) == 2):
            other = Vector("+" if node.operation == "cross" else "cross", parts=node.parts)
            yield Kind.SYMBOL, f"operation: {other} instead of {node}", put(other)

"""Printed vector equations such as ``cross(wd, p) + 2*cross(w, z_prev*qd)`` as trees, and what repairs them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import islice
from typing import Any

import numpy as np
from lark import Lark, Token
from lark.exceptions import UnexpectedInput
from lark.visitors import Transformer_NonRecursive

from derive.checking.formulas.diagnosis import Repair
from derive.checking.formulas.edits import SlipKind
from derive.errors import CheckError, Location, quoted
from derive.robot.expression import Name
from derive.robot.parser import place

Array = Any

MAX_LENGTH = 400  # characters; three times the longest equation of the books, and no tree of them is too deep
GRAMMAR = """
?start: sum
?sum: first ((PLUS | MINUS) product)*
?first: product | MINUS product -> negative
?product: atom ((TIMES | AT) atom)*
?atom: NAME -> name
     | NUMBER -> number
     | "cross" "(" sum "," sum ")" -> cross
     | "(" sum ")"
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
    """A node: a name, a number, or an operation on the nodes below."""

    operation: str  # ``name``, ``number``, ``+``, ``*``, ``@``, ``cross`` or ``-`` (of one part)
    text: str = ""  # the name, or the digits
    parts: tuple[Vector, ...] = ()  # the nodes below

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
    """A printed vector equation's right-hand side."""
    if len(text) > MAX_LENGTH:
        allowed = f"allowed: at most {MAX_LENGTH} characters"
        raise CheckError("vector equation too long", allowed=allowed, location=where)
    try:
        return _VectorBuilder().transform(_parser().parse(text))
    except UnexpectedInput as error:
        at = min(getattr(error, "pos_in_stream", None) or 0, len(text))
        found, there = f"vector equation {quoted(text, 80)}", place(text, at, where)
        raise CheckError(found, allowed="allowed: names, numbers, + - * @, cross(a, b)", location=there) from None


@cache
def _parser() -> Lark:
    return Lark(GRAMMAR, parser="lalr")


class _VectorBuilder(Transformer_NonRecursive[Token, Vector]):
    def __default__(self, data: str, children: list[Any], meta: object) -> Vector:
        """What a rule of the grammar makes of its parts."""
        match data, children:
            case (("name" | "number"), (token,)):
                return Vector(str(data), str(token))
            case "negative", (_, product):
                return Vector("-", parts=(product,))
            case "cross", (a, b):
                return Vector("cross", parts=(a, b))
            case "sum", (first, *rest):
                pairs = zip(rest[::2], rest[1::2], strict=True)
                signed = (Vector("-", parts=(term,)) if sign == "-" else term for sign, term in pairs)
                return Vector("+", parts=(first, *signed))
            case "product", (first, *rest):
                found: Vector = first
                for sign, factor in zip(rest[::2], rest[1::2], strict=True):
                    found = Vector(str(sign), parts=(found, factor))
                return found
        raise AssertionError(data)


def value_of(e: Vector, values: Mapping[str, Array]) -> Array:
    """The value of an equation whose names stand for numbers, vectors (3,) and matrices (3, 3)."""
    if e.operation == "name":
        return values[e.text]
    if e.operation == "number":
        return float(e.text)
    parts = [value_of(part, values) for part in e.parts]
    match e.operation:
        case "+":
            if len({np.shape(part) for part in parts}) > 1:
                raise ValueError("a sum of vectors and scalars")
            return sum(parts[1:], start=parts[0])
        case "-":
            return -parts[0]
        case "*":
            return parts[0] * parts[1]
        case "@":
            return parts[0] @ parts[1]
    a, b = parts
    if np.shape(a) != (3,) or np.shape(b) != (3,):
        raise ValueError("a cross product of something else than vectors")
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def names_in(e: Vector) -> Iterator[str]:
    """Every name in an equation, in order of appearance."""
    if e.operation == "name":
        yield e.text
    for part in e.parts:
        yield from names_in(part)


Change = tuple[SlipKind, str, Vector]

MAX_TRIES = 10_000  # changes of one kind that are tried, so that the search ends for the longest equation too


def diagnose_vector(printed: Vector, names: Sequence[str], holds: Callable[[Vector], bool]) -> Repair | None:
    """One change that makes an equation hold, or two names of the same letter; None where no such change does."""
    relatives = partial(_changes, "relative", names)
    for what in ("sign", "relative", "operation", "other"):
        for kind, text, changed in islice(_everywhere(printed, partial(_changes, what, names)), MAX_TRIES):
            if holds(changed):
                return Repair((kind,), text, Name(str(changed)))
    # two names of the same letters: a link's index mistaken throughout one term
    pairs = (
        (kind, f"2 changes: {first}; {second}", twice)
        for kind, first, changed in _everywhere(printed, relatives)
        for _, second, twice in _everywhere(changed, relatives)
    )
    for kind, text, twice in islice(pairs, MAX_TRIES):
        if holds(twice):
            return Repair((kind, kind), text, Name(str(twice)))
    return None


def _everywhere(e: Vector, change: Callable[[Vector], Iterator[Change]]) -> Iterator[Change]:
    """The equation with one of its nodes changed, for every node from the root down."""
    yield from change(e)
    for i, part in enumerate(e.parts):
        for kind, text, changed in _everywhere(part, change):
            yield kind, text, replace(e, parts=(*e.parts[:i], changed, *e.parts[i + 1 :]))


def _changes(what: str, names: Sequence[str], node: Vector) -> Iterator[Change]:
    """The changes of one sort at one node; relatives have the same first letter, another dot or another index."""
    match what, node.operation:
        case "sign", "+":
            for i, term in enumerate(node.parts):
                other = term.parts[0] if term.operation == "-" else Vector("-", parts=(term,))
                turned = Vector("+", parts=(*node.parts[:i], other, *node.parts[i + 1 :]))
                yield SlipKind.SIGN, f"sign of {term}", turned
        case (("relative" | "other"), "name"):
            kind = SlipKind.INDEX if what == "relative" else SlipKind.SYMBOL
            for name in names:
                if name != node.text and (name[0] == node.text[0]) is (what == "relative"):
                    yield kind, f"{kind.value}: {name} instead of {node.text}", Vector("name", name)
        case "operation", "cross" | "+" if len(node.parts) == 2:  # a cross product where a sum is meant, or the reverse
            exchanged = Vector("+" if node.operation == "cross" else "cross", parts=node.parts)
            yield SlipKind.SYMBOL, f"operation: {exchanged} instead of {node}", exchanged

"""The smallest change that repairs a printed vector equation."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import islice

from derive.check.diagnosis import Repair
from derive.check.edits import Kind
from derive.check.vector_formula import Vector, nodes
from derive.robot.expression import Name

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

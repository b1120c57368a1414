"""A generated function before its tape is chosen: its interface, and the formulations that compute it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from derive.algebra.program import Column
from derive.algebra.tape_graph import Graph
from derive.algebra.tape_price import price
from derive.algebra.tape_value import Value


@dataclass(frozen=True, slots=True)
class Candidate:
    """One way to compute a function.

    Attributes:
        formulation: In words, for the generated file.
        values: The outputs, row by row.
    """

    formulation: str
    values: Callable[[], Sequence[Value]]


@dataclass(frozen=True, slots=True)
class Specification:
    """A function before its tape is chosen.

    Attributes:
        name: For instance ``inverse_dynamics``.
        arguments: Kinds of its arguments, in order; may be empty.
        shape: Of the result for one configuration.
        candidates: Formulations of the same values; the one of least `Operations.cost` is emitted, the first of equals.
        columns: What the entries along the last axis of the result belong to, where that has names.
        search: Whether a long search for shared parts pays.
    """

    name: str
    arguments: tuple[str, ...]
    shape: tuple[int, ...]
    candidates: tuple[Candidate, ...]
    columns: tuple[Column, ...] = ()
    search: bool = True


def near(graph: Graph, candidates: Iterable[Candidate], factor: float) -> tuple[Candidate, ...]:
    """Those worth improving: as traced they cost no more than ``factor`` times the cheapest."""
    known = [Candidate(candidate.formulation, _held(candidate.values())) for candidate in candidates]
    prices = [price(graph, [v.ref for v in candidate.values()])[0] for candidate in known]
    return tuple(c for c, found in zip(known, prices, strict=True) if found <= factor * min(prices))


def _held(values: Sequence[Value]) -> Callable[[], Sequence[Value]]:
    return lambda: values

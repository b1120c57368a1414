"""What the solver of arms without formulas takes of an arm in C: lengths of arrays, and how joints are eliminated."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import prod

from derive.programs.program import Elimination, InverseSearch, Way
from derive.robot.robot import Robot

_LEAST = 4
"""Length of the sides of square matrices, at least: compilers warn of loops that never run on shorter ones."""


@dataclass(frozen=True, slots=True)
class CSearch:
    """Numbers and initialisers for the templates below ``c/search``.

    Attributes:
        eliminations: Each as the inside of an array.
        is_position: Whether the position alone is wanted.
        free: Indices of the joints that are solved for, as the inside of an array.
        free_count: How many.
        given_joints: Indices of the others; a number that is none where there are none.
        given_count: How many.
        entry_rows: Rows of the entries of T that are wanted.
        entry_columns: Their columns.
        entry_count: How many.
        signs: Factors of the joint variables.
        ways: Most ways around the loop of an elimination.
        rows: Most equations of one.
        columns: Most unknown products.
        size: Most eigenvalues.
        most: Solutions that are kept.
        motions: By which poses are brought beside singular ones, each as the inside of an array.
    """

    eliminations: tuple[str, ...]
    is_position: bool
    free: str
    free_count: int
    given_joints: str
    given_count: int
    entry_rows: str
    entry_columns: str
    entry_count: int
    signs: str
    ways: int
    rows: int
    columns: int
    size: int
    most: int
    motions: tuple[str, ...]


def c_search(search: InverseSearch, robot: Robot) -> CSearch:
    """The solver's numbers.

    Args:
        search: How solutions are found; with eliminations.
        robot: The robot.

    Returns:
        Texts and numbers.
    """
    free = [joint for joint in range(robot.n) if joint not in search.given]
    size = max(each.rows[1] + 2 * each.rows[2] for each in search.eliminations)
    return CSearch(
        eliminations=tuple(map(_initialiser, search.eliminations)),
        is_position=all(column == 3 for _, column in search.entries),
        free=_listed(free),
        free_count=len(free),
        given_joints=_listed(search.given or (-1,)),
        given_count=len(search.given),
        entry_rows=_listed(row for row, _ in search.entries),
        entry_columns=_listed(column for _, column in search.entries),
        entry_count=len(search.entries),
        signs=_listed(float(joint.sign) for joint in robot.joints),
        ways=max(len(each.ways) for each in search.eliminations),
        rows=max(sum(way.equations for way in each.ways) for each in search.eliminations),
        columns=max(_LEAST, *(max(sum(each.rows), _products(each)) for each in search.eliminations)),
        size=max(_LEAST, size),
        most=max(search.branches, 8 * size),
        motions=tuple(map(_listed, search.motions)),
    )


def _products(elimination: Elimination) -> int:
    """How many products of the joints beside the hidden one there are."""
    way = elimination.finish
    met = {(way.dropped + way.direction * place) % way.joints for place in range(way.eliminated + 1)}
    others = [joint for joint in range(way.joints) if joint not in met and joint != elimination.hidden]
    return prod((2 if joint in elimination.straight else 3) + (joint == elimination.multiplied) for joint in others)


def _initialiser(elimination: Elimination) -> str:
    multiplied = -1 if elimination.multiplied is None else elimination.multiplied
    straight = sum(1 << joint for joint in elimination.straight)
    ways = ", ".join(map(_way, elimination.ways))
    head = f"{elimination.start}, {elimination.hidden}, {multiplied}, {{{_listed(elimination.rows)}}}"
    return f"{{{head}, {straight}, {len(elimination.ways)}, {{{ways}}}, {_way(elimination.finish)}}}"


def _way(way: Way) -> str:
    numbers = (way.dropped, way.direction, way.eliminated, way.equations, way.constant, way.linear)
    return f"{{{_listed(numbers)}}}"


def _listed(values: Iterable[float]) -> str:
    return ", ".join(map(str, values))

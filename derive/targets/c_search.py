"""What the solver of arms without formulas takes of an arm in C: lengths of arrays, and how joints are eliminated."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import prod

from derive.programs.program import Elimination, InverseSearch, Way
from derive.robot.robot import Robot

_LEAST = 4  # length of the sides of square matrices, at least: compilers warn of loops that never run on shorter ones


@dataclass(frozen=True, slots=True)
class CSearch:
    """Numbers and initialisers for the templates below ``c/search``."""

    eliminations: tuple[str, ...]  # each as the inside of an array
    is_position: bool  # whether the position alone is wanted
    free: str  # indices of the joints that are solved for, as the inside of an array
    free_count: int  # how many
    given_joints: str  # indices of the others; a number that is none where there are none
    given_count: int  # how many
    entry_rows: str  # rows of the entries of T that are wanted
    entry_columns: str  # their columns
    entry_count: int  # how many
    signs: str  # factors of the joint variables
    ways: int  # most ways around the loop of an elimination
    rows: int  # most equations of one
    columns: int  # most unknown products
    size: int  # most eigenvalues
    most: int  # solutions that are kept
    motions: tuple[str, ...]  # by which poses are brought beside singular ones, each as the inside of an array


def c_search(search: InverseSearch, robot: Robot) -> CSearch:
    """The solver's numbers."""
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

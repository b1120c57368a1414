"""Which square blocks of J a robot is judged by.

Six joints: all of J, about the wrist centre if axes 4, 5 and 6 meet there, for then J_12 = 0 and det J = det J_11 det
J_22 (Siciliano et al., Robotics, sec. 3.3.1). Fewer joints: the rows that are not zero everywhere, if these are as many
as joints; else the first rows, linear ones first, whose determinant is not zero everywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from derive.algebra.ring import Polynomial, determinant
from derive.model.kinematics import Column, Kinematics, Reference, jacobian_columns

ALL = (1, 2, 3, 4, 5, 6)


@dataclass(frozen=True)
class SquareBlock:
    """A square block of J.

    Attributes:
        name: ``J``, or ``J_11`` and ``J_22`` of a block triangular J.
        rows: Its rows of J, from 1.
        columns: Its columns of J, from 1.
        reference: The point and the axes.
        entries: Its entries, row by row.
        others_are_zero: Whether the rows of J that are left out are zero everywhere.
    """

    name: str
    rows: tuple[int, ...]
    columns: tuple[int, ...]
    reference: Reference
    entries: tuple[tuple[Polynomial, ...], ...]
    others_are_zero: bool

    def determinant(self) -> Polynomial:
        """Its determinant."""
        return determinant(self.entries)


def square_blocks(kinematics: Kinematics) -> tuple[SquareBlock, ...]:
    """The diagonal blocks whose determinants multiply to the one that is looked for.

    Empty if all square blocks of n rows are singular in every configuration.
    """
    if kinematics.robot.n == 6:
        return _six(kinematics)
    return _few(kinematics)


# -- six joints


def _six(kinematics: Kinematics) -> tuple[SquareBlock, ...]:
    centre = _wrist_centre(kinematics)
    if centre is None:
        references = [Reference(k, k) for k in range(7)]
        return (_shortest(kinematics, "J", ALL, ALL, references),)
    references = [Reference(k, centre) for k in range(7)]
    return (
        _shortest(kinematics, "J_11", ALL[:3], ALL[:3], references),
        _shortest(kinematics, "J_22", ALL[3:], ALL[3:], references),
    )


def _wrist_centre(kinematics: Kinematics) -> int | None:
    """The DH frame in whose origin axes 4, 5 and 6 meet, or None."""
    if not all(joint.is_revolute for joint in kinematics.robot.joints[3:]):
        return None
    for point in (4, 5, 3, 6):
        columns = jacobian_columns(kinematics, Reference(point, point))
        if not any(entry for column in columns[3:] for entry in column[:3]):
            return point
    return None


def _shortest(
    kinematics: Kinematics,
    name: str,
    rows: tuple[int, ...],
    columns: tuple[int, ...],
    references: Sequence[Reference],
) -> SquareBlock:
    """The block about the reference where its entries have the fewest terms; the axes of the world only for ties."""
    blocks = [_block(name, rows, columns, r, jacobian_columns(kinematics, r)) for r in references]
    return min(blocks, key=lambda block: sum(len(entry) for row in block.entries for entry in row))


# -- fewer joints


def _few(kinematics: Kinematics) -> tuple[SquareBlock, ...]:
    for candidate in _candidates(kinematics):
        if candidate.determinant():
            return (candidate,)
    return ()


def _candidates(kinematics: Kinematics) -> Iterator[SquareBlock]:
    n = kinematics.robot.n
    at_end = [Reference(), Reference(frame=0)]
    yield from _nonzero_rows(kinematics, at_end)
    world = jacobian_columns(kinematics, at_end[0])
    make = _maker(n, at_end[0], world)
    if n == 3:
        yield make((1, 2, 3))
    yield from _nonzero_rows(kinematics, [Reference(frame, m) for m in range(n + 1) for frame in (None, 0)])
    for rows in combinations(ALL, n):
        yield make(rows)


def _nonzero_rows(kinematics: Kinematics, references: Sequence[Reference]) -> Iterator[SquareBlock]:
    """The rows that are not zero everywhere, where they are as many as the joints."""
    n = kinematics.robot.n
    for reference in references:
        columns = jacobian_columns(kinematics, reference)
        rows = tuple(r for r in ALL if any(column[r - 1] for column in columns))
        if len(rows) == n:
            yield _maker(n, reference, columns)(rows)


def _maker(n: int, reference: Reference, columns: Sequence[Column]) -> Callable[[tuple[int, ...]], SquareBlock]:
    return lambda rows: _block("J", rows, tuple(range(1, n + 1)), reference, columns)


def _block(
    name: str, rows: tuple[int, ...], columns: tuple[int, ...], reference: Reference, entries: Sequence[Column]
) -> SquareBlock:
    chosen = tuple(tuple(entries[c - 1][r - 1] for c in columns) for r in rows)
    others = (entries[c - 1][r - 1] for c in columns for r in ALL if r not in rows)
    return SquareBlock(name, rows, columns, reference, chosen, not any(others))

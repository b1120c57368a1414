"""Which square blocks of J a robot is judged by.

Six joints: all of J, about the wrist centre if axes 4, 5 and 6 meet there, for then J_12 = 0 and det J = det J_11 det
J_22 (Siciliano et al., Robotics, sec. 3.3.1). Fewer joints: the rows that are not zero everywhere, if these are as many
as joints; else the first rows, linear ones first, whose determinant is not zero everywhere. Rows are those of the
world, or of frame 0 where the base is slanted, since the rank is the same and the entries are not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from derive.algebra.ring import Polynomial, determinant
from derive.model.kinematics import JacobianColumn, Kinematics, Reference, jacobian_columns
from derive.robot.expression import ONE, ZERO, number
from derive.robot.robot import Robot

ALL = (1, 2, 3, 4, 5, 6)


@dataclass(frozen=True)
class SquareBlock:
    """A square block of J, exact.

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

    Args:
        kinematics: Of an arm with at most six joints.

    Returns:
        One block, or J_11 and J_22; none if all square blocks of n rows are singular in every configuration.
    """
    if kinematics.robot.n < 6:
        return next(((block,) for block in _candidates(kinematics) if block.determinant()), ())
    centre = _wrist_centre(kinematics)
    if centre is None:
        return (_shortest(kinematics, "J", ALL, [Reference(k, k) for k in range(7)]),)
    references = [Reference(k, centre) for k in range(7)]
    return (
        _shortest(kinematics, "J_11", ALL[:3], references),
        _shortest(kinematics, "J_22", ALL[3:], references),
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
    kinematics: Kinematics, name: str, places: tuple[int, ...], references: Sequence[Reference]
) -> SquareBlock:
    """The diagonal block about the reference where its entries have the fewest terms; the first of equals."""
    blocks = [_block(name, places, places, r, jacobian_columns(kinematics, r)) for r in references]
    return min(blocks, key=lambda block: sum(len(entry) for row in block.entries for entry in row))


def _candidates(kinematics: Kinematics) -> Iterator[SquareBlock]:
    """Blocks of all columns of an arm with fewer than six joints, in the order in which they are preferred."""
    n, end = kinematics.robot.n, Reference(frame=0 if _is_slanted(kinematics.robot) else None)
    columns = tuple(range(1, n + 1))
    yield from _nonzero_rows(kinematics, [Reference(), Reference(frame=0)])
    entries = jacobian_columns(kinematics, end)
    if n == 3:
        yield _block("J", (1, 2, 3), columns, end, entries)
    yield from _nonzero_rows(kinematics, [Reference(frame, m) for m in range(n + 1) for frame in (None, 0)])
    for rows in combinations(ALL, n):
        yield _block("J", rows, columns, end, entries)


def _is_slanted(robot: Robot) -> bool:
    """Whether the base turns frame 0 so that no axis of it is one of the world."""
    return not all(cell in (ZERO, ONE, number(-1)) for row in robot.base[:3] for cell in row[:3])


def _nonzero_rows(kinematics: Kinematics, references: Sequence[Reference]) -> Iterator[SquareBlock]:
    """The rows that are not zero everywhere, where they are as many as the joints."""
    n = kinematics.robot.n
    for reference in references:
        columns = jacobian_columns(kinematics, reference)
        rows = tuple(r for r in ALL if any(column[r - 1] for column in columns))
        if len(rows) == n:
            yield _block("J", rows, tuple(range(1, n + 1)), reference, columns)


def _block(
    name: str,
    rows: tuple[int, ...],
    columns: tuple[int, ...],
    reference: Reference,
    entries: Sequence[JacobianColumn],
) -> SquareBlock:
    chosen = tuple(tuple(entries[c - 1][r - 1] for c in columns) for r in rows)
    others = (entries[c - 1][r - 1] for c in columns for r in ALL if r not in rows)
    return SquareBlock(name, rows, columns, reference, chosen, not any(others))

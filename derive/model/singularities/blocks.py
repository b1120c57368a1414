"""Which matrix an arm is judged by: all of J, or the rows of a task of as many coordinates as it has joints.

A task is that of the robot file; else the one that is natural for the arm: the coordinates in which it moves if these
are as many as its joints (the plane of a planar arm and the turn about its normal, x, y, z and the turn of a SCARA, the
orientation of a wrist), the position for three other joints, the position in its plane for two. Rows are those of the
world, or of frame 0 where the base is slanted, since the rank is the same and the entries are not.

Six joints: all of J, about the wrist centre if axes 4, 5 and 6 meet there, for then J_12 = 0 and det J = det J_11 det
J_22 (Siciliano et al., Robotics, sec. 3.3.1).
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

from derive.algebra.ring import Polynomial, TooManyTerms, determinant
from derive.mechanics.exact_kinematics import JacobianColumn, Kinematics, Reference, jacobian_columns
from derive.mechanics.vectors import column, dot
from derive.robot.expression import ONE, ZERO, number
from derive.robot.options.inverse import FREEDOMS, POSE, TASKS

ALL = (1, 2, 3, 4, 5, 6)


@dataclass(frozen=True)
class SquareBlock:
    """A square block of J, exact."""

    name: str  # ``J``, or ``J_11`` and ``J_22`` of a block triangular J
    rows: tuple[int, ...]  # its rows of J, from 1; none where they are combinations of these
    columns: tuple[int, ...]  # its columns of J, from 1
    reference: Reference  # the point and the axes
    entries: tuple[tuple[Polynomial, ...], ...]  # its entries, row by row
    others_are_zero: bool  # whether the rows of J that are left out are zero everywhere
    task: tuple[str, ...] = ()  # what its rows are the velocities of; empty for all of J

    def determinant(self) -> Polynomial:
        """Its determinant."""
        return determinant(self.entries)


def square_blocks(kinematics: Kinematics) -> tuple[SquareBlock, ...]:
    """The diagonal blocks whose determinants multiply to the wanted one; none where no square one decides."""
    robot = kinematics.robot
    if robot.inverse.task != POSE:
        is_square = sum(FREEDOMS.get(word, 1) for word in robot.inverse.task) == robot.n
        return (min(_task_rows(kinematics), key=_length),) if is_square else ()
    if robot.n < 5:
        return next(((block,) for block in _candidates(kinematics) if block.determinant()), ())
    if robot.n != 6:
        return ()
    for point in (4, 5, 3, 6) if all(joint.is_revolute for joint in robot.joints[3:]) else ():
        # Joints 4, 5, 6 do not move a point on all their axes: the linear parts of their columns are zero. About this
        # wrist centre J_12 = 0, and the determinant is det J_11 det J_22.
        columns = jacobian_columns(kinematics, Reference(point, point))
        if not any(entry for column in columns[3:] for entry in column[:3]):
            references, halves = [Reference(k, point) for k in range(7)], (("J_11", ALL[:3]), ("J_22", ALL[3:]))
            return tuple(_shortest(kinematics, name, places, references) for name, places in halves)
    return (_shortest(kinematics, "J", ALL, [Reference(k, k) for k in range(7)]),)


def _shortest(
    kinematics: Kinematics, name: str, places: tuple[int, ...], references: Sequence[Reference]
) -> SquareBlock:
    """The diagonal block about the reference where its entries have the fewest terms; the first of equals."""
    blocks = [_block(name, places, places, r, jacobian_columns(kinematics, r)) for r in references]
    return min(blocks, key=_length)


def _length(block: SquareBlock) -> int:
    return sum(len(entry) for row in block.entries for entry in row)


def matrices(kinematics: Kinematics) -> Iterator[Sequence[Sequence[Polynomial]]]:
    """Rows of J that decide for an arm without a square block, in several axes and about several points."""
    robot = kinematics.robot
    if robot.inverse.task != POSE:
        yield from (block.entries for block in _task_rows(kinematics))
        return
    for k in range(robot.n + 1) if robot.n <= 7 else (robot.n // 2,):
        with suppress(TooManyTerms):
            yield tuple(zip(*jacobian_columns(kinematics, Reference(k, k)), strict=True))


def task_words(task: Sequence[str]) -> tuple[str, ...]:
    """A task of the robot file with its name, where it has one: ``position``."""
    return next(((name,) for name, rows in TASKS.items() if rows == tuple(task)), tuple(task))


def _task_rows(kinematics: Kinematics) -> Iterator[SquareBlock]:
    """The Jacobian of the file's task, in all axes that it allows; the two of the approach are the end effector's."""
    robot, turn, derivative = kinematics.robot, kinematics.end.rotation, kinematics.domain.derivative
    task, joints, angular = robot.inverse.task, range(robot.n), kinematics.angular_columns(robot.n)
    is_turned = len({"x", "y", "z"} & set(task)) in (0, 3)
    for frame in (None, *range((robot.n + 1) * is_turned)):
        of_arm = tuple(zip(*jacobian_columns(kinematics, Reference(frame)), strict=True))
        numbers, rows = list[int](), list[tuple[Polynomial, ...]]()
        for word in task:
            if word == "phi":  # the numerator of the derivative of atan2(r21, r11)
                across, along = turn[1][0], turn[0][0]
                rows.append(tuple(along * derivative(across, k) - across * derivative(along, k) for k in joints))
            elif word == "approach":
                rows += [tuple(dot(column(turn, i), w) for w in angular) for i in (0, 1)]
            else:
                numbers += [4, 5, 6] if word == "orientation" else ["xyz".index(word) + 1]
                rows += [of_arm[number - 1] for number in numbers[len(rows) :]]
        known = tuple(numbers) if len(numbers) == len(rows) else ()
        columns = tuple(joint + 1 for joint in joints)
        yield SquareBlock("J", known, columns, Reference(frame), tuple(rows), False, task_words(task))


def _candidates(kinematics: Kinematics) -> Iterator[SquareBlock]:
    """Blocks of all columns of an arm with a natural task, in the order in which they are preferred."""
    n, base = kinematics.robot.n, kinematics.robot.base
    # A slanted base turns frame 0 so that its axes are none of the world.
    is_straight = all(cell in (ZERO, ONE, number(-1)) for row in base[:3] for cell in row[:3])
    end = Reference(frame=None if is_straight else 0)
    columns = tuple(range(1, n + 1))
    yield from _nonzero_rows(kinematics, [Reference(), Reference(frame=0)])
    if n == 3:
        yield _block("J", (1, 2, 3), columns, end, jacobian_columns(kinematics, end))
    frames = (None, *range(n + 1))
    yield from _nonzero_rows(kinematics, [Reference(k, m) for m in (None, *range(n + 1)) for k in frames])


def _nonzero_rows(kinematics: Kinematics, references: Sequence[Reference]) -> Iterator[SquareBlock]:
    """The coordinates in which an arm moves, where they are as many as the joints; of two joints in a plane its own."""
    n = kinematics.robot.n
    for reference in references:
        columns = jacobian_columns(kinematics, reference)
        rows = tuple(r for r in ALL if any(column[r - 1] for column in columns))
        linear, angular = (tuple(r for r in rows if (r > 3) == is_turn) for is_turn in (False, True))
        if n == 2 and reference.point is None and (len(linear), len(angular)) == (2, 1):
            rows = linear
        if len(rows) == n and (len(angular) <= 1 or rows == (4, 5, 6)):
            yield _block("J", rows, tuple(range(1, n + 1)), reference, columns)


def _block(
    name: str, rows: tuple[int, ...], columns: tuple[int, ...], reference: Reference, entries: Sequence[JacobianColumn]
) -> SquareBlock:
    chosen = tuple(tuple(entries[c - 1][r - 1] for c in columns) for r in rows)
    others = (entries[c - 1][r - 1] for c in columns for r in ALL if r not in rows)
    # What the rows are the velocities of.
    turns = rows[sum(r <= 3 for r in rows) :]
    names = ("x", "y", "z", "rotation about x", "rotation about y", "phi" if len(turns) == 1 else "rotation about z")
    words = ("orientation",) if turns == (4, 5, 6) else task_words([names[r - 1] for r in rows])
    task = words if len(entries) < 6 else ()
    return SquareBlock(name, rows, columns, reference, chosen, not any(others), task)

"""Which letter the named intermediate terms of each quantity have: a number for each, all different on one sheet.

Small numbers get a letter of their own, larger ones a letter with two indices, see `Symbols.term`.
"""

from __future__ import annotations

T, J, B, CHRISTOFFEL, C, N, TORQUE, POTENTIAL = range(8)
"""The quantities; g and tau have the same, for they stand in different parts."""

_FIRST_FRAME = 8
_PER_FRAME = 3

SINGULARITY_BLOCKS = 60
"""The one or two blocks of J whose determinants are taken."""

DETERMINANT = 62
_FIRST_AXES = 90

_FIRST_BODY = 1000
"""From here on single bodies; before them the quantities and the transforms."""

_PER_BODY = 5
KINETIC = _FIRST_BODY - 1
DERIVATIVE = _FIRST_BODY - 2


def row(i: int) -> int:
    """The transform A_i.

    Args:
        i: Row of the table, from 1; n + 1 is the position of the end effector.

    Returns:
        Its group.
    """
    return _FIRST_FRAME + _PER_FRAME * (i - 1)


def factor(start: int) -> int:
    """A product of some rows in the middle of the arm.

    Args:
        start: The frame it starts from, from 0.

    Returns:
        Its group.
    """
    return row(start + 1) + 1


def product(i: int) -> int:
    """The product of the first rows, T_i^0.

    Args:
        i: The frame it leads to, from 0.

    Returns:
        Its group.
    """
    return row(i + 1) + 2


def axis(n: int, frame: int, column: int) -> int:
    """The axis or the origin of a frame; above all transforms.

    Args:
        n: Number of joints.
        frame: The frame, from 0.
        column: 3 for the axis, 4 for the origin.

    Returns:
        Its group.
    """
    return max(_FIRST_AXES, row(n + 3)) + 2 * frame + column - 3


def body(index: int, quantity: int) -> int:
    """A quantity of a link or rotor.

    Args:
        index: Place of the body among all bodies, from 0.
        quantity: 0 for its part of B, 1 and 2 for its Jacobians, 3 for its place.

    Returns:
        Its group.
    """
    return _FIRST_BODY + _PER_BODY * index + quantity

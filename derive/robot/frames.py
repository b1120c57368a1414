"""The constant transforms before frame 0 and after frame n."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from derive.errors import RobotFileError
from derive.robot.cells import Cells
from derive.robot.document import Document
from derive.robot.evaluate import evaluate
from derive.robot.expression import ONE, ZERO, Expression, names
from derive.robot.robot import IDENTITY, Matrix

ROTATION_TOLERANCE = 1e-6
"""Entries of R^T R - 1: decimals with seven places pass, 0.7071 does not, and should be sqrt(2)/2."""

_BOTTOM = (ZERO, ZERO, ZERO, ONE)


def read_frame(document: Document, cells: Cells, key: str) -> Matrix:
    """The 4x4 matrix under ``base`` or ``tool``, translations in metres; the identity where there is none.

    Raises:
        RobotFileError: A bottom row that is not 0 0 0 1.
    """
    if document.find((key,)) is None:
        return IDENTITY
    rows = tuple(tuple(_entry(cells, key, row, column) for column in range(4)) for row in range(4))
    if rows[3] != _BOTTOM:
        raise document.error(
            (key, 3), "bottom row is not 0, 0, 0, 1", remedy="write the translation into the last column"
        )
    return rows


def _entry(cells: Cells, key: str, row: int, column: int) -> Expression:
    read = cells.length if column == 3 and row < 3 else cells.plain
    return read((key, row, column))


def check_rotation(document: Document, key: str, matrix: Matrix, trials: Iterable[Mapping[str, float]]) -> None:
    """Refuse a rotation block that is not a rotation at the given parameter values.

    Args:
        document: The file.
        key: ``base`` or ``tool``.
        matrix: The 4x4 matrix.
        trials: Sets of parameter values; those at which an entry is not real are passed over.

    Raises:
        RobotFileError: At the row (or the pair of rows) that is not orthonormal, for a reflection, or when no set of
            values gives real entries.
    """
    blocks = [block for values in trials if (block := _rotation_block(matrix, values)) is not None]
    if not blocks:
        raise document.error((key,), "the rotation block has no real value", "allowed: a rotation")
    symbolic = any(True for row in matrix[:3] for entry in row[:3] for _ in names(entry))
    for block in blocks:
        _check_block(document, key, block, symbolic)


def _rotation_block(matrix: Matrix, values: Mapping[str, float]) -> list[list[float]] | None:
    try:
        return [[evaluate(entry, values) for entry in row[:3]] for row in matrix[:3]]
    except ArithmeticError:
        return None


def _check_block(document: Document, key: str, block: list[list[float]], symbolic: bool) -> None:
    for i in range(3):
        for j in range(i + 1):
            wanted = 1.0 if i == j else 0.0
            product = sum(x * y for x, y in zip(block[i], block[j], strict=True))
            if abs(product - wanted) > ROTATION_TOLERANCE:
                raise _not_orthonormal(document, key, i, j, product, symbolic)
    if _determinant(block) < 0:
        raise document.error(
            (key,), "reflection: the rotation block has determinant -1", remedy="change the sign of one column"
        )


def _not_orthonormal(document: Document, key: str, i: int, j: int, product: float, symbolic: bool) -> RobotFileError:
    found = (
        f"row {i + 1} of the rotation block has length {product**0.5:.9g}"
        if i == j
        else f"rows {j + 1} and {i + 1} of the rotation block have the scalar product {product:.3g}"
    )
    remedy = "write angles exactly: cos(pi/4), sqrt(2)/2"
    if symbolic:
        remedy = "it must be a rotation for all values of its names: write cos(beta) and sin(beta)"
    return document.error((key, i), found, f"allowed: a rotation to within {ROTATION_TOLERANCE:g}", remedy)


def _determinant(m: list[list[float]]) -> float:
    return (
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    )

"""Rows of the Denavit-Hartenberg table: which cell moves, its sign, and the constant rest.

The constant transforms before frame 0 and after frame n.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from derive.errors import RobotFileError, quoted
from derive.robot.cells import Cells, check_symbol
from derive.robot.description import IDENTITY, Joint, JointType, Matrix
from derive.robot.document import Document, KeyPath
from derive.robot.evaluate import evaluate
from derive.robot.expression import ONE, ZERO, Expression, Name, add, linear_terms, multiply, names, number
from derive.robot.limits import FILE_LIMITS
from derive.robot.printer import to_text

_CONSTANT_CELLS = ("a", "alpha")


def read_joints(document: Document, cells: Cells) -> tuple[Joint, ...]:
    """All rows of the table.

    Raises:
        RobotFileError: Too many rows, two joints with one variable, or a contradictory row.
    """
    rows = document.length(("joints",))
    if not 1 <= rows <= FILE_LIMITS.joints:
        raise document.error(("joints",), f"{rows} rows", f"allowed: 1 to {FILE_LIMITS.joints}", "one row per joint")
    variables = _variables(document, rows)
    return tuple(_Row(document, cells, variables, row).read() for row in range(rows))


def _variables(document: Document, rows: int) -> tuple[str, ...]:
    found: dict[str, int] = {}
    for row in range(rows):
        path = ("joints", row, "q")
        scalar = document.scalar(path)
        name = scalar.text if scalar else f"q{row + 1}"
        check_symbol(document, path, name)
        if name in found:
            raise document.error(
                path if scalar else path[:-1],
                f"variable '{name}' belongs to row {found[name] + 1} already",
                remedy="give every joint its own variable: q: ...",
            )
        found[name] = row
    return tuple(found)


class _Row:
    def __init__(self, document: Document, cells: Cells, variables: tuple[str, ...], row: int) -> None:
        self._document = document
        self._cells = cells
        self._variables = frozenset(variables)
        self._variable = variables[row]
        self._path: KeyPath = ("joints", row)
        type_cell = document.scalar((*self._path, "type"))
        self._type = JointType(type_cell.text if type_cell else "")
        self._moving = "theta" if self._type is JointType.REVOLUTE else "d"

    def read(self) -> Joint:
        """The joint of this row."""
        self._refuse_variables_elsewhere()
        sign, rest = self._moving_cell()
        return Joint(
            type=self._type,
            variable=self._variable,
            sign=sign,
            theta=self._radians("theta", rest if self._moving == "theta" else self._raw("theta")),
            d=self._cells.to_metres(rest if self._moving == "d" else self._raw("d")),
            a=self._cells.to_metres(self._raw("a")),
            alpha=self._radians("alpha", self._raw("alpha")),
            limits=self._limits(),
        )

    def _raw(self, key: str, default: Expression = ZERO) -> Expression:
        return self._cells.raw((*self._path, key), default)

    def _radians(self, key: str, expression: Expression) -> Expression:
        return self._cells.to_radians((*self._path, key), expression)

    def _refuse_variables_elsewhere(self) -> None:
        fixed = "d" if self._moving == "theta" else "theta"
        for key in (*_CONSTANT_CELLS, fixed):
            for name in names(self._raw(key)):
                if name in self._variables:
                    raise self._wrong_cell(key, name)

    def _wrong_cell(self, key: str, name: str) -> RobotFileError:
        own = name == self._variable
        swapped = own and key in ("theta", "d")
        other = "prismatic" if self._type is JointType.REVOLUTE else "revolute"
        remedy = f"write type: {other}, or move {name} to {self._moving}" if swapped else "use another name"
        return self._document.error(
            (*self._path, key),
            f"joint variable '{name}' in the cell {key} of a {self._type.value} joint",
            f"allowed: only in the cell {self._moving}, and only the row's own variable '{self._variable}'",
            remedy,
        )

    def _moving_cell(self) -> tuple[int, Expression]:
        """Sign of the variable and constant rest of the cell that moves, before units."""
        expression = self._raw(self._moving, Name(self._variable))
        coefficient = Fraction(0)
        rest: list[Expression] = []
        for factor, term in linear_terms(expression):
            if term == Name(self._variable):
                coefficient += factor
            elif moved := [name for name in names(term) if name in self._variables]:
                raise self._bad_variable(moved[0], expression)
            else:
                rest.append(multiply(number(factor), term))
        if abs(coefficient) != 1:
            raise self._bad_coefficient(coefficient, expression)
        constant = add(*rest) if rest else ZERO
        return int(coefficient), constant

    def _bad_variable(self, name: str, expression: Expression) -> RobotFileError:
        path = (*self._path, self._moving)
        shown = quoted(to_text(expression))
        if name != self._variable:
            return self._document.error(
                path,
                f"variable '{name}' of another joint in {shown}",
                f"allowed: the row's own variable '{self._variable}'",
                "coupled joints are not supported; write the coupling into the motion, not into the table",
            )
        return self._document.error(
            path,
            f"{shown} is not {name} plus a constant",
            f"allowed: {name}, -{name}, with a constant added",
        )

    def _bad_coefficient(self, coefficient: Fraction, expression: Expression) -> RobotFileError:
        path, name = (*self._path, self._moving), self._variable
        if coefficient != 0:
            return self._document.error(
                path,
                f"factor {coefficient} of the variable '{name}'",
                "allowed: +1 or -1",
                "rescale the variable, not the cell",
            )
        others = [other for other in names(expression) if other not in self._variables]
        hint = f"; if '{others[0]}' is the variable, write q: {others[0]}" if others else ""
        return self._document.error(
            path,
            f"{quoted(to_text(expression))} is constant, but {self._moving} is the cell that moves in a "
            f"{self._type.value} joint",
            f"allowed: {name} or -{name}, with a constant added",
            f"leave the cell out or write {self._moving}: {name} + ...; a figure's position is no part of the "
            f"table{hint}",
        )

    def _limits(self) -> tuple[Expression, Expression] | None:
        path = (*self._path, "limits")
        if self._document.find(path) is None:
            return None
        read = self._cells.angle if self._type is JointType.REVOLUTE else self._cells.length
        lower, upper = read((*path, 0)), read((*path, 1))
        for expression in (lower, upper):
            for name in names(expression):
                if name in self._variables:
                    raise self._document.error(
                        path, f"joint variable '{name}' in limits", "allowed: numbers and parameters"
                    )
        return lower, upper


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

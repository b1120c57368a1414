"""What the parts of kinematics share: symbols of frames, transforms as blocks, base and tool.

Some rows and columns of a quantity, as a quantity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from derive.handout.context import Context
from derive.handout.layout.lines import EQUALS, Equation, equation_lines, fits, matrix, pack
from derive.handout.layout.quantity import LaidOut, Namer, places
from derive.handout.notation.pieces import Box, concatenate, italic, joined, script
from derive.handout.quantity import Quantity
from derive.handout.tables import DataPrinter
from derive.robot.description import IDENTITY, Matrix
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Submatrix:
    """Rows and columns of a quantity, counted from 1.

    Attributes:
        whole: The quantity.
        rows: Its rows.
        columns: Its columns.
    """

    whole: Quantity
    rows: tuple[int, ...]
    columns: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.rows), len(self.columns)

    def terms(self, row: int, column: int) -> int:
        """Number of terms of an entry when multiplied out."""
        return self.whole.terms(self.rows[row - 1], self.columns[column - 1])

    def entry(self, row: int, column: int) -> Any:
        """The expression of an entry."""
        return self.whole.entry(self.rows[row - 1], self.columns[column - 1])


def column(whole: Quantity, index: int, rows: tuple[int, ...]) -> Submatrix:
    """Part of a column."""
    return Submatrix(whole, rows, (index,))


def total_terms(quantity: Quantity) -> int:
    """Number of terms of all entries."""
    return sum(quantity.terms(*place) for place in places(quantity.shape))


BASE = Box("\\mathbf{T}_{\\mathrm{base}}", 30.0)
TOOL = Box("\\mathbf{T}_{\\mathrm{tool}}", 30.0)

FEW_FACTORS = 8
"""So many factors of a product are all written; of more the first and the last."""

_DOTS = Box("\\cdots ", 15.0)
_FIRST_GROUP = 8
_GROUPS_PER_FRAME = 3
_FIRST_AXES_GROUP = 90


@dataclass(frozen=True, slots=True)
class Whole:
    """A small matrix that fits on a line and may share it.

    Attributes:
        box: ``symbol = [...]``.
        block: The same as a block of its own.
    """

    box: Box
    block: LaidOut


def rows_group(frame: int) -> int:
    """Group of the intermediate terms of A_frame."""
    return _FIRST_GROUP + _GROUPS_PER_FRAME * (frame - 1)


def factor_group(start: int) -> int:
    """Group of the intermediate terms of a partial product from frame ``start``."""
    return rows_group(start + 1) + 1


def step_group(frame: int) -> int:
    """Group of the intermediate terms of the product of the first rows up to ``frame``, from 0."""
    return rows_group(frame + 1) + 2


def axes_group(robot: Robot, frame: int, column: int) -> int:
    """Group of the intermediate terms of axis (column 3) or origin (column 4) of a frame from 0; above all others."""
    return max(_FIRST_AXES_GROUP, rows_group(robot.n + 3)) + 2 * frame + column - 3


def entry_namer(symbol: Box, comma: str = "") -> Namer:
    """Entries of a matrix that has no letter of its own: (A)_{12}."""

    def entry(row: int, column: int) -> Box:
        return script(concatenate(Box("(", 5.0), symbol, Box(")", 5.0)), italic(f"{row}{comma}{column}"))

    return entry


def transform_block(context: Context, symbol: Box, quantity: Quantity, group: int) -> LaidOut:
    """A transform between two frames."""
    return context.layouter.block(symbol, entry_namer(symbol), quantity, group=group)


def whole(context: Context, symbol: Box, quantity: Quantity, namer: Namer) -> Whole | None:
    """A small matrix as one box; None if it is too wide or too long."""
    rows, columns = (range(1, size + 1) for size in quantity.shape)
    if total_terms(quantity) > context.policy.matrix_terms:
        return None
    entries = {place: quantity.entry(*place) for place in places(quantity.shape)}
    cells = [[joined(context.printer.pieces(entries[i, j])) for j in columns] for i in rows]
    box = concatenate(symbol, EQUALS, matrix(cells))
    if not fits(box, len(rows)):
        return None
    values = tuple((namer(*place), value) for place, value in entries.items() if quantity.terms(*place))
    return Whole(box, LaidOut((box.tex,), values=values, blanks=(symbol.tex,)))


def packed(items: Sequence[Whole]) -> LaidOut:
    """Small matrices side by side, as one block."""
    return LaidOut(
        tuple(pack(item.box for item in items)),
        values=tuple(value for item in items for value in item.block.values),
        blanks=tuple(blank for item in items for blank in item.block.blanks),
    )


def product_of_rows(context: Context) -> list[Box]:
    """The factors A_1 ... A_n, those in the middle by dots if there are many."""
    n = context.robot.n
    if n <= FEW_FACTORS:
        return [context.symbols.frame("A", i, i - 1) for i in range(1, n + 1)]
    shown = [context.symbols.frame("A", i, i - 1) for i in (1, 2, 3, n)]
    return [*shown[:3], _DOTS, shown[3]]


def between_base_and_tool(robot: Robot, factors: Sequence[Box]) -> list[Box]:
    """The factors of the arm with those of base and tool, where these are not the identity."""
    base = [BASE] if robot.base != IDENTITY else []
    tool = [TOOL] if robot.tool != IDENTITY else []
    return [*base, *factors, *tool]


def constant_frames(data: DataPrinter) -> list[str]:
    """Lines with base and tool, where they are not the identity."""
    frames = ((BASE, data.robot.base), (TOOL, data.robot.tool))
    return [line for symbol, frame in frames if frame != IDENTITY for line in _constant_frame(data, symbol, frame)]


def _constant_frame(data: DataPrinter, symbol: Box, frame: Matrix) -> list[str]:
    cells = [[data.value(cell) for cell in row] for row in frame]
    box = concatenate(symbol, EQUALS, matrix([[joined(cell) for cell in row] for row in cells]))
    if fits(box, 4):
        return [box.tex]
    name = entry_namer(symbol)
    named = [Equation(name(i, j), cell) for i, row in enumerate(cells, 1) for j, cell in enumerate(row, 1)]
    return equation_lines(named)

"""Places equations and matrices on lines of the page's width.

What is short shares a line, a matrix that fits is printed as a matrix, a long sum is broken over lines.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from derive.emit.latex.lines import LINE_WIDTH, break_lines
from derive.emit.latex.metrics import RELATION_WIDTH, Box, concatenate
from derive.emit.latex.pieces import Piece

LANDSCAPE_WIDTH = 710.0
"""Width of a line on a page turned on its side [pt]."""

GAP = Box(" \\qquad ", 20.0)
"""Between two equations on one line."""

TALLEST_MATRIX = 40
"""Rows of a matrix that a page can hold."""

BREAK_AFTER = 250
"""Rows in one display; TeX sets a display as a whole, and its memory is finite."""

EQUALS = Box(" = ", RELATION_WIDTH)
_COLUMN_GAP = 10.0
_DELIMITERS = 15.0


@dataclass(frozen=True, slots=True)
class Equation:
    """``left = right``.

    Attributes:
        left: The symbol that is defined.
        right: The expression.
    """

    left: Box
    right: tuple[Piece, ...]

    @property
    def width(self) -> float:
        """Width on one line [pt]."""
        return self.left.width + RELATION_WIDTH + sum(piece.box.width for piece in self.right)


def displays(lines: Sequence[str]) -> list[str]:
    """Rows of displayed mathematics, a few dozen in each display."""
    return [_display(lines[k : k + BREAK_AFTER]) for k in range(0, len(lines), BREAK_AFTER)]


def _display(lines: Sequence[str]) -> str:
    body = " \\\\\n".join(f"& {line.rstrip()}" for line in lines)
    return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"


def equation_lines(equations: Iterable[Equation], width: float = LINE_WIDTH) -> list[str]:
    """Equations in their order; neighbours that fit share a line."""
    lines: list[str] = []
    row: list[Box] = []
    for equation in equations:
        head = concatenate(equation.left, EQUALS)
        if equation.width > width / 2:
            lines += [*pack(row, width), *break_lines(head, equation.right, width)]
            row = []
        else:
            row.append(concatenate(head, *(piece.box for piece in equation.right)))
    return lines + pack(row, width)


def pack(boxes: Iterable[Box], width: float = LINE_WIDTH) -> list[str]:
    """As many boxes on each line as fit; a box is never broken."""
    lines: list[str] = []
    row: list[Box] = []
    for box in boxes:
        if row and sum(item.width + GAP.width for item in row) + box.width > width:
            lines.append(GAP.tex.join(item.tex for item in row))
            row = []
        row.append(box)
    return [*lines, GAP.tex.join(item.tex for item in row)] if row else lines


def matrix(rows: Sequence[Sequence[Box]]) -> Box:
    """A matrix in brackets, with the width that it takes."""
    columns = zip(*rows, strict=True)
    width = sum(max(cell.width for cell in column) for column in columns)
    width += _COLUMN_GAP * (len(rows[0]) - 1) + _DELIMITERS
    body = " \\\\ ".join(" & ".join(cell.tex.strip() for cell in row) for row in rows)
    return Box(f"\\begin{{bmatrix}} {body} \\end{{bmatrix}}", width)


def fits(box: Box, rows: int, width: float = LINE_WIDTH) -> bool:
    """Whether a matrix with so many rows can be printed as a whole."""
    return box.width <= width and rows <= TALLEST_MATRIX

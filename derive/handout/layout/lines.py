"""Breaks a row of pieces into lines of a given width.

A line is broken before a plus or minus, outermost brackets first, and between two factors only where nothing else
fits; the lines of one expression continue at an indentation that shows how deep in brackets they start.

Places equations and matrices on lines of the page's width.

What is short shares a line, a matrix that fits is printed as a matrix, a long sum is broken over lines.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from derive.handout.notation.pieces import RELATION_WIDTH, Box, Break, Piece, concatenate, line_start

LINE_WIDTH = 455.0
"""Room for an equation [pt]: A4 less margins of 20 mm (483 pt), the indentation (20 pt) and a reserve."""

DEPTH_COST = 0.25
"""Part of the line that may stay empty to break one bracket further out."""

FACTOR_COST = 0.45
"""Part of the line that may stay empty to break at a sum rather than between two factors."""

_INDENTS = (Box("\\quad ", 10.0), Box("\\qquad ", 20.0), Box("\\qquad\\quad ", 30.0))


def break_lines(head: Box, pieces: Sequence[Piece], width: float = LINE_WIDTH) -> list[str]:
    """The expression on as many lines as it needs.

    Args:
        head: What stands on the first line before the expression, such as ``b_{11} = ``.
        pieces: The expression.
        width: Room on a line [pt].

    Returns:
        LaTeX of each line, without alignment marks.
    """
    lines: list[str] = []
    start, lead = 0, head
    while True:
        end = _line_end(pieces, start, width - lead.width)
        lines.append(_line(lead, pieces[start:end], first=not lines))
        if end == len(pieces):
            return lines
        start, lead = end, _INDENTS[min(pieces[end].depth, len(_INDENTS) - 1)]


def _line(lead: Box, pieces: Sequence[Piece], first: bool) -> str:
    opening = pieces[0].box if first else line_start(pieces[0])
    return concatenate(lead, opening, *(piece.box for piece in pieces[1:])).tex


def _line_end(pieces: Sequence[Piece], start: int, room: float) -> int:
    """Index of the piece that starts the next line."""
    used = line_start(pieces[start]).width
    best, best_cost = 0, 2.0
    for index in range(start + 1, len(pieces)):
        piece = pieces[index]
        if piece.before is not Break.NEVER:
            cost = _cost(piece, used / room)
            if (used <= room and cost <= best_cost) or not best:
                best, best_cost = index, cost
        used += piece.box.width
        if used > room and best:
            return best
    return len(pieces)


def _cost(piece: Piece, filled: float) -> float:
    """How bad a break here is, between 0 and 1 or so."""
    factor = FACTOR_COST if piece.before is Break.FACTOR else 0.0
    return (1.0 - filled) + DEPTH_COST * piece.depth + factor


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

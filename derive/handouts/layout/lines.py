"""Places equations and matrices on lines of the page's width.

What is short shares a line, a matrix that fits is printed as a matrix, a long sum is broken over lines: before a plus
or minus, outermost brackets first, and between two factors only where nothing else fits. The lines of one expression
continue at an indentation that shows how deep in brackets they start.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from derive.handouts.notation.pieces import DOT_WIDTH, RELATION_WIDTH, Box, Break, TexPiece, concatenate, joined

LINE_WIDTH = 455.0  # of an equation [pt]: A4 less margins of 20 mm (483), the indentation (20) and a reserve
LANDSCAPE_WIDTH = 710.0  # width of a line on a page turned on its side [pt]
DEPTH_COST = 0.25  # part of the line that may stay empty to break one bracket further out
FACTOR_COST = 0.45  # part of the line that may stay empty to break at a sum rather than between two factors
TALLEST_MATRIX = 40  # rows of a matrix that a page can hold
BREAK_AFTER = 250  # rows in one display; TeX sets a display as a whole, and its memory is finite
KEPT_TOGETHER = 14  # rows of a display that is not broken over pages; a matrix that is printed as one counts as four
FRACTION_ROOM = "0.6ex"  # added between two rows of a matrix that both hold fractions
GAP = Box(" \\qquad ", 20.0)  # between two equations on one line
EQUALS = Box(" = ", RELATION_WIDTH)

# In front of a line that continues another, by the brackets in which it starts; no equation begins like that.
INDENTS = (Box("\\quad ", 10.0), Box("\\qquad ", 20.0), Box("\\qquad\\quad ", 30.0))
_COLUMN_GAP = 10.0
_DELIMITERS = 15.0


@dataclass(frozen=True, slots=True)
class Equation:
    """``left = right``."""

    left: Box  # the symbol that is defined
    right: tuple[TexPiece, ...]  # the expression


def equated(left: Box, *right: Box) -> Box:
    """``left = right``, and ``left =`` in front of a right-hand side that is broken over lines."""
    return concatenate(left, EQUALS, *right)


def break_lines(head: Box, pieces: Sequence[TexPiece], width: float = LINE_WIDTH) -> list[str]:
    """The expression on as many lines as it needs; each ends at the cheapest break that fits, else at the first one."""
    lines: list[str] = []
    start, lead = 0, head
    while True:
        room, used = width - lead.width, _continued(pieces[start]).width
        best, best_cost, end = 0, 2.0, len(pieces)
        for index in range(start + 1, len(pieces)):
            if (piece := pieces[index]).before is not Break.NEVER:
                # The cost of ending the line here: what stays empty of it, more inside of brackets or of a product.
                factor = FACTOR_COST if piece.before is Break.FACTOR else 0.0
                cost = (1.0 - used / room) + DEPTH_COST * piece.depth + factor
                if (used <= room and cost <= best_cost) or not best:
                    best, best_cost = index, cost  # of equal costs the later break; a first that does not fit is kept
            used += piece.box.width
            if used > room and best:
                end = best
                break
        opening = _continued(pieces[start]) if lines else pieces[start].box
        lines.append(concatenate(lead, opening, *(piece.box for piece in pieces[start + 1 : end])).tex)
        if end == len(pieces):
            return lines
        start, lead = end, INDENTS[min(pieces[end].depth, len(INDENTS) - 1)]


def _continued(piece: TexPiece) -> Box:
    """The piece at the start of a line that continues another; TeX spaces a sign as between terms after ``{}``."""
    if piece.before is Break.BINARY:
        return Box("{}" + piece.box.tex.strip() + " ", piece.box.width)
    if piece.before is Break.FACTOR:
        return Box("{}\\cdot " + piece.box.tex, piece.box.width + DOT_WIDTH)
    return piece.box


def displays(lines: Sequence[str], *, kept: bool = True) -> list[str]:
    """Rows of displayed mathematics, a few dozen in each display."""
    found = []
    for part in (lines[k : k + BREAK_AFTER] for k in range(0, len(lines), BREAK_AFTER)):
        height = sum(4 if "bmatrix" in line else 1 for line in part)
        end = " \\\\*\n" if kept and height <= KEPT_TOGETHER else " \\\\\n"  # no page ends after a row with a star
        body = end.join(f"& {line.rstrip()}" for line in part)
        found.append(f"\\begin{{align*}}\n{body}\n\\end{{align*}}")
    return found


def equation_lines(equations: Iterable[Equation], width: float = LINE_WIDTH) -> list[str]:
    """Equations in their order; neighbours that fit share a line."""
    lines: list[str] = []
    row: list[Box] = []
    for equation in equations:
        head, right = equated(equation.left), joined(equation.right)
        if head.width + right.width > width / 2:
            lines += [*pack(row, width), *break_lines(head, equation.right, width)]
            row = []
        else:
            row.append(concatenate(head, right))
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
    width = sum(max(cell.width for cell in column) for column in zip(*rows, strict=True))
    width += _COLUMN_GAP * (len(rows[0]) - 1) + _DELIMITERS
    body = " ".join(matrix_rows([[cell.tex.strip() for cell in row] for row in rows]))
    return Box(f"\\begin{{bmatrix}} {body} \\end{{bmatrix}}", width)


def matrix_rows(cells: Sequence[Sequence[str]]) -> list[str]:
    """The rows of a matrix with what parts them; fractions in one would touch those in the next without some room."""
    rows = [" & ".join(row) for row in cells]
    are_tall = ["frac{" in row for row in rows]
    ends = [f" \\\\[{FRACTION_ROOM}]" if all(pair) else " \\\\" for pair in pairwise(are_tall)]
    return [*(row + end for row, end in zip(rows, ends, strict=False)), *rows[-1:]]


def fits(box: Box, rows: int, width: float = LINE_WIDTH) -> bool:
    """Whether a matrix can be printed as a whole."""
    return box.width <= width and rows <= TALLEST_MATRIX

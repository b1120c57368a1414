"""Breaks a row of pieces into lines of a given width.

A line is broken before a plus or minus, outermost brackets first, and between two factors only where nothing else
fits; the lines of one expression continue at an indentation that shows how deep in brackets they start.
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.emit.latex.metrics import Box, concatenate
from derive.emit.latex.pieces import Break, Piece, line_start

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

"""The formulas of the inverse kinematics, line by line."""

from __future__ import annotations

from collections.abc import Iterator

from derive.handouts.context import Context
from derive.handouts.document import Formula, Rows
from derive.handouts.layout.lines import EQUALS, INDENTS, break_lines
from derive.handouts.notation.derivation import SignLatexPrinter, with_names, with_signs
from derive.handouts.notation.pieces import Box, concatenate, joined
from derive.model.inverse.elementary import Line

WIDEST_QUOTIENT = 170.0
"""Widest sum above a divisor [pt], which a narrow column holds."""

_LETTER_WIDTH = 6.0
"""Of running text in mathematics [pt]."""


def formulas(context: Context) -> Iterator[Formula]:
    """The formulas, a block for what the pose is named and one for each unknown.

    Args:
        context: The handout.

    Yields:
        The blocks.
    """
    found = context.entries.model.inverse
    printer = SignLatexPrinter(with_names(context.notation, found), found, WIDEST_QUOTIENT)
    for lines in (found.definitions, *(step.lines for step in found.steps)):
        rows = [row for line in lines for row in _rows(context, printer, line)]
        if rows:
            yield Formula(rows=(Rows(tuple(map(with_signs, rows))),))


def _rows(context: Context, printer: SignLatexPrinter, line: Line) -> list[str]:
    """A formula on as many lines as it needs; where it has two values that are written apart, one below the other."""
    head = concatenate(joined(printer.pieces(line.symbol)), EQUALS)
    first, *others = line.alternatives
    rows = break_lines(head, printer.pieces(first))
    if others:
        word = context.text("or")
        either = Box(f"\\ \\text{{{word}}}\\ ", 8.0 + _LETTER_WIDTH * len(word))
        rows += break_lines(concatenate(INDENTS[0], either), printer.pieces(others[0]))
    return rows

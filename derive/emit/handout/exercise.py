"""An exercise and its solutions, two sheets of one handout."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from derive.emit.handout.document import Blank, Block, Document, Formula, Rows, Steps, map_blocks
from derive.emit.handout.text import Text

LEAST_LINES = 2
MOST_LINES = 24
"""Lines of room for one answer: less than half a page, however long the solution is."""

_HANDWRITING = 1.5
"""Lines by hand for one in print."""


def exercise(document: Document, text: Text) -> Document:
    """The handout with room for the answers in place of the results; derivations are left out.

    Args:
        document: The handout.
        text: Translates the subtitle.
    """
    blank = map_blocks(document, _question)
    sections = tuple(section for section in blank.sections if section.blocks)
    return replace(blank, subtitle=text("Exercise"), sections=sections)


def solutions(document: Document, text: Text) -> Document:
    """The same handout as the sheet of solutions.

    Args:
        document: The handout.
        text: Translates the subtitle.
    """
    return replace(document, subtitle=text("Solutions"))


def _question(block: Block) -> Block | None:
    if isinstance(block, Steps):
        return None
    return Blank(block.blanks, room(block)) if isinstance(block, Formula) and block.blanks else block


def room(formula: Formula) -> int:
    """Lines that the answer needs by hand."""
    printed = [*(line for rows in formula.rows for line in _lines(rows)), *formula.named, *formula.omitted]
    return max(LEAST_LINES, min(MOST_LINES, round(_HANDWRITING * len(printed))))


def _lines(rows: Rows) -> Iterable[str]:
    r"""Lines on paper: a matrix takes one for each of its rows, which ``\\`` ends."""
    return (part for line in rows.lines for part in line.split("\\\\"))

"""The formulas of an inverse kinematics as displays: broken into lines, to be copied, blank in an exercise."""

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import sympy

from derive.handouts.layout.lines import EQUALS, INDENTS, break_lines
from derive.handouts.notation.derivation import LONGEST_PAIR, derivation_python, formula
from derive.handouts.notation.pieces import EMPTY, Box, Break, TexPiece, concatenate, joined
from derive.handouts.notation.solution_printer import SignLatexPrinter, with_names, with_signs
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Entry, LazyEntries, Rows, SheetFormula
from derive.inverse.words.elementary import PrintedLine
from derive.inverse.words.solutions import InverseKinematics

WIDEST_QUOTIENT = 170.0  # widest sum above a divisor [pt], which a narrow column holds
WIDEST_LEFT = 200.0  # widest left side of an equation whose right side is broken alone [pt]
_LETTER_WIDTH = 6.0  # of running text in mathematics [pt]


def formulas(context: Context) -> Iterator[SheetFormula]:
    """The formulas, a block for what the pose is named and one for each unknown."""
    found = context.entries.model.inverse
    writer = FormulaWriter(context, found)
    for lines in (found.definitions, *(step.lines for step in found.steps)):
        if lines:
            yield writer.formula(lines)


class FormulaWriter:
    """Writes the formulas of one arm, with the signs and names of its derivation."""

    def __init__(self, context: Context, found: InverseKinematics) -> None:
        self._context, self._found = context, found
        self.printer = SignLatexPrinter(with_names(context.notation, found), found, WIDEST_QUOTIENT)

    def tex(self, e: Any) -> str:
        """An expression on one line."""
        return self.printer.latex(e).strip()

    def math(self, e: Any) -> str:
        """An expression in running text."""
        return f"${self.tex(e)}$"

    def formula(self, lines: Sequence[PrintedLine], task: str = "", *, is_each_asked: bool = False) -> SheetFormula:
        """Lines of a solution as one formula."""
        rows = tuple(row for line in lines for row in self.rows(line))
        names = tuple(self.tex(line.symbol) for line in lines)
        blanks = names if is_each_asked else names[-1:]
        entries = LazyEntries(len(lines), lambda: map(self.entry, lines))
        return SheetFormula((Rows(rows),), entries=entries, task=task, blanks=blanks if task else ())

    def entry(self, line: PrintedLine) -> Entry:
        """A formula to be copied."""
        either = f" \\text{{ {self._context.text('or')} }} "
        left, _, right = formula(line, self.tex, " = ", either, " + \\pi").partition(" = ")
        return Entry(left, right, self._assignments[line])

    @cached_property
    def _assignments(self) -> dict[PrintedLine, str]:
        return dict(zip(self._found.lines, derivation_python(self._found), strict=True))

    def rows(self, line: PrintedLine) -> list[str]:
        """A formula on as many lines as it needs; of two values written apart one below the other."""
        first, *others = line.alternatives
        rows = self.broken(self.printer.pieces(line.symbol), first)
        if others:
            word = self._context.text("or")
            either = Box(f"\\ \\text{{{word}}}\\ ", 8.0 + _LETTER_WIDTH * len(word))
            is_short = sum(value.count_ops() for value in line.alternatives) < LONGEST_PAIR
            second = others[0] if is_short else line.symbol + sympy.pi
            rows += break_lines(concatenate(INDENTS[0], either), self.printer.pieces(second))
        return [with_signs(row) for row in rows]

    def broken(self, left: Sequence[TexPiece], right: Any) -> list[str]:
        """An equation on as many lines as it needs, its left side broken, too, where it is long."""
        head, pieces = concatenate(joined(left), EQUALS), self.printer.pieces(right)
        if head.width < WIDEST_LEFT:
            rows = break_lines(head, pieces)
        else:
            rows = break_lines(EMPTY, [*left, TexPiece(Box("= ", 12.0), Break.BINARY), *pieces])
        return [with_signs(row) for row in rows]

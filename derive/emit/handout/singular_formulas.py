"""The determinant of a block of J in factors, and the zeros of the factors, as formulas."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy

from derive.emit.handout.context import Context
from derive.emit.handout.document import Formula, Rows
from derive.emit.handout.formula import formula
from derive.emit.latex.layout import EQUALS, pack
from derive.emit.latex.lines import break_lines
from derive.emit.latex.metrics import EMPTY, RELATION_WIDTH, Box, concatenate
from derive.emit.latex.names import Glyph
from derive.emit.latex.pieces import Break, Piece
from derive.emit.latex.printer import LatexPrinter
from derive.emit.latex.quantity import Item, omitted
from derive.emit.singularity import SingularFactor, SingularityQuantity

ZERO = Piece(Box(" = 0", RELATION_WIDTH + 5.0))
IF_AND_ONLY_IF = Piece(Box(" \\iff ", 34.0), Break.BINARY)
LETTER_WIDTH = 6.0
"""Of running text in mathematics [pt]."""


@dataclass(frozen=True)
class SingularFormulas:
    """Formulas of one robot.

    Attributes:
        context: The handout.
        found: The determinant and its factors.
        symbol: The matrix whose determinant it is.
        group: Group of the named terms.
    """

    context: Context
    found: SingularityQuantity
    symbol: Box
    group: int

    @cached_property
    def _named(self) -> dict[str, SingularFactor]:
        """Factors too long to be printed, under names."""
        return {f"_f{k}": f for k, f in enumerate(self.found.factors, 1) if self._is_long(f)}

    def _is_long(self, factor: SingularFactor) -> bool:
        policy = self.context.policy
        if factor.terms > policy.flat_terms:
            return True
        return len(break_lines(EMPTY, self.context.printer.pieces(factor.expression))) > policy.entry_lines

    @cached_property
    def _symbols(self) -> dict[str, Box]:
        return {name: self.context.symbols.term(self.group, k) for k, name in enumerate(self._named, 1)}

    @cached_property
    def _printer(self) -> LatexPrinter:
        glyphs = {name: Glyph(box) for name, box in self._symbols.items()}
        return LatexPrinter(self.context.notation.with_terms(glyphs))

    def _short(self, factor: SingularFactor) -> Any:
        """The factor, or its name."""
        return next((sympy.Symbol(name) for name, long in self._named.items() if long is factor), factor.expression)

    def determinant(self) -> Formula:
        """det J in factors, those that are too long by their numbers of terms."""
        left = concatenate(Box("\\det", 16.0), self.symbol)
        if not self._named:
            value = self.found.determinant
            item = Item(left, self.found.terms(1, 1), lambda: value)
            limit = self.context.policy.grouped_terms
            return formula(self.context, self.context.layouter.entries([item], group=self.group + 1, limit=limit))
        product = sympy.Mul(*(self._short(f) ** f.exponent for f in self.found.factors))
        lines = break_lines(concatenate(left, EQUALS), self._printer.pieces(product))
        word = self.context.layouter.terms_word
        long = (omitted(Item(self._symbols[name], f.terms, lambda: None), word) for name, f in self._named.items())
        return Formula(rows=(Rows(tuple(lines)),), omitted=tuple(pack(long)), blanks=(left.tex,))

    def conditions(self) -> Formula:
        """Where each factor is zero."""
        lines = [line for f in self.found.factors if f.moving for line in break_lines(EMPTY, list(self._zero(f)))]
        left = concatenate(Box("\\det", 16.0), self.symbol, ZERO.box, IF_AND_ONLY_IF.box)
        return Formula(rows=(Rows(tuple(lines)),), note=self._note(), blanks=(left.tex.strip(),))

    def _zero(self, factor: SingularFactor) -> Iterator[Piece]:
        expression = self._short(factor)
        yield from self._printer.pieces(expression)
        yield ZERO
        if factor.values and expression != factor.variable:
            yield IF_AND_ONLY_IF
            yield from self._printer.pieces(factor.variable)
            yield Piece(EQUALS)
            yield from self._values(factor.values)
        word = self._words.get(factor.posture)
        if word:
            yield Piece(Box(f"\\quad \\text{{({word[0]})}}", 18.0 + LETTER_WIDTH * len(word[0])), Break.COMMA)

    def _values(self, values: tuple[Any, ...]) -> Iterator[Piece]:
        if len(values) == 2 and values[0] == -values[1]:
            yield Piece(Box("\\pm ", 8.0))
            values = values[1:]
        for index, value in enumerate(values):
            if index:
                word = self.context.text("or")
                yield Piece(Box(f"\\ \\text{{{word}}}\\ ", 8.0 + LETTER_WIDTH * len(word)), Break.COMMA)
            yield from self._printer.pieces(value)

    @cached_property
    def _words(self) -> dict[str, tuple[str, str]]:
        """Postures: a word, and what it means."""
        _ = self.context.text
        at_wrist = len(self.found.blocks) > 1
        elbow = (
            _("Elbow: the wrist centre lies in the plane of axes 2 and 3, the arm is stretched out or folded.")
            if at_wrist
            else _("Elbow: the end effector lies in the plane of axes 2 and 3, the arm is stretched out or folded.")
        )
        shoulder = (
            _("Shoulder: the wrist centre lies in the plane through axis 1 that is parallel to axis 2.")
            if at_wrist
            else _("Shoulder: the end effector lies in the plane through axis 1 that is parallel to axis 2.")
        )
        return {
            "wrist": (_("wrist"), _("Wrist: axes 4 and 6 are aligned.")),
            "elbow": (_("elbow"), elbow),
            "shoulder": (_("shoulder"), shoulder),
        }

    def _note(self) -> str:
        present = [factor.posture for factor in self.found.factors]
        return " ".join(meaning for posture, (_word, meaning) in self._words.items() if posture in present)

"""The part with the singularities: a square block of J, its determinant in factors, and where each of them is zero.

The determinant of a block of J in factors, and the zeros of the factors, as formulas.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy

from derive.handout.context import Context
from derive.handout.document import Block, Formula, Paragraph, Rows, Section, Steps
from derive.handout.formula import formula
from derive.handout.layout.lines import EQUALS, break_lines, pack
from derive.handout.layout.quantity import Item, omitted
from derive.handout.notation.names import Glyph
from derive.handout.notation.pieces import EMPTY, RELATION_WIDTH, Box, Break, Piece, concatenate, italic, script
from derive.handout.notation.printer import LatexPrinter
from derive.handout.notation.symbols import EntryNamer, bold
from derive.handout.quantity import SingularBlock, SingularFactor, SingularityQuantity

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


GROUP = 60
"""First group of named terms of this part, away from those of the others."""


def section(context: Context) -> Section | None:
    """Where J loses rank."""
    found = context.quantities.get("singularities")
    if not isinstance(found, SingularityQuantity):
        return None
    return Section("singularities", context.text("Singularities"), tuple(_blocks(context, found)))


def _blocks(context: Context, found: SingularityQuantity) -> Iterator[Block]:
    _ = context.text
    n = context.robot.n
    match found.outcome:
        case "redundant":
            yield from _redundant(context)
        case "too long":
            yield Paragraph(
                _(
                    "The determinant that says where $\\mathbf{J}$ loses rank has intermediate results of more than "
                    "%(terms)s terms; it is not derived.",
                    terms=found.budget,
                )
            )
        case "everywhere" if n == 6:
            yield Paragraph(_("$\\det\\mathbf{J} = 0$ in every configuration: the arm is singular everywhere."))
        case "everywhere":
            yield Paragraph(
                _(
                    "Every block of %(n)s rows of $\\mathbf{J}$ has determinant zero in every configuration: the rank "
                    "of $\\mathbf{J}$ is always less than %(n)s.",
                    n=n,
                )
            )
        case "never" if not found.blocks:
            yield Paragraph(_("A single joint has no singularity: its column of $\\mathbf{J}$ is never zero."))
        case _:
            yield from _determinant(context, found)


def _redundant(context: Context) -> Iterator[Block]:
    _ = context.text
    yield Paragraph(
        _(
            "With %(n)s joints $\\mathbf{J}$ has more columns than rows and no determinant. Its rank is less than 6 "
            "where $\\det(\\mathbf{J}\\,\\mathbf{J}^T) = 0$, which has too many terms to be printed.",
            n=context.robot.n,
        )
    )


def _determinant(context: Context, found: SingularityQuantity) -> Iterator[Block]:
    _ = context.text
    yield from (Paragraph(text) for text in _introduction(context, found.blocks))
    if context.steps:
        title = _("The blocks") if len(found.blocks) > 1 else _("The block")
        yield Steps(title, tuple(_matrices(context, found.blocks)))
    formulas = SingularFormulas(context, found, symbol(found.blocks, context.robot.n), GROUP + 2)
    yield formulas.determinant()
    if found.outcome == "never":
        yield Paragraph(_("It does not depend on the configuration: as long as it is not zero, no rank is ever lost."))
        return
    yield Paragraph(_("Rank is lost where a factor is zero."))
    yield formulas.conditions()


def symbol(blocks: tuple[SingularBlock, ...], n: int) -> Box:
    """The matrix whose determinant is printed: J, or J' for a block of it."""
    return bold("J") if n == 6 or len(blocks) > 1 else Box("\\mathbf{J}'", 14.0)


def _introduction(context: Context, blocks: tuple[SingularBlock, ...]) -> Iterator[str]:
    _ = context.text
    if len(blocks) > 1:
        yield _(
            "Axes 4, 5 and 6 meet in the wrist centre $%(centre)s$. For the velocity of that point "
            "$\\mathbf{J}_{12} = \\mathbf{0}$, hence $\\det\\mathbf{J} = \\det\\mathbf{J}_{11} "
            "\\det\\mathbf{J}_{22}$. The choice of the point and of the axes changes neither determinant.",
            centre=_origin(blocks[0]),
        )
        return
    block = blocks[0]
    if context.robot.n == 6:
        yield _("$\\mathbf{J}$ is square, and its determinant depends neither on the point nor on the axes.")
        return
    rows = ", ".join(map(str, block.rows))
    if block.others_are_zero:
        yield _("Let $\\mathbf{J}'$ be rows %(rows)s of $\\mathbf{J}$; the others are zero.", rows=rows)
    elif block.rows == (1, 2, 3):
        yield _("Let $\\mathbf{J}'$ be rows 1, 2, 3 of $\\mathbf{J}$, the linear velocity.")
    else:
        yield _(
            "Let $\\mathbf{J}'$ be rows %(rows)s of $\\mathbf{J}$: a task of as many coordinates as the arm has "
            "joints.",
            rows=rows,
        )
    yield from _reference(context, block)


def _reference(context: Context, block: SingularBlock) -> Iterator[str]:
    _ = context.text
    if block.point is not None:
        yield _("Its point is $%(origin)s$.", origin=_origin(block))
    if block.frame is not None:
        yield _("It is written in the axes of frame %(frame)s.", frame=block.frame)


def _origin(block: SingularBlock) -> str:
    return f"\\mathbf{{o}}_{{{block.point}}}"


def _matrices(context: Context, blocks: tuple[SingularBlock, ...]) -> Iterator[Block]:
    _ = context.text
    if any(block.frame is not None for block in blocks) and context.robot.n == 6:
        yield Paragraph(_("The upper index is the frame in whose axes a block is written."))
    for k, block in enumerate(blocks):
        name = EntryNamer(context.symbols, "J'" if len(block.rows) < 6 and len(blocks) == 1 else "J")
        laid_out = context.layouter.block(_name(context, block, blocks), name, block.quantity, group=GROUP + k)
        yield formula(context, laid_out)


def _name(context: Context, block: SingularBlock, blocks: tuple[SingularBlock, ...]) -> Box:
    """J_11 and J_22, J, or J', with the frame of the axes above."""
    frame = EMPTY if block.frame is None else italic(str(block.frame))
    if len(blocks) > 1:
        return script(bold("J"), italic(block.name[2:]), frame)
    return script(bold("J"), sup=frame) if context.robot.n == 6 else symbol(blocks, context.robot.n)

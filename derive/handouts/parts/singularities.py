"""The part with the singularities: a square block of J, its determinant in factors, and where each of them is zero."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import sympy

from derive.handouts.context import Context
from derive.handouts.document import Block, Formula, Paragraph, Rows, Steps
from derive.handouts.formula import formula
from derive.handouts.layout.lines import EQUALS, break_lines, pack
from derive.handouts.layout.quantity import Item, omitted
from derive.handouts.notation.pieces import EMPTY, RELATION_WIDTH, Box, Break, Piece, concatenate, italic, script
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.notation.subscripts import Glyph
from derive.handouts.notation.symbols import Group, bold
from derive.lecture.sympy_conversion import Expr
from derive.model.entries import expanded_terms, of_matrix
from derive.model.singularities.determinant import MAX_TERMS, Outcome, Posture, SingularFactor, Singularities

_IS_ZERO = Piece(Box(" = 0", RELATION_WIDTH + 5.0))
_IF_AND_ONLY_IF = Piece(Box(" \\iff ", 34.0), Break.BINARY)
_DETERMINANT = Box("\\det", 16.0)

_LETTER_WIDTH = 6.0
"""Of running text in mathematics [pt]."""


def singularities(context: Context) -> Iterator[Block]:
    """Where J loses rank.

    Args:
        context: The handout.

    Yields:
        The blocks of the part.
    """
    _ = context.text
    found, n = context.entries.model.singularities, context.robot.n
    match found.outcome:
        case Outcome.REDUNDANT:
            yield Paragraph(
                _(
                    "With %(n)s joints $\\mathbf{J}$ has more columns than rows and no determinant. Its rank is less "
                    "than 6 where $\\det(\\mathbf{J}\\,\\mathbf{J}^T) = 0$, which has too many terms to be printed.",
                    n=n,
                )
            )
        case Outcome.TOO_LONG:
            yield Paragraph(
                _(
                    "The determinant that says where $\\mathbf{J}$ loses rank has intermediate results of more than "
                    "%(terms)s terms; it is not derived.",
                    terms=MAX_TERMS,
                )
            )
        case Outcome.EVERYWHERE if n == 6:
            yield Paragraph(_("$\\det\\mathbf{J} = 0$ in every configuration: the arm is singular everywhere."))
        case Outcome.EVERYWHERE:
            yield Paragraph(
                _(
                    "Every block of %(n)s rows of $\\mathbf{J}$ has determinant zero in every configuration: the rank "
                    "of $\\mathbf{J}$ is always less than %(n)s.",
                    n=n,
                )
            )
        case Outcome.NEVER if not found.blocks:
            yield Paragraph(_("A single joint has no singularity: its column of $\\mathbf{J}$ is never zero."))
        case _:
            yield from _determinant(context, found)


def _determinant(context: Context, found: Singularities) -> Iterator[Block]:
    _ = context.text
    formulas = _SingularFormulas(context, found)
    yield from _introduction(context, found)
    if context.steps:
        one = _("The matrix $%(matrix)s$", matrix=_symbol(context, found).tex)
        title = _("The blocks of the Jacobian") if len(found.blocks) > 1 else one
        yield Steps(title, tuple(_matrices(context, found)))
    yield formulas.determinant()
    if found.outcome is Outcome.NEVER:
        words = _("It does not depend on the configuration: as long as it is not zero, no rank is ever lost.")
        yield Paragraph(words, is_answer=True)
        return
    yield Paragraph(_("Rank is lost where a factor is zero."), is_answer=True)
    yield formulas.conditions()


def _introduction(context: Context, found: Singularities) -> Iterator[Paragraph]:
    """Which rows of J, about which point and in which axes."""
    _ = context.text
    block = found.blocks[0]
    frame, origin = block.reference.frame, f"\\mathbf{{o}}_{{{block.reference.point}}}"
    if len(found.blocks) > 1:
        words = _(
            "Axes 4, 5 and 6 meet in the wrist centre $%(centre)s$. For the velocity of that point "
            "$\\mathbf{J}_{12} = \\mathbf{0}$, hence $\\det\\mathbf{J} = \\det\\mathbf{J}_{11} "
            "\\det\\mathbf{J}_{22}$. The choice of the point and of the axes changes neither determinant.",
            centre=origin,
        )
        yield Paragraph(words)
        return
    if context.robot.n == 6:
        words = _("$\\mathbf{J}$ is square, and its determinant depends neither on the point nor on the axes.")
        yield Paragraph(words)
        return
    rows = ", ".join(map(str, block.rows))
    if block.rows == (1, 2, 3):
        words = _("Let $\\mathbf{J}'$ be rows 1, 2, 3 of $\\mathbf{J}$, the linear velocity.")
    else:
        words = _(
            "Let $\\mathbf{J}'$ be rows %(rows)s of $\\mathbf{J}$: a task of as many coordinates as the arm has "
            "joints.",
            rows=rows,
        )
    if block.reference.point is not None:
        words += " " + _("It is that of the point $%(origin)s$.", origin=origin)
    if frame is not None:
        words += " " + _("It is written in the axes of frame %(frame)s.", frame=frame)
    yield Paragraph(words)
    if block.others_are_zero:
        yield Paragraph(_("The other rows are zero."), is_answer=True)


def _matrices(context: Context, found: Singularities) -> Iterator[Block]:
    """The blocks; J_11 and J_22, J, or J', with the frame of the axes above."""
    _ = context.text
    n, blocks = context.robot.n, found.blocks
    if n == 6 and any(block.reference.frame is not None for block in blocks):
        yield Paragraph(_("The upper index is the frame in whose axes a block is written."))
    for k, block in enumerate(blocks):
        frame = EMPTY if block.reference.frame is None else italic(str(block.reference.frame))
        if len(blocks) > 1:
            name = script(bold("J"), italic(block.name[2:]), frame)
        else:
            name = script(bold("J"), sup=frame) if n == 6 else _symbol(context, found)
        namer = partial(context.symbols.entry, "J'" if len(block.rows) < 6 and len(blocks) == 1 else "J")
        quantity = of_matrix(block.matrix)
        group = Group.SINGULARITY_BLOCKS + k
        yield formula(context, context.layouter.lay_out(name, namer, quantity, group=group))


def _symbol(context: Context, found: Singularities) -> Box:
    """The matrix whose determinant is printed: J, or J' for a block of it."""
    return bold("J") if context.robot.n == 6 or len(found.blocks) > 1 else Box("\\mathbf{J}'", 14.0)


class _SingularFormulas:
    """The determinant of one robot in factors, and the zeros of the factors, as formulas."""

    def __init__(self, context: Context, found: Singularities) -> None:
        self.context, self.found, _ = context, found, context.text
        if len(found.blocks) > 1:
            elbow = _("Elbow: the wrist centre lies in the plane of axes 2 and 3, the arm is stretched out or folded.")
            shoulder = _("Shoulder: the wrist centre lies in the plane through axis 1 that is parallel to axis 2.")
        else:
            elbow = _("Elbow: the end effector lies in the plane of axes 2 and 3, the arm is stretched out or folded.")
            shoulder = _("Shoulder: the end effector lies in the plane through axis 1 that is parallel to axis 2.")
        self._words: dict[Posture | None, tuple[str, str]] = {  # a word, and what it means
            Posture.WRIST: (_("wrist"), _("Wrist: axes 4 and 6 are aligned.")),
            Posture.ELBOW: (_("elbow"), elbow),
            Posture.SHOULDER: (_("shoulder"), shoulder),
        }
        policy, pieces = context.policy, context.printer.pieces
        self._long: dict[Expr, SingularFactor] = {  # factors that are too long to be printed have a symbol instead
            sympy.Symbol(f"_f{k}"): f
            for k, f in enumerate(found.factors, 1)
            if expanded_terms(f.expression) > policy.flat_terms
            or len(break_lines(EMPTY, pieces(f.expression))) > policy.entry_lines
        }
        self._names = {s: context.symbols.term(Group.DETERMINANT, k) for k, s in enumerate(self._long, 1)}
        glyphs = {symbol.name: Glyph(box) for symbol, box in self._names.items()}
        self._printer = LatexPrinter(context.notation.with_terms(glyphs))

    def determinant(self) -> Formula:
        """The determinant in factors, those that are too long by their numbers of terms."""
        left = concatenate(_DETERMINANT, _symbol(self.context, self.found))
        if not self._long:
            value = self.found.determinant
            terms = sum(expanded_terms(f.expression) for f in self.found.factors) or int(value not in (None, 0))
            item, limit = Item(left, terms, lambda: value), self.context.policy.grouped_terms
            group = Group.DETERMINANT + 1
            laid_out = self.context.layouter.entries([item], group=group, limit=limit)
            task = self.context.text("Find $%(determinant)s$ in factors.", determinant=left.tex)
            return formula(self.context, laid_out, task=task)
        product = sympy.Mul(*(self._short(f) ** f.exponent for f in self.found.factors))
        lines = break_lines(concatenate(left, EQUALS), self._printer.pieces(product))
        word = self.context.layouter.terms_word
        long = (
            omitted(
                Item(self._names[symbol], expanded_terms(f.expression), lambda: None),
                word,
                comma=self.context.text.comma,
            )
            for symbol, f in self._long.items()
        )
        return Formula(rows=(Rows(tuple(lines)),), omitted=tuple(pack(long)))

    def conditions(self) -> Formula:
        """Where each factor that moves with the arm is zero."""
        moving = [f for f in self.found.factors if f.condition is not None]
        lines = [line for f in moving for line in break_lines(EMPTY, list(self._zero(f)))]
        present = [f.condition.posture for f in moving if f.condition is not None]
        note = " ".join(meaning for posture, (_word, meaning) in self._words.items() if posture in present)
        symbol = _symbol(self.context, self.found).tex
        task = self.context.text("In which configurations does $%(matrix)s$ lose rank?", matrix=symbol)
        return Formula(rows=(Rows(tuple(lines)),), note=note, task=task, blanks=() if self._long else ("",))

    def _zero(self, factor: SingularFactor) -> Iterator[Piece]:
        """``s_5 = 0 <=> q_5 = 0 or pi (wrist)``."""
        expression, condition = self._short(factor), factor.condition
        yield from self._printer.pieces(expression)
        yield _IS_ZERO
        if condition is None:
            return
        if condition.values and expression != condition.variable:
            yield _IF_AND_ONLY_IF
            yield from self._printer.pieces(condition.variable)
            yield Piece(EQUALS)
            values = condition.values
            if len(values) == 2 and values[0] == -values[1]:
                yield Piece(Box("\\pm ", 8.0))
                values = values[1:]
            for index, value in enumerate(values):
                if index:
                    word = self.context.text("or")
                    yield Piece(Box(f"\\ \\text{{{word}}}\\ ", 8.0 + _LETTER_WIDTH * len(word)), Break.COMMA)
                yield from self._printer.angle(value)
        if condition.posture in self._words:
            word, _meaning = self._words[condition.posture]
            yield Piece(Box(f"\\quad \\text{{({word})}}", 18.0 + _LETTER_WIDTH * len(word)), Break.COMMA)

    def _short(self, factor: SingularFactor) -> Expr:
        """The factor, or its symbol."""
        return next((symbol for symbol, long in self._long.items() if long is factor), factor.expression)

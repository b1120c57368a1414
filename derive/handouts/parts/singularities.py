"""The part with the singularities: the determinant of a task in factors, or all minors, and where they are zero."""

from collections.abc import Iterator, Sequence
from functools import partial

import sympy

from derive.handouts.layout.lines import EQUALS, break_lines, equated, pack
from derive.handouts.layout.quantity import Item, omitted
from derive.handouts.notation.notation import Glyph
from derive.handouts.notation.pieces import EMPTY, RELATION_WIDTH, Box, Break, TexPiece, concatenate, italic, script
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.notation.symbols import Group, bold
from derive.handouts.sheet.context import Context, formula
from derive.handouts.sheet.document import Block, Paragraph, Rows, SheetFormula, Steps
from derive.lecture.sympy_conversion import Expr
from derive.model.entries import expanded_terms, of_matrix
from derive.model.singularities.singularities import Condition, Outcome, Posture, SingularFactor, Singularities

_IS_ZERO = TexPiece(Box(" = 0", RELATION_WIDTH + 5.0))
_IF_AND_ONLY_IF = TexPiece(Box(" \\iff ", 34.0), Break.BINARY)
_DETERMINANT = Box("\\det", 16.0)
_LETTER_WIDTH = 6.0  # of running text in mathematics [pt]


def singularities(context: Context) -> Iterator[Block]:
    """Where J loses rank."""
    found = context.entries.model.singularities
    if found.shape[1] == 1 and not found.task:
        yield context.paragraph("A single joint has no singularity: its column of $\\mathbf{J}$ is never zero.")
    else:
        yield from (_determinant if found.blocks else _minors)(context, found)


def _determinant(context: Context, found: Singularities) -> Iterator[Block]:
    _ = context.text
    formulas = _SingularFormulas(context, found)
    yield from _introduction(context, found)
    if context.steps:
        one = _("The matrix $%(matrix)s$", matrix=_symbol(found).tex)
        title = _("The blocks of the Jacobian") if len(found.blocks) > 1 else one
        steps: list[Block] = []
        if not found.task and any(block.reference.frame is not None for block in found.blocks):
            steps.append(context.paragraph("The upper index is the frame in whose axes a block is written."))
        for k, block in enumerate(found.blocks):  # J_11 and J_22, J, or J', with the frame of the axes above
            frame = EMPTY if block.reference.frame is None else italic(str(block.reference.frame))
            if len(found.blocks) > 1:
                name = script(bold("J"), italic(block.name[2:]), frame)
            else:
                name = _symbol(found) if found.task else script(bold("J"), sup=frame)
            namer, quantity = partial(context.symbols.entry, "J'" if found.task else "J"), of_matrix(block.matrix)
            group = Group.SINGULARITY_BLOCKS + k
            steps.append(formula(context, context.layouter.lay_out(name, namer, quantity, group=group)))
        yield Steps(title, tuple(steps))
    yield formulas.determinant()
    if found.outcome is Outcome.NEVER:
        words = _("It does not depend on the configuration: as long as it is not zero, no rank is ever lost.")
        never = _("No factor is zero in any configuration: no rank is ever lost.")
        yield Paragraph(words if found.is_constant else never, is_answer=True)
        return
    yield context.answer("Rank is lost where a factor is zero.")
    yield formulas.conditions()


def _introduction(context: Context, found: Singularities) -> Iterator[Paragraph]:
    """Which rows of J, about which point and in which axes."""
    _ = context.text
    block = found.blocks[0]
    frame, origin = block.reference.frame, f"\\mathbf{{o}}_{{{block.reference.point}}}"
    if len(found.blocks) > 1:
        yield context.paragraph(
            "Axes 4, 5 and 6 meet in the wrist centre $%(centre)s$. For the velocity of that point "
            "$\\mathbf{J}_{12} = \\mathbf{0}$, hence $\\det\\mathbf{J} = \\det\\mathbf{J}_{11} "
            "\\det\\mathbf{J}_{22}$. The choice of the point and of the axes changes neither determinant.",
            centre=origin,
        )
        return
    if not found.task:
        yield Paragraph(_("$\\mathbf{J}$ is square, and its determinant depends neither on the point nor on the axes."))
        return
    if block.rows:
        words = _(
            "Let $\\mathbf{J}'$ be rows %(rows)s of $\\mathbf{J}$, for the task %(task)s, which has as many "
            "coordinates as the arm has joints.",
            rows=", ".join(map(str, block.rows)),
            task=_task(context, found),
        )
    else:
        words = _("Let $\\mathbf{J}'$ be the Jacobian of the task %(task)s.", task=_task(context, found))
    if block.reference.point is not None:
        words += " " + _("It is that of the point $%(origin)s$.", origin=origin)
    if frame is not None:
        words += " " + _("It is written in the axes of frame %(frame)s.", frame=frame)
    yield Paragraph(words)
    if block.others_are_zero:
        yield context.answer("The other rows are zero.")


def _task(context: Context, found: Singularities) -> str:
    _ = context.text
    words = {f"rotation about {axis}": _("rotation about $%(axis)s$", axis=axis) for axis in "xyz"}
    words |= {"orientation": _("orientation"), "approach": _("direction of the approach")}
    words |= {"phi": "$\\varphi$", "position": "$x$, $y$, $z$"}
    return ", ".join(words.get(word, f"${word}$") for word in found.task)


def _minors(context: Context, found: Singularities) -> Iterator[Block]:
    """Where a matrix that is not square, or is singular everywhere, has less than its usual rank."""
    _, matrix = context.text, _symbol(found).tex
    if found.task:
        yield context.paragraph("Let $\\mathbf{J}'$ be the Jacobian of the task %(task)s.", task=_task(context, found))
    words = _(
        "$%(matrix)s$ has %(rows)s rows and %(columns)s columns. A configuration is singular if its rank is lower "
        "than usual.",
        matrix=matrix,
        rows=found.shape[0],
        columns=found.shape[1],
    )
    if found.rank is not None:
        rank = _("Its rank is %(rank)s, and less only where all its minors of this size are zero.", rank=found.rank)
        words += " " + rank
    if found.square:
        square = found.square.replace("*", "\\,").replace("J", matrix)
        words += " " + _("That is where $%(condition)s$.", condition=f"\\det({square}) = 0")
    yield Paragraph(words)
    if found.families:
        yield context.answer("Rank is lost where all equations of a line hold.")
        yield _SingularFormulas(context, found).conditions()
    conditions = ", ".join(f"{context.printer.latex(e)} \\ne 0" for e in found.unless)
    if not found.complete and found.families:
        closing = _("There may be other such configurations, of which no closed form was found.")
    elif not found.complete:
        closing = _("No closed form of this condition was found.")
    elif found.families:
        limited = _("Nowhere else is rank lost, as long as $%(conditions)s$.", conditions=conditions)
        closing = limited if conditions else _("Nowhere else is rank lost.")
    else:
        limited = _("The rank is never less, as long as $%(conditions)s$.", conditions=conditions)
        closing = limited if conditions else _("The rank is never less.")
    yield Paragraph(closing, is_answer=True)


def _symbol(found: Singularities) -> Box:
    """The matrix whose determinant is printed: J, or J' for a task."""
    return Box("\\mathbf{J}'", 14.0) if found.task else bold("J")


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

    def determinant(self) -> SheetFormula:
        """The determinant in factors, those that are too long by their numbers of terms."""
        left = concatenate(_DETERMINANT, _symbol(self.found))
        if not self._long:
            value = self.found.determinant
            terms = sum(expanded_terms(f.expression) for f in self.found.factors) or int(value not in (None, 0))
            item, limit = Item(left, terms, lambda: value), self.context.policy.grouped_terms
            laid_out = self.context.layouter.entries([item], group=Group.DETERMINANT + 1, limit=limit)
            task = self.context.text("Find $%(determinant)s$ in factors.", determinant=left.tex)
            return formula(self.context, laid_out, task=task)
        product = sympy.Mul(*(self._short(f) ** f.exponent for f in self.found.factors))
        lines = break_lines(equated(left), self._printer.pieces(product))
        word, comma = self.context.layouter.terms_word, self.context.text.comma
        items = (Item(self._names[s], expanded_terms(f.expression), lambda: None) for s, f in self._long.items())
        long = (omitted(item, word, comma=comma) for item in items)
        return SheetFormula(rows=(Rows(tuple(lines)),), omitted=tuple(pack(long)))

    def conditions(self) -> SheetFormula:
        """Where each factor that moves with the arm is zero, or all factors of a line."""
        lines = [line for family in self.found.families for line in break_lines(EMPTY, list(self._zeros(family)))]
        present = [condition.posture for family in self.found.families for condition in family]
        note = " ".join(meaning for posture, (_word, meaning) in self._words.items() if posture in present)
        task = self.context.text("In which configurations does $%(matrix)s$ lose rank?", matrix=_symbol(self.found).tex)
        return SheetFormula(rows=(Rows(tuple(lines)),), note=note, task=task, blanks=() if self._long else ("",))

    def _zeros(self, family: Sequence[Condition]) -> Iterator[TexPiece]:
        """``s_5 = 0 <=> q_5 = 0 or pi (wrist)`` for each condition."""
        text = self.context.text
        for k, condition in enumerate(family):
            if k:
                yield TexPiece(Box(",\\quad ", 14.0), Break.COMMA)
            values = condition.values
            if not condition.is_solution:
                yield from self._printer.pieces(self._short(condition))
                yield _IS_ZERO
            if values and condition.expression != condition.variable:
                if not condition.is_solution:
                    yield _IF_AND_ONLY_IF
                yield from self._printer.pieces(condition.variable)
                yield TexPiece(EQUALS)
                if len(values) == 2 and values[0] == -values[1]:
                    yield TexPiece(Box("\\pm ", 8.0))
                    values = values[1:]
                for index, value in enumerate(values):
                    if index:
                        word = text("or")
                        yield TexPiece(Box(f"\\ \\text{{{word}}}\\ ", 8.0 + _LETTER_WIDTH * len(word)), Break.COMMA)
                    yield from self._printer.angle(value)
            real = [] if condition.is_certain else [text("where it has real solutions")]
            posture = [self._words[condition.posture][0]] if condition.posture in self._words else []
            for word in posture + real:
                yield TexPiece(Box(f"\\quad \\text{{({word})}}", 18.0 + _LETTER_WIDTH * len(word)), Break.COMMA)

    def _short(self, factor: SingularFactor | Condition) -> Expr:
        same = (symbol for symbol, long in self._long.items() if long.expression == factor.expression)
        return next(same, factor.expression)

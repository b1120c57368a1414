"""The part with the singularities: a square block of J, its determinant in factors, and where each of them is zero."""

from __future__ import annotations

from collections.abc import Iterator

from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Section, Steps
from derive.emit.handout.formula import formula
from derive.emit.handout.singular_formulas import SingularFormulas
from derive.emit.latex.metrics import EMPTY, Box, italic, script
from derive.emit.latex.symbols import EntryNamer, bold
from derive.emit.singularity import SingularBlock, SingularityQuantity

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

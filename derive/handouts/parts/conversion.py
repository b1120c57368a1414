"""The part with the table of the other convention: the same factors in other brackets, and what moves to the ends."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import compress

from derive.handouts.layout.lines import Equation, equated, equation_lines, pack
from derive.handouts.notation.pieces import EMPTY, Box, Break, TexPiece, concatenate, italic, script
from derive.handouts.notation.symbols import bold
from derive.handouts.parts.kinematics import transforms
from derive.handouts.parts.table import BASE, TOOL, end_lines, link_equations, table_rows
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Paragraph, Rows
from derive.mechanics.convention import Conversion, convert
from derive.model.entries import ModelEntries
from derive.model.model import Model
from derive.robot import tree
from derive.robot.description import IDENTITY
from derive.robot.expression import ZERO
from derive.robot.robot import Robot

NEW_BASE = Box("\\mathbf{T}'_{\\mathrm{base}}", 32.0)
NEW_TOOL = Box("\\mathbf{T}'_{\\mathrm{tool}}", 32.0)
FEW_FACTORS = 7  # so many brackets of a product are all written; of more the first two and the last
_DEFINITIONS = (
    "\\mathbf{Z}_i = \\mathrm{Rot}_z(\\theta_i)\\,\\mathrm{Trans}_z(d_i)",
    "\\mathbf{X}_i = \\mathrm{Trans}_x(a_i)\\,\\mathrm{Rot}_x(\\alpha_i) "
    "= \\mathrm{Rot}_x(\\alpha_i)\\,\\mathrm{Trans}_x(a_i)",
)


def conversion(context: Context) -> Iterator[Block]:
    """Both tables as one product, the new table with its transforms, and the links in its frames."""
    _ = context.text
    tree.require_chain(context.robot, "the table of the other convention")
    found = convert(context.robot)
    new = Context(ModelEntries(Model(Robot.of(found.result))), context.options, _, policy=context.policy)
    yield context.paragraph(
        "The standard and the modified convention multiply the same motions $\\mathbf{Z}_i$ and the same constant "
        "factors $\\mathbf{X}_i$, in other brackets:"
    )
    yield Rows(_DEFINITIONS)
    words = {True: _("standard"), False: _("modified")}
    # A base, and a tool, stand in both products where one of the two tables has them.
    pairs = ((found.source.base, found.result.base), (found.source.tool, found.result.tool))
    ends = [any(frame != IDENTITY for frame in pair) for pair in pairs]
    for one, base, tool in ((context, BASE, TOOL), (new, NEW_BASE, NEW_TOOL)):
        yield Paragraph(f"{words[one.is_standard].capitalize()}:")
        yield Rows(tuple(equation_lines([_product(one, base if ends[0] else None, tool if ends[1] else None)])))
    yield context.paragraph(
        "Each row of the new table takes the constant factor of a neighbouring row; the remaining factor goes into "
        "the base or the tool."
    )
    before, behind = (Box("-1", 8.0), EMPTY) if context.is_standard else (EMPTY, Box("-1", 8.0))
    first, last = script(bold("X"), italic("0"), before), script(bold("X"), italic(str(context.robot.n)), behind)
    if moved := pack(compress((equated(NEW_BASE, BASE, first), equated(NEW_TOOL, last, TOOL)), ends)):
        yield Rows(tuple(moved))
    yield from table_rows(new)
    if lines := end_lines(new, NEW_BASE, NEW_TOOL):
        yield Rows(tuple(lines))
    yield from transforms(new)
    if context.robot.has_dynamics:
        yield context.paragraph(
            "The product of the same factors is the same $%(end)s$, and the Jacobian, the inertia matrix and the "
            "torques are the same functions.",
            end=bold("T").tex,
        )
    else:
        yield context.paragraph(
            "The product of the same factors is the same $%(end)s$, and the Jacobian is the same function.",
            end=bold("T").tex,
        )
    yield from _links(new, found)


def _factor(letter: str, index: int) -> Box:
    return script(bold(letter), italic(str(index)))


def _product(context: Context, base: Box | None, tool: Box | None) -> Equation:
    n = context.robot.n
    opening, closing = Box("(", 5.0), Box(")\\,", 7.0)  # a line may end at the space
    boxes = [] if base is None else [base]
    for i in range(1, n + 1) if n <= FEW_FACTORS else (1, 2, n):
        pair = (_factor("Z", i), _factor("X", i)) if context.is_standard else (_factor("X", i - 1), _factor("Z", i))
        boxes += [Box("\\cdots ", 15.0)] if i == n and n > FEW_FACTORS else []
        boxes.append(concatenate(opening, *pair, closing))
    boxes += [] if tool is None else [tool]
    return Equation(bold("T"), tuple(TexPiece(box, Break.COMMA if k else Break.NEVER) for k, box in enumerate(boxes)))


def _links(new: Context, found: Conversion) -> Iterator[Block]:
    """The links that are written otherwise in the frames of the new table."""
    pairs = enumerate(zip(found.source.links, found.result.links, strict=True), 1)
    if changed := [(i, after) for i, (before, after) in pairs if before != after]:
        yield new.paragraph("Frame $i$ of the new table is at another place on link $i$; relative to it:")
    for i, link in changed:
        yield new.paragraph("Link %(index)s:", index=i)
        body = replace(link, motor=None, armature=ZERO, viscous=ZERO, coulomb=ZERO)
        yield Rows(tuple(equation_lines(link_equations(new, body))))
    if found.notes:
        yield new.paragraph(
            "The two conventions place this rotor differently; it stays where it is, and the link that carries it "
            "compensates for the difference."
        )

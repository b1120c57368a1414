"""The part with closed loops: what their passive joints are, by elementary equations, and how fast they move."""

from collections.abc import Iterator, Sequence
from functools import partial

from derive.handouts.layout.quantity import Item
from derive.handouts.parts.inverse import InversePart
from derive.handouts.parts.inverse_words import and_list
from derive.handouts.parts.table import end_lines, table_rows, tool_of
from derive.handouts.sheet.context import Context, formula
from derive.handouts.sheet.document import Block, Rows
from derive.model.closure import LoopClosure
from derive.model.entries import ModelEntries, expanded_terms
from derive.model.model import Model
from derive.robot.description import Joining

_MOST_SECOND = 12  # second derivatives that are printed


def closure(context: Context) -> Iterator[Block]:
    """The loops in the order in which they are solved, and the derivatives of all passive joints."""
    if not context.robot.loops:
        return
    loops = context.entries.model.closure.loops
    for number, one in enumerate(loops, 1):
        yield from _loop(context, one, f"loop{number}" if len(loops) > 1 else "loop")
    yield context.paragraph(
        "The derivatives of the passive joints by the variables, $G$ the first and $H$ the second ones, follow from "
        "the velocities of the joined frames: $\\mathbf{G} = -\\mathbf{J}_p^{-1}\\,\\mathbf{J}_a$ where "
        "$\\mathbf{J}_p\\,\\dot{\\mathbf{q}}_p + \\mathbf{J}_a\\,\\dot{\\mathbf{q}} = \\mathbf{0}$."
    )
    yield from _derivatives(context, loops)


def _loop(context: Context, one: LoopClosure, name: str) -> Iterator[Block]:
    """One loop: its unknown joints as an arm, what is known of the pose of that arm, and the solution."""
    entries = ModelEntries(Model(one.inverse.robot))
    own = Context(entries, context.options, context.text, context.version, None, context.policy, context, name)
    part = InversePart(own, one.inverse)
    writer = part.writer
    yield context.paragraph(
        "Rows `%(first)s` and `%(second)s` are joined (`by: %(by)s`). The unknown joints of the loop are a serial arm, "
        "whose joints and frames are counted from 1 here, with this table in the modified convention:",
        first=one.loop.join[0],
        second=one.loop.join[1],
        by=one.loop.by.value,
    )
    yield from table_rows(own)
    if one.loop.by is Joining.DISTANCE:
        yield context.paragraph("Its first link is the rod, which may have any direction.")
    yield from own.announced("Before the first of them and behind the last:", end_lines(own, tool=tool_of(name)))
    pose = own.symbols.of_end("T").tex
    yield context.paragraph("The variables determine these entries of its pose $%(pose)s$:", pose=pose)
    yield Rows(tuple(row for line in one.known for row in writer.rows(line)))
    yield part.number_of_solutions()
    yield from part.decoupled()
    yield from part.derived()
    lines = zip(one.solution.lines[len(one.known) :], one.inverse.named_lines, strict=True)
    chosen = tuple(row for line, each in lines if each.signs for row in writer.rows(line))
    yield from context.announced("The robot file chooses this assembly:", chosen)
    if one.zeros:
        where = and_list(context.text, [f"${context.printer.latex(zero)} = 0$" for zero in one.zeros], either=True)
        yield context.paragraph("$G$ and $H$ have no values where %(zeros)s.", zeros=where)


def _derivatives(context: Context, loops: Sequence[LoopClosure]) -> Iterator[Block]:
    slopes = {name: one.slope for one in loops for name in one.names}
    second = [name for name in slopes if name.startswith("H_")]
    if is_left_out := len(second) > _MOST_SECOND:
        slopes = {name: slope for name, slope in slopes.items() if name not in second}
    values = {name: slope(name) for name, slope in slopes.items()}
    glyph = context.notation.glyph
    items = [Item(glyph(name).box, expanded_terms(e), partial(values.__getitem__, name)) for name, e in values.items()]
    task = context.text("Find the derivatives of the passive joints.")
    yield formula(context, context.layouter.entries(items), task=task)
    if is_left_out:
        yield context.answer("The second derivatives are too many to print.")

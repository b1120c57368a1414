"""The part with the transform of each row of the table."""

from __future__ import annotations

from collections.abc import Iterator

from derive.emit.handout.context import Context
from derive.emit.handout.document import Paragraph, Section
from derive.emit.handout.formula import formula
from derive.emit.handout.kinematics import (
    Whole,
    entry_namer,
    packed,
    rows_group,
    transform_block,
    whole,
)
from derive.emit.latex.quantity import Block


def section(context: Context) -> Section:
    """A_1 ... A_n."""
    _ = context.text
    introduction = Paragraph(_("Frame $i$ in frame $i-1$, row by row:"))
    formulas = (formula(context, block, "link_transforms") for block in _blocks(context))
    return Section("transforms", _("Transforms of the rows"), (introduction, *formulas))


def _blocks(context: Context) -> Iterator[Block]:
    """Those that fit share lines; the others are given entry by entry."""
    side_by_side: list[Whole] = []
    for i in range(1, context.robot.n + 1):
        symbol, quantity = context.symbols.frame("A", i, i - 1), context.quantities[f"A[{i}]"]
        fitting = whole(context, symbol, quantity, entry_namer(symbol))
        if fitting is not None:
            side_by_side.append(fitting)
            continue
        if side_by_side:
            yield packed(side_by_side)
        yield transform_block(context, symbol, quantity, rows_group(i))
        side_by_side = []
    if side_by_side:
        yield packed(side_by_side)

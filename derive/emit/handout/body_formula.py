"""Quantities of single bodies as formulas: no generated function computes them, and small ones stand side by side."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from derive.emit.handout import document
from derive.emit.handout.context import Context
from derive.emit.handout.document import Paragraph, Rows
from derive.emit.handout.formula import formula
from derive.emit.handout.kinematics import Whole, entry_namer, packed, whole
from derive.emit.latex.metrics import Box
from derive.emit.latex.quantity import Block


@dataclass(frozen=True, slots=True)
class BodyItem:
    """A quantity of one body.

    Attributes:
        symbol: What it is called.
        name: Its name among the quantities.
        index: A number of its own for every such quantity.
        symmetric: Whether the entries below the diagonal may be left out.
    """

    symbol: Box
    name: str
    index: int
    symmetric: bool = False


def body_formulas(context: Context, items: Iterable[BodyItem]) -> Iterator[document.Block]:
    """Each quantity in its order; neighbours that fit share lines."""
    row: list[Whole] = []
    for item in items:
        small = whole(context, item.symbol, context.quantities[item.name], entry_namer(item.symbol))
        if small is not None:
            row.append(small)
            continue
        yield from _shared(context, row)
        row = []
        yield from _alone(context, context.dynamics.body(item.symbol, item.name, item.index, item.symmetric))
    yield from _shared(context, row)


def _shared(context: Context, row: list[Whole]) -> Iterator[document.Block]:
    if row:
        yield formula(context, packed(row))


def _alone(context: Context, block: Block) -> Iterator[document.Block]:
    """The formula, then what is too long in it with its numbers of terms."""
    if block.lines or not block.omitted:
        yield replace(formula(context, block), omitted=())
    if block.omitted:
        _ = context.text
        yield Paragraph(_("Too long to print; multiplied out the numbers of terms are as follows."))
        yield Rows(block.omitted)

"""From a laid-out quantity to a formula of the handout: notes, entries to copy, blanks of an exercise.

Quantities of single bodies as formulas: no generated function computes them, and small ones stand side by side.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import overload

from derive.handout import document
from derive.handout.context import Context
from derive.handout.document import Entry, Formula, Paragraph, Rows
from derive.handout.frames import Whole, entry_namer, packed, whole
from derive.handout.layout.quantity import LaidOut
from derive.handout.notation.pieces import Box
from derive.handout.notation.text import PlainPrinter


def formula(context: Context, block: LaidOut, function: str = "") -> Formula:
    """A quantity as a formula.

    Args:
        context: The handout.
        block: The laid-out quantity.
        function: The generated function that computes it.
    """
    return Formula(
        rows=_rows(block),
        named=block.named,
        omitted=block.omitted,
        note=_note(context, block),
        function=function,
        entries=_Copied(context, block),
        blanks=block.blanks,
    )


class _Copied(Sequence[Entry]):
    """Entries of a quantity for copying, written when they are looked at: paper has no use for them."""

    def __init__(self, context: Context, block: LaidOut) -> None:
        self._values = block.values
        self._latex = context.printer.latex

    @cached_property
    def _entries(self) -> tuple[Entry, ...]:
        python = PlainPrinter().doprint
        return tuple(Entry(name.tex, self._latex(value), python(value)) for name, value in self._values)

    def __len__(self) -> int:
        return len(self._values)

    @overload
    def __getitem__(self, place: int) -> Entry: ...

    @overload
    def __getitem__(self, place: slice) -> tuple[Entry, ...]: ...

    def __getitem__(self, place: int | slice) -> Entry | tuple[Entry, ...]:
        return self._entries[place]


def _rows(block: LaidOut) -> tuple[Rows, ...]:
    upright = (Rows(block.lines),) if block.lines else ()
    turned = (Rows(block.landscape, landscape=True),) if block.landscape else ()
    return upright + turned


def _note(context: Context, block: LaidOut) -> str:
    _ = context.text
    if not block.by_entry:
        return ""
    if block.has_zeros and block.symmetric:
        return _("The matrix is symmetric; entries that are not listed are zero.")
    if block.symmetric:
        return _("The matrix is symmetric.")
    return _("Entries that are not listed are zero.") if block.has_zeros else ""


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


def _alone(context: Context, block: LaidOut) -> Iterator[document.Block]:
    """The formula, then what is too long in it with its numbers of terms."""
    if block.lines or not block.omitted:
        yield replace(formula(context, block), omitted=())
    if block.omitted:
        _ = context.text
        yield Paragraph(_("Too long to print; multiplied out the numbers of terms are as follows."))
        yield Rows(block.omitted)

"""From a laid-out quantity to a formula of the handout: notes, entries to copy, blanks of an exercise."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import overload

from derive.emit.handout.context import Context
from derive.emit.handout.document import Entry, Formula, Rows
from derive.emit.latex.quantity import Block
from derive.emit.text_printer import PlainPrinter


def formula(context: Context, block: Block, function: str = "") -> Formula:
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

    def __init__(self, context: Context, block: Block) -> None:
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


def _rows(block: Block) -> tuple[Rows, ...]:
    upright = (Rows(block.lines),) if block.lines else ()
    turned = (Rows(block.landscape, landscape=True),) if block.landscape else ()
    return upright + turned


def _note(context: Context, block: Block) -> str:
    _ = context.text
    if not block.by_entry:
        return ""
    if block.has_zeros and block.symmetric:
        return _("The matrix is symmetric; entries that are not listed are zero.")
    if block.symmetric:
        return _("The matrix is symmetric.")
    return _("Entries that are not listed are zero.") if block.has_zeros else ""

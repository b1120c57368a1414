"""Quantities of single bodies as formulas: no generated function computes them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from derive.emit.handout import document
from derive.emit.handout.context import Context
from derive.emit.handout.document import Paragraph, Rows
from derive.emit.handout.formula import formula
from derive.emit.latex.quantity import Block


def body_formula(context: Context, block: Block) -> Iterator[document.Block]:
    """The formula, then what is too long in it with its numbers of terms."""
    found = formula(context, block)
    if block.lines or not block.omitted:
        yield replace(found, omitted=())
    if block.omitted:
        _ = context.text
        yield Paragraph(_("Too long to print; multiplied out the numbers of terms are as follows."))
        yield Rows(block.omitted)

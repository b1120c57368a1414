"""Matrices and vectors of numbers on the handout."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from derive.emit.handout.context import Context
from derive.emit.handout.document import Entry, Formula, Rows
from derive.emit.latex.layout import EQUALS, fits, matrix, pack
from derive.emit.latex.metrics import MINUS_WIDTH, Box, concatenate, italic, script
from derive.emit.latex.numbers import magnitude

DIGITS = 5
"""Significant digits in print."""

COPIED_DIGITS = 12
"""Significant digits of what is copied: beyond them machines differ."""

NOISE = 1e-12
"""Part of the largest entry below which an entry is zero up to rounding."""

Values = Sequence[Sequence[float]]


def cleaned(rows: Values) -> list[list[float]]:
    """The entries without what only rounding left over."""
    threshold = NOISE * max(1.0, *(abs(value) for row in rows for value in row))
    return [[value if abs(value) > threshold else 0.0 for value in row] for row in rows]


def number(value: float) -> Box:
    """A number with a few significant digits."""
    rounded = Fraction(f"{value:.{DIGITS}g}")
    size = magnitude(rounded, decimals=True, digits=DIGITS)
    return concatenate(Box("-", MINUS_WIDTH), size) if rounded < 0 else size


def matrix_formula(context: Context, symbol: Box, rows: Values, function: str) -> Formula:
    """A matrix; column by column if it is too wide.

    Args:
        context: The handout.
        symbol: Its name.
        rows: Its entries.
        function: The generated function that computes it.
    """
    rows = cleaned(rows)
    box = concatenate(symbol, EQUALS, matrix([[number(value) for value in row] for row in rows]))
    copied = (Entry(symbol.tex, box.tex[len(symbol.tex + EQUALS.tex) :], _python(rows)),)
    blanks = (symbol.tex,)
    if fits(box, len(rows)):
        return Formula((Rows((box.tex,)),), function=function, entries=copied, blanks=blanks)
    lines = tuple(pack(_columns(symbol, rows)))
    note = context.text("Column by column.")
    return Formula((Rows(lines),), note=note, function=function, entries=copied, blanks=blanks)


def vector_formula(names: Sequence[Box], values: Sequence[float], units: Sequence[Box], function: str) -> Formula:
    """Components one by one, each with its unit."""
    values = [row[0] for row in cleaned([[value] for value in values])]
    boxes = [
        concatenate(name, EQUALS, number(value), unit) for name, value, unit in zip(names, values, units, strict=True)
    ]
    entries = tuple(
        Entry(name.tex, number(value).tex, _copied(value)) for name, value in zip(names, values, strict=True)
    )
    return Formula(
        (Rows(tuple(pack(boxes))),), function=function, entries=entries, blanks=tuple(name.tex for name in names)
    )


def _columns(symbol: Box, rows: Values) -> Iterator[Box]:
    for k, column in enumerate(zip(*rows, strict=True), 1):
        entries = matrix([[number(value)] for value in column])
        yield concatenate(script(symbol, italic(str(k))), EQUALS, entries)


def _python(rows: Values) -> str:
    return "[" + ", ".join("[" + ", ".join(map(_copied, row)) + "]" for row in rows) + "]"


def _copied(value: float) -> str:
    return f"{value:.{COPIED_DIGITS}g}"

"""What the Newton-Euler recursion of one robot is made of: rotations, arms, masses and inertias of its links."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from derive.algebra.to_sympy import expression_to_sympy
from derive.emit.handout.context import Context
from derive.emit.handout.document import Entry, Formula, Rows
from derive.emit.handout.recursion import Recursion, vector
from derive.emit.latex.layout import EQUALS, Equation, equation_lines, fits, matrix, pack
from derive.emit.latex.metrics import Box, concatenate, italic, script
from derive.emit.latex.pieces import joined
from derive.emit.latex.printer import LatexPrinter
from derive.emit.text_printer import PlainPrinter
from derive.robot.robot import Convention

Cells = Sequence[Sequence[Any]]


@dataclass(frozen=True)
class Constant:
    """A matrix or vector of a link.

    Attributes:
        symbol: What it is called.
        cells: Its entries.
        data: Whether they are the user's numbers, printed with every digit.
    """

    symbol: Box
    cells: Cells
    data: bool = False


def link_constants(context: Context, recursion: Recursion, i: int) -> Formula:
    """R_i^{i-1}, p_i, r_i, m_i and I_i of link i (from 1), one formula."""
    lines: list[str] = []
    whole: list[Box] = []
    entries: list[Entry] = []
    constants = list(_constants(context, recursion, i))
    for constant in constants:
        printer = context.printer if not constant.data else LatexPrinter(context.data.notation)
        box = _whole(printer, constant)
        if box is not None:
            whole.append(box)
        else:
            lines += equation_lines(_equations(printer, constant))
        entries += _entries(printer, constant)
    blanks = tuple(constant.symbol.tex for constant in constants)
    return Formula((Rows((*pack(whole), *lines)),), entries=tuple(entries), blanks=blanks)


def _constants(context: Context, recursion: Recursion, i: int) -> Iterator[Constant]:
    index, link = str(i), context.robot.links[i - 1]
    row = context.quantities[f"A[{i}]"]
    yield Constant(recursion.rotation(index, str(i - 1)), [[row.entry(r, c) for c in (1, 2, 3)] for r in (1, 2, 3)])
    yield Constant(recursion.offset(index), _arm(context, i))
    yield Constant(recursion.com(index), [[expression_to_sympy(cell)] for cell in link.com], data=True)
    yield Constant(script(italic("m"), italic(index)), [[expression_to_sympy(link.mass)]], data=True)
    t = link.inertia
    tensor = ((t.xx, t.xy, t.xz), (t.xy, t.yy, t.yz), (t.xz, t.yz, t.zz))
    cells = [[expression_to_sympy(cell) for cell in cells] for cells in tensor]
    yield Constant(vector("I", index), cells, data=True)


def _arm(context: Context, i: int) -> Cells:
    """From o_{i-1} to o_i: in frame i (standard), where it is constant, or in frame i-1 (modified)."""
    if context.robot.convention is Convention.STANDARD:
        back = context.quantities[f"T[{i},{i - 1}]"]
        return [[-back.entry(r, 4)] for r in (1, 2, 3)]
    row = context.quantities[f"A[{i}]"]
    return [[row.entry(r, 4)] for r in (1, 2, 3)]


def _whole(printer: LatexPrinter, constant: Constant) -> Box | None:
    rows = [[joined(printer.pieces(cell)) for cell in row] for row in constant.cells]
    right = rows[0][0] if len(rows) == 1 else matrix(rows)
    box = concatenate(constant.symbol, EQUALS, right)
    return box if fits(box, len(rows)) else None


def _named(constant: Constant) -> Iterator[tuple[Box, Any]]:
    """The entries with their names."""
    held = concatenate(Box("(", 5.0), constant.symbol, Box(")", 5.0))
    for r, row in enumerate(constant.cells, 1):
        for c, cell in enumerate(row, 1):
            index = f"{r}{c}" if len(row) > 1 else str(r)
            yield constant.symbol if len(constant.cells) == 1 else script(held, italic(index)), cell


def _equations(printer: LatexPrinter, constant: Constant) -> list[Equation]:
    return [Equation(name, tuple(printer.pieces(cell))) for name, cell in _named(constant) if cell != 0]


def _entries(printer: LatexPrinter, constant: Constant) -> Iterator[Entry]:
    python = PlainPrinter()
    for name, cell in _named(constant):
        yield Entry(name.tex, printer.latex(cell), python.doprint(cell))

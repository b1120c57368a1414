r"""One section as LaTeX for ``\input`` into other notes, whatever their class, letters and columns.

A line of the sheet has a known width; a fragment does not know where it will stand. It brings a few definitions in a
group of its own, by which TeX breaks equations, chooses between a matrix and its entries, and makes a table or a figure
smaller, all by the ``\linewidth`` that it finds.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from derive.handouts.figure.writers import PREAMBLE, latex_drawing
from derive.handouts.layout.flow import breakable, matrix_equation, whole_equations
from derive.handouts.sheet.document import (
    Blank,
    Block,
    Figure,
    Paragraph,
    Rows,
    Section,
    SheetFormula,
    Steps,
    Table,
    blocks_of,
)
from derive.handouts.sheet.formula import unlisted
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import latex_words, macros, omitted_words

_WIDEST = 10  # columns that amsmath's matrices have unless told otherwise


@dataclass(frozen=True, slots=True)
class _Item:
    """An equation in a fragment."""

    whole: str  # its LaTeX; with marks where a line may end, unless it is a matrix
    matrix: bool = False  # whether there are entries to print where the line is too narrow for the whole
    entries: tuple[str, ...] = ()  # the entries, with such marks
    note: str = ""  # what else a reader of the entries must know
    is_whole: bool = False  # whether it cannot be broken


def fragment(section: Section, text: Text, *, name: str, robot: str, version: str, width: str = "") -> str:
    r"""A section in a group of its own."""
    blocks = list(blocks_of(section))
    is_drawn = any(isinstance(block, Figure) for block in blocks)
    written = "".join(_written(block, text) for block in section.blocks)
    matrices = re.findall(r"\\begin\{bmatrix\}(.*?)\\end\{bmatrix\}", written, re.DOTALL)
    columns = max((row.count("&") + 1 for matrix in matrices for row in matrix.split("\\\\")), default=0)
    heading = _macro(
        "heading",
        name=name,
        robot=robot,
        version=version,
        packages="".join(f"\\usepackage{{{package}}}" for package in ("amsmath", *(["graphicx"] if is_drawn else []))),
        columns=columns if columns > _WIDEST else 0,
        width=width,
        preamble=PREAMBLE.rstrip() if is_drawn else "",
        has_tables=any(isinstance(block, Table) for block in blocks),
    )
    return heading + written + _macro("ending")


def _macro(macro: str, **values: object) -> str:
    source: str = getattr(macros("fragment.tex.jinja"), macro)(**values)
    return source


def _words(text: str) -> str:
    """A text whose inline products may be broken behind a bracket."""
    return latex_words(text).replace(")\\,", ")\\,\\allowbreak ")


def _written(block: Block, text: Text) -> str:
    match block:
        case Paragraph(words):
            return _macro("paragraph", text=_words(words))
        case Rows(lines):
            return _rows(lines, text)
        case SheetFormula():
            return "".join(_formula(block, text))
        case Blank(_, task):
            return _macro("paragraph", text=_words(task))
        case Table(header, rows):
            head, *body = (" & ".join(map(_words, row)) for row in (header, *rows))
            pairs = (zip(header, row, strict=True) for row in rows)  # in words, for a line that the table does not fit
            items = ["; ".join(f"{_words(name)}: {_words(cell)}" for name, cell in row) for row in pairs]
            return _macro("table", header=head, rows=body, items=items)
        case Figure(drawing, caption):
            return _macro("figure", drawing=latex_drawing(drawing), caption=_words(caption))
        case Steps(title, blocks):
            return _macro("steps", title=_words(title)) + "".join(_written(inner, text) for inner in blocks)


def _formula(block: SheetFormula, _: Text) -> Iterator[str]:
    lines = [line for rows in block.rows for line in rows.lines]
    if block.named:
        yield _macro("paragraph", text=_words(_("With the abbreviations")))
        yield _rows(block.named, _)
        yield _macro("paragraph", text=_words(_("the entries are as follows.")))
    if lines:
        is_alone = len(whole_equations(lines)) == 1 and matrix_equation(lines[0]) is not None
        entries = [entry for entry in block.entries if "\\begin" not in entry.latex] if is_alone else []
        named = [f"{entry.name} = {entry.latex}" for entry in entries]
        yield _rows(lines, _, named)
    if block.omitted:
        yield _macro("paragraph", text=_words(omitted_words(block, _)))
        yield _rows(block.omitted, _)
    if block.note:
        yield _macro("paragraph", text=_words(block.note))


def _rows(lines: Iterable[str], text: Text, named: Sequence[str] = ()) -> str:
    """Equations; ``named`` are the entries of a matrix that stands alone, in their own names."""
    items = []
    for equation in whole_equations(lines):
        matrix = matrix_equation(equation)
        if matrix is not None:
            entries = tuple(breakable(entry) for entry in named or matrix.entries())
            is_half = matrix.is_symmetric and len(entries) < sum(cell != "0" for row in matrix.cells for cell in row)
            items.append(_Item(equation, True, entries, _words(unlisted(text, is_half, matrix.has_zeros))))
        elif "\\begin" in equation:
            items.append(_Item(equation, is_whole=True))
        else:
            items.append(_Item(breakable(equation)))
    return _macro("rows", items=items)

"""From closed forms to formulas of the handout, and the formulas of textbooks that hold for every robot."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby

from derive.handouts.layout.lines import EQUALS, Equation, equation_lines, fits, matrix, pack
from derive.handouts.layout.quantity import LaidOut, Namer
from derive.handouts.notation.pieces import EMPTY, Box, bracketed, concatenate, italic, joined, script
from derive.handouts.notation.printer import Cell
from derive.handouts.notation.text import PlainPrinter
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Entry, Rows, SheetFormula
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import macros
from derive.model.entries import Entries


def formula(context: Context, laid_out: LaidOut, function: str = "", task: str = "") -> SheetFormula:
    """A laid-out quantity as a formula."""
    rows = [Rows(laid_out.lines)] if laid_out.lines else []
    if laid_out.landscape:
        rows.append(Rows(laid_out.landscape, landscape=True))
    note = unlisted(context.text, laid_out.symmetric, laid_out.has_zeros) if laid_out.by_entry else ""
    python = PlainPrinter().doprint
    return SheetFormula(
        rows=tuple(rows),
        named=laid_out.named,
        omitted=laid_out.omitted,
        note=note,
        function=function,
        entries=lambda: [Entry(name.tex, context.printer.latex(e), python(e)) for name, e in laid_out.values],
        task=task,
        blanks=laid_out.blanks,
    )


def unlisted(text: Text, symmetric: bool, has_zeros: bool) -> str:
    """What a reader must know of a matrix that is printed entry by entry."""
    _ = text
    if symmetric and has_zeros:
        return _("The matrix is symmetric; entries that are not listed are zero.")
    if symmetric:
        return _("The matrix is symmetric.")
    return _("Entries that are not listed are zero.") if has_zeros else ""


def entry_namer(symbol: Box, comma: str = "") -> Namer:
    """Names of the entries of a matrix that has no letter of its own: (A)_{12}."""
    held = bracketed(symbol)
    return lambda row, column: script(held, italic(f"{row}{comma}{column}"))


def component_namer(symbol: Box) -> Namer:
    """Names of the components of a vector: (z_1)_2."""
    held = bracketed(symbol)
    return lambda row, _: script(held, italic(str(row)))


def matrix_lines(symbol: Box, cells: Sequence[Sequence[Cell]], namer: Namer) -> list[str]:
    """A matrix of the robot's data: in brackets if it fits, else entry by entry."""
    box = concatenate(symbol, EQUALS, matrix([[joined(cell) for cell in row] for row in cells]))
    if fits(box, len(cells)):
        return [box.tex]
    places = ((i, j, cell) for i, row in enumerate(cells, 1) for j, cell in enumerate(row, 1))
    return equation_lines(Equation(namer(i, j), cell) for i, j, cell in places)


def small(context: Context, symbol: Box, quantity: Entries, namer: Namer) -> LaidOut | None:
    """A matrix as one box, which may share a line; None if it is too wide or has too many terms."""
    if not quantity.is_short(context.policy.matrix_terms):
        return None
    entries = {place: quantity.entry(*place) for place in quantity.places}
    rows, columns = (range(1, size + 1) for size in quantity.shape)
    cells = [[joined(context.printer.pieces(entries[i, j])) for j in columns] for i in rows]
    box = concatenate(symbol, EQUALS, matrix(cells))
    if not fits(box, len(rows)):
        return None
    values = tuple((namer(*place), value) for place, value in entries.items() if quantity.terms(*place))
    return LaidOut((box.tex,), values=values, blanks=(symbol.tex,), box=box)


def side_by_side(items: Sequence[LaidOut]) -> LaidOut:
    """Small matrices that share lines, as one quantity."""
    return LaidOut(
        tuple(pack(item.box for item in items)),
        values=tuple(value for item in items for value in item.values),
        blanks=tuple(blank for item in items for blank in item.blanks),
    )


def in_rows(quantities: Iterable[LaidOut]) -> Iterator[LaidOut]:
    """Quantities in their order; small neighbours share lines."""
    for is_small, group in groupby(quantities, key=lambda laid_out: laid_out.box != EMPTY):
        neighbours = list(group)
        yield from [side_by_side(neighbours)] if is_small else neighbours


# Of one link or rotor what it is called, the quantity, and which letter its intermediate terms have.
BodyItem = tuple[Box, Entries, int]


def body_formulas(
    context: Context, items: Iterable[BodyItem], task: str = "", *, symmetric: bool = False
) -> Iterator[Block]:
    """Quantities of links and rotors in their order; small neighbours share lines. No generated function gives them."""
    quantities = (
        small(context, symbol, quantity, entry_namer(symbol))
        or context.dynamics.body(symbol, quantity, group, symmetric)
        for symbol, quantity, group in items
    )
    for laid_out in in_rows(quantities):
        if laid_out.lines or not laid_out.omitted:
            yield replace(formula(context, laid_out, task=task), omitted=())
        if laid_out.omitted:
            yield context.answer("These entries are too long to print; multiplied out they have so many terms:")
            yield Rows(laid_out.omitted, is_answer=True)


def textbook(name: str, **values: object) -> Rows:
    """A formula as textbooks print it, such as c_ijk by the derivatives of B."""
    lines: list[str] = []
    for line in getattr(macros("textbook.tex.jinja"), name)(**values).splitlines():
        if line.startswith(" "):
            lines[-1] += f" {line.strip()}"
        elif line:
            lines.append(line)
    return Rows(tuple(lines))

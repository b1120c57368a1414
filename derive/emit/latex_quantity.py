"""Lays out one quantity: as a matrix if it fits, else entry by entry, the rest by its number of terms."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from derive.emit.latex_layout import EQUALS, Equation, displays, equation_lines, fits, matrix, pack
from derive.emit.latex_metrics import Box, concatenate, italic
from derive.emit.latex_names import Glyph
from derive.emit.latex_pieces import joined
from derive.emit.latex_policy import SheetPolicy
from derive.emit.latex_printer import LatexPrinter
from derive.emit.latex_terms import extract
from derive.emit.quantity import Quantity

Place = tuple[int, int]
Namer = Callable[[int, int], Box]


@dataclass(frozen=True, slots=True)
class Block:
    """A quantity on the sheet, as LaTeX.

    Attributes:
        displays: The matrix, or the entries one by one.
        named: Definitions of intermediate terms that the entries use.
        omitted: Entries left to the code, each as ``symbol: N`` rows.
        by_entry: Whether only the entries that are not zero are printed.
        has_zeros: Whether entries were left out because they are zero.
        symmetric: Whether entries below the diagonal were left out.
    """

    displays: tuple[str, ...]
    named: tuple[str, ...] = ()
    omitted: tuple[str, ...] = ()
    by_entry: bool = False
    has_zeros: bool = False
    symmetric: bool = False


@dataclass(frozen=True)
class Layouter:
    """Lays out the quantities of one robot.

    Attributes:
        printer: The robot's printer.
        policy: What is printed.
        term_symbol: (group, index) -> name of an intermediate term.
    """

    printer: LatexPrinter
    policy: SheetPolicy
    term_symbol: Callable[[int, int], Box]

    def block(self, symbol: Box, name: Namer, quantity: Quantity, *, group: int = 0, symmetric: bool = False) -> Block:
        """One matrix.

        Args:
            symbol: Name of the matrix.
            name: (row, column) -> name of an entry.
            quantity: The matrix.
            group: Which letter its intermediate terms have.
            symmetric: Whether the entries below the diagonal may be left out.
        """
        terms = {place: quantity.terms(*place) for place in places(quantity.shape)}
        printed = select(terms, self.policy, symmetric)
        entries = {place: quantity.entry(*place) for place in printed}
        if len(printed) == sum(1 for place, count in terms.items() if count and (place[0] <= place[1] or not symmetric)):
            whole = self._whole(symbol, quantity.shape, entries, symmetric)
            if whole is not None:
                return Block(tuple(displays([whole.tex])))
        return self._by_entry(name, terms, entries, group, symmetric)

    def _whole(self, symbol: Box, shape: Place, entries: dict[Place, Any], symmetric: bool) -> Box | None:
        boxes = {place: joined(self.printer.pieces(entry)) for place, entry in entries.items()}
        if symmetric:
            boxes |= {(j, i): box for (i, j), box in boxes.items()}
        rows = [[boxes.get((i, j), ZERO) for j in range(1, shape[1] + 1)] for i in range(1, shape[0] + 1)]
        box = concatenate(symbol, EQUALS, matrix(rows))
        return box if fits(box, shape[0]) else None

    def _by_entry(
        self, name: Namer, terms: dict[Place, int], entries: dict[Place, Any], group: int, symmetric: bool
    ) -> Block:
        definitions, expressions = extract(list(entries.values()))
        symbols = {symbol.name: self.term_symbol(group, k) for k, (symbol, _) in enumerate(definitions, 1)}
        printer = LatexPrinter(self.printer.notation.with_terms({key: Glyph(box) for key, box in symbols.items()}))
        named = [Equation(symbols[s.name], tuple(printer.pieces(e))) for s, e in definitions]
        shown = [
            Equation(name(*place), tuple(printer.pieces(e))) for place, e in zip(entries, expressions, strict=True)
        ]
        left = {place: count for place, count in terms.items() if count and place not in entries}
        if symmetric:
            left = {(i, j): count for (i, j), count in left.items() if i <= j}
        return Block(
            tuple(displays(equation_lines(shown))),
            tuple(displays(equation_lines(named))),
            tuple(displays(pack(omitted(name(*place), count) for place, count in left.items()))),
            by_entry=True,
            has_zeros=not all(terms.values()),
            symmetric=symmetric,
        )


ZERO = italic("0")


def places(shape: Place) -> Iterator[Place]:
    """All places of a matrix, row by row, counted from 1."""
    return ((i, j) for i in range(1, shape[0] + 1) for j in range(1, shape[1] + 1))


def omitted(name: Box, count: int) -> Box:
    """An entry that is left to the code."""
    text = f" \\colon\\ \\text{{{count} terms}}"
    return Box(name.tex + text, name.width + 12.0 + 5.0 * len(f"{count} terms"))


def select(terms: dict[Place, int], policy: SheetPolicy, symmetric: bool = False) -> Sequence[Place]:
    """The entries to print, in their order: none beyond the budget, the shortest first within it."""
    wanted = [p for p, count in terms.items() if 0 < count <= policy.entry_terms and (p[0] <= p[1] or not symmetric)]
    chosen, total = set(), 0
    for place in sorted(wanted, key=lambda p: (terms[p], p)):
        total += terms[place]
        if total > policy.quantity_terms:
            break
        chosen.add(place)
    return [place for place in wanted if place in chosen]

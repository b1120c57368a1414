"""The dynamics of one robot on its way to the page: B, Christoffel symbols, energies, g, and which of them are short.

The Christoffel symbols are the named intermediate terms of everything that follows from B, see
`derive.handout.rate_forms`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import sympy

from derive.handout.layout.policy import SheetPolicy
from derive.handout.layout.quantity import Item, LaidOut, Layouter, places
from derive.handout.notation.names import Glyph
from derive.handout.notation.pieces import Box, concatenate, italic, script
from derive.handout.notation.printer import LatexPrinter
from derive.handout.notation.symbols import EntryNamer, Symbols, bold
from derive.handout.quantity import Quantities, Quantity
from derive.robot.names import velocity_name
from derive.robot.robot import Robot

Triple = tuple[int, int, int]

KINETIC = Box("\\mathcal{T}", 8.0)
POTENTIAL = Box("\\mathcal{U}", 8.0)

FIRST_BODY_GROUP = 1000
"""Groups of intermediate terms from here on belong to single bodies; those before to quantities and transforms."""

KINETIC_GROUP = FIRST_BODY_GROUP - 1
DERIVATIVE_GROUP = FIRST_BODY_GROUP - 2

_ARGUMENTS = {"g": "(\\mathbf{q})", "C": "(\\mathbf{q}, \\dot{\\mathbf{q}})", "N": "(\\mathbf{q}, \\dot{\\mathbf{q}})"}


@dataclass(frozen=True)
class DynamicsLayout:
    """Lays out the dynamics of one robot.

    Attributes:
        robot: The robot.
        quantities: Its derived quantities.
        layouter: How a quantity is laid out.
        symbols: Names of entries.
        letter: Letter of the inertia matrix.
    """

    robot: Robot
    quantities: Quantities
    layouter: Layouter
    symbols: Symbols
    letter: str = "B"

    # -- symbols

    @property
    def inertia_symbol(self) -> Box:
        """B(q)."""
        return Box(f"\\mathbf{{{self.letter}}}(\\mathbf{{q}})", 30.0)

    def inertia_entry(self, row: int, column: int) -> Box:
        """b_ij, from above the diagonal."""
        return self.symbols.entry(self.letter.lower(), min(row, column), max(row, column))

    def matrix_symbol(self, letter: str) -> Box:
        """C, N or g with its arguments."""
        return Box(f"\\mathbf{{{letter}}}{_ARGUMENTS[letter]}", 36.0)

    def part_symbol(self, letter: str, body: str, i: int) -> Box:
        """A matrix of body i, a link ``l`` or rotor ``m``: B_{l_1}."""
        return script(bold(letter), italic(f"{body}_{{{i}}}"))

    # -- sizes

    @cached_property
    def triples(self) -> tuple[Triple, ...]:
        """i, j, k of the Christoffel symbols that are not zero, j <= k."""
        return tuple(self._nonzero_triples())

    def _nonzero_triples(self) -> Iterator[Triple]:
        n = range(1, self.robot.n + 1)
        for triple in ((i, j, k) for i in n for j in n for k in n if j <= k):
            if self.terms(triple):
                yield triple

    def terms(self, triple: Triple) -> int:
        """Number of terms of a Christoffel symbol."""
        return self.quantities[key(triple)].terms(1, 1)

    def is_compact(self, name: str) -> bool:
        """Whether the closed form is short enough to be printed as it is."""
        return is_short(self.quantities[name], self.layouter.policy.compact_terms)

    # -- closed forms

    def inertia(self) -> LaidOut:
        """B."""
        return self.layouter.block(
            self.inertia_symbol, self.inertia_entry, self.quantities["B"], group=2, symmetric=True, limit=self._limit
        )

    def closed(self, name: str, group: int) -> LaidOut:
        """C or N multiplied out."""
        namer, quantity = EntryNamer(self.symbols, name), self.quantities[name]
        return self.layouter.block(self.matrix_symbol(name), namer, quantity, group=group, limit=self._limit)

    def gravity(self) -> LaidOut:
        """g."""
        return self._vector("g", self.matrix_symbol("g"), lambda row, _: self.symbols.component("g", row))

    def torque(self) -> LaidOut:
        """The equations of motion multiplied out."""
        return self._vector("tau", Box("\\boldsymbol{\\tau}", 8.0), lambda row, _: self.symbols.torque(row))

    def _vector(self, name: str, symbol: Box, component: Callable[[int, int], Box]) -> LaidOut:
        return self.layouter.block(symbol, component, self.quantities[name], group=6, limit=self._limit)

    @property
    def _limit(self) -> int:
        return self.layouter.policy.grouped_terms

    def potential(self) -> LaidOut:
        """U."""
        quantity = self.quantities["potential"]
        return self._scalar(POTENTIAL, quantity.terms(1, 1), lambda: quantity.entry(1, 1), 7)

    def kinetic(self) -> LaidOut | None:
        """The kinetic energy, entry by entry of B; None where that is long."""
        if not self.is_compact("B"):
            return None
        inertia, n = self.quantities["B"], self.robot.n
        above = [(i, j) for i, j in places((n, n)) if i <= j and inertia.terms(i, j)]

        def write() -> Any:
            return sympy.Add(*(inertia.entry(i, j) * self._rates(i, j) for i, j in above))

        return self._scalar(KINETIC, sum(inertia.terms(i, j) for i, j in above), write, KINETIC_GROUP)

    def _rates(self, i: int, j: int) -> Any:
        first, second = (sympy.Symbol(velocity_name(self.robot.joints[k - 1].variable)) for k in (i, j))
        return first**2 / 2 if i == j else first * second

    def _scalar(self, letter: Box, terms: int, write: Callable[[], Any], group: int) -> LaidOut:
        if not terms:
            return LaidOut((letter.tex + " = 0",), blanks=(letter.tex,))
        return replace(
            self.layouter.entries([Item(letter, terms, write)], group=group, limit=self._limit), by_entry=False
        )

    # -- single bodies

    def body(self, symbol: Box, name: str, index: int, symmetric: bool = False) -> LaidOut:
        """A quantity of one body, within a budget that leaves room for those of all the others.

        Args:
            symbol: What it is called.
            name: The quantity.
            index: A number of its own for every such quantity, for its intermediate terms.
            symmetric: Whether the entries below the diagonal may be left out.
        """

        def entry(row: int, column: int) -> Box:
            return script(concatenate(Box("(", 5.0), symbol, Box(")", 5.0)), italic(f"{row}{column}"))

        layouter = replace(self.layouter, policy=_body_policy(self.layouter.policy))
        group, limit = FIRST_BODY_GROUP + index, layouter.policy.flat_terms
        return layouter.block(symbol, entry, self.quantities[name], group=group, symmetric=symmetric, limit=limit)

    # -- Christoffel symbols

    def christoffel(self) -> LaidOut:
        """Each symbol by its expression, or by an earlier symbol that is the same up to the sign."""
        known: dict[Any, Any] = {}
        symbols: dict[str, Glyph] = {}
        items = []
        for index, triple in enumerate(self.triples):
            box = self.symbols.christoffel(*triple)
            alias = sympy.Symbol(f"_c{index}")
            symbols[alias.name] = Glyph(box)
            items.append(Item(box, self.terms(triple), self._christoffel_writer(triple, alias, known)))
        notation = self.layouter.printer.notation.with_terms(symbols)
        layouter = replace(self.layouter, printer=LatexPrinter(notation))
        block = layouter.entries(items, group=3, limit=self._limit)
        return replace(block, has_zeros=True, values=self._spelled_out(block))

    def _spelled_out(self, block: LaidOut) -> tuple[tuple[Box, Any], ...]:
        """Every printed symbol with its own expression, for copying."""
        triples = {self.symbols.christoffel(*triple).tex: triple for triple in self.triples}
        return tuple((name, self.quantities[key(triples[name.tex])].entry(1, 1)) for name, _ in block.values)

    def _christoffel_writer(self, triple: Triple, alias: Any, known: dict[Any, Any]) -> Callable[[], Any]:
        def write() -> Any:
            entry = self.quantities[key(triple)].entry(1, 1)
            if entry in known:
                return known[entry]
            if -entry in known:
                return -known[-entry]
            known[entry] = alias
            return entry

        return write


def key(triple: Triple) -> str:
    """Name of a Christoffel symbol among the quantities."""
    return f"christoffel[{triple[0]},{triple[1]},{triple[2]}]"


def is_short(quantity: Quantity, limit: int) -> bool:
    """Whether all entries together have at most so many terms; long ones are not counted to the end."""
    total = 0
    for row, column in places(quantity.shape):
        total += quantity.terms(row, column)
        if total > limit:
            return False
    return True


def _body_policy(policy: SheetPolicy) -> SheetPolicy:
    return replace(policy, flat_terms=40, quantity_entries=4, entry_lines=6, quantity_lines=24, landscape_total=0)

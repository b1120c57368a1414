"""The dynamics of one robot on its way to the page: B, Christoffel symbols, C, N, energies, g and tau.

What is short is printed multiplied out. Of longer robots C, N and tau are given in named terms, which are the entries
of B, the Christoffel symbols and the components of g.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import sympy

from derive.handout import groups
from derive.handout.layout.lines import EQUALS, Equation, break_lines, equation_lines
from derive.handout.layout.quantity import Item, LaidOut, Layouter, Namer
from derive.handout.notation.names import Glyph
from derive.handout.notation.pieces import EMPTY, Box, Break, Piece, binary, concatenate, italic, script
from derive.handout.notation.printer import MINUS, LatexPrinter
from derive.handout.notation.symbols import EntryNamer, Symbols
from derive.model.dynamic_entries import ModelEntries, RateTerm, Triple
from derive.model.entries import Entries
from derive.robot.names import acceleration_name, velocity_name

Signed = tuple[int, tuple[Box, ...]]
"""A product of boxes with its sign."""

TAU = Box("\\boldsymbol{\\tau}", 8.0)
_KINETIC = Box("\\mathcal{T}", 8.0)
_POTENTIAL = Box("\\mathcal{U}", 8.0)
_DOT_MATRIX_WIDTH = 44.0
_MATRIX_WIDTH = 36.0


@dataclass(frozen=True)
class DynamicsLayout:
    """Lays out the dynamics of one robot.

    Attributes:
        entries: Its closed forms.
        layouter: How a quantity is laid out.
        symbols: Names of entries.
    """

    entries: ModelEntries
    layouter: Layouter
    symbols: Symbols

    # -- symbols

    @property
    def letter(self) -> str:
        """Letter of the inertia matrix."""
        return self.symbols.inertia_letter

    @property
    def inertia_symbol(self) -> Box:
        """B(q)."""
        return Box(f"\\mathbf{{{self.letter}}}(\\mathbf{{q}})", 30.0)

    def inertia_entry(self, row: int, column: int) -> Box:
        """b_ij, always that above the diagonal.

        Args:
            row: Row from 1.
            column: Column from 1.

        Returns:
            Its name.
        """
        return self.symbols.entry(self.letter.lower(), min(row, column), max(row, column))

    # -- which form

    def is_compact(self, quantity: Entries) -> bool:
        """Whether a closed form is short enough to be printed multiplied out.

        Args:
            quantity: The closed form.

        Returns:
            True if it is.
        """
        return quantity.is_short(self.layouter.policy.compact_terms)

    @cached_property
    def coriolis_is_named(self) -> bool:
        """Whether C is given through Christoffel symbols."""
        return not self.is_compact(self.entries.C)

    @cached_property
    def skew_is_named(self) -> bool:
        """Whether N is given through Christoffel symbols."""
        return self.coriolis_is_named or not self.is_compact(self.entries.N)

    @cached_property
    def torque_is_named(self) -> bool:
        """Whether tau is given through entries of B, Christoffel symbols and g."""
        return self.coriolis_is_named or not self.is_compact(self.entries.tau)

    @property
    def torque_is_too_long(self) -> bool:
        """Whether even that is too long, and only the matrix form is given."""
        products = self.layouter.policy.named_products * self.entries.robot.n
        return self.torque_is_named and 2 * len(self.entries.triples) > products

    # -- closed forms

    def inertia(self) -> LaidOut:
        """B."""
        return self._closed(self.inertia_symbol, self.inertia_entry, self.entries.B, groups.B, symmetric=True)

    def coriolis(self) -> LaidOut:
        """C multiplied out."""
        symbol = Box("\\mathbf{C}(\\mathbf{q}, \\dot{\\mathbf{q}})", _MATRIX_WIDTH)
        return self._closed(symbol, EntryNamer(self.symbols, "C"), self.entries.C, groups.C)

    def skew(self) -> LaidOut:
        """N multiplied out."""
        symbol = Box("\\mathbf{N}(\\mathbf{q}, \\dot{\\mathbf{q}})", _MATRIX_WIDTH)
        return self._closed(symbol, EntryNamer(self.symbols, "N"), self.entries.N, groups.N)

    def gravity(self) -> LaidOut:
        """The gravity vector g."""
        symbol = Box("\\mathbf{g}(\\mathbf{q})", _MATRIX_WIDTH)
        return self._closed(symbol, lambda row, _: self.symbols.component("g", row), self.entries.g, groups.TORQUE)

    def torque(self) -> LaidOut:
        """The equations of motion multiplied out."""
        return self._closed(TAU, lambda row, _: self.symbols.torque(row), self.entries.tau, groups.TORQUE)

    def inertia_rate(self) -> LaidOut | None:
        """dB/dt; None where it is long."""
        if not self.is_compact(self.entries.Bdot):
            return None

        def entry(row: int, column: int) -> Box:
            box = self.inertia_entry(row, column)
            return Box(f"\\dot{{{box.tex}}}", box.width)

        symbol = Box(f"\\dot{{\\mathbf{{{self.letter}}}}}(\\mathbf{{q}}, \\dot{{\\mathbf{{q}}}})", _DOT_MATRIX_WIDTH)
        return self._closed(symbol, entry, self.entries.Bdot, groups.DERIVATIVE, symmetric=True)

    def kinetic(self) -> LaidOut | None:
        """The kinetic energy, entry by entry of B; None where that is long."""
        if not self.is_compact(self.entries.B):
            return None
        return self._scalar(_KINETIC, self.entries.kinetic, groups.KINETIC)

    def potential(self) -> LaidOut:
        """The potential energy."""
        return self._scalar(_POTENTIAL, self.entries.potential, groups.POTENTIAL)

    def _closed(self, symbol: Box, name: Namer, quantity: Entries, group: int, symmetric: bool = False) -> LaidOut:
        limit = self.layouter.policy.grouped_terms
        return self.layouter.block(symbol, name, quantity, group=group, symmetric=symmetric, limit=limit)

    def _scalar(self, letter: Box, quantity: Entries, group: int) -> LaidOut:
        terms = quantity.terms(1, 1)
        if not terms:
            return LaidOut((letter.tex + " = 0",), blanks=(letter.tex,))
        item = Item(letter, terms, lambda: quantity.entry(1, 1))
        laid_out = self.layouter.entries([item], group=group, limit=self.layouter.policy.grouped_terms)
        return replace(laid_out, by_entry=False)

    def body(self, symbol: Box, quantity: Entries, group: int, symmetric: bool = False) -> LaidOut:
        """A quantity of one link or rotor, within a budget that leaves room for those of all the others.

        Args:
            symbol: What it is called.
            quantity: The quantity.
            group: Which letter its intermediate terms have.
            symmetric: Whether the entries below the diagonal may be left out.

        Returns:
            Its lines.
        """

        def entry(row: int, column: int) -> Box:
            return script(concatenate(Box("(", 5.0), symbol, Box(")", 5.0)), italic(f"{row}{column}"))

        policy = replace(
            self.layouter.policy,
            flat_terms=40,
            quantity_entries=4,
            entry_lines=6,
            quantity_lines=24,
            landscape_total=0,
        )
        layouter = replace(self.layouter, policy=policy)
        return layouter.block(symbol, entry, quantity, group=group, symmetric=symmetric, limit=policy.flat_terms)

    # -- Christoffel symbols

    def christoffel(self) -> LaidOut:
        """Each symbol by its expression, or by an earlier symbol that is the same up to the sign."""
        known: dict[Any, Any] = {}

        def writer(triple: Triple, alias: Any) -> Callable[[], Any]:
            def write() -> Any:
                entry = self.entries.christoffel(*triple).entry(1, 1)
                if entry in known:
                    return known[entry]
                if -entry in known:
                    return -known[-entry]
                known[entry] = alias
                return entry

            return write

        triples = {self.symbols.christoffel(*triple): triple for triple in self.entries.triples}
        aliases = {box: sympy.Symbol(f"_c{index}") for index, box in enumerate(triples)}
        items = [
            Item(box, self.entries.christoffel(*triple).terms(1, 1), writer(triple, aliases[box]))
            for box, triple in triples.items()
        ]
        notation = self.layouter.printer.notation.with_terms({alias.name: Glyph(box) for box, alias in aliases.items()})
        layouter = replace(self.layouter, printer=LatexPrinter(notation))
        laid_out = layouter.entries(items, group=groups.CHRISTOFFEL, limit=self.layouter.policy.grouped_terms)
        spelled_out = ((box, self.entries.christoffel(*triples[box]).entry(1, 1)) for box, _ in laid_out.values)
        return replace(laid_out, has_zeros=True, values=tuple(spelled_out))

    # -- C, N and tau in named terms

    def named_coriolis(self) -> LaidOut:
        """C through Christoffel symbols."""
        return self._rate_sums("C", {place: self.entries.coriolis_sum(*place) for place in self.entries.C.places})

    def named_skew(self) -> LaidOut:
        """N through Christoffel symbols: the entries above the diagonal; the others follow from N = -N^T."""
        above = ((i, j) for i, j in self.entries.N.places if i < j)
        return self._rate_sums("N", {place: self.entries.skew_sum(*place) for place in above})

    def _rate_sums(self, letter: str, sums: Mapping[tuple[int, int], Sequence[RateTerm]]) -> LaidOut:
        namer = EntryNamer(self.symbols, letter)
        sums = {place: terms for place, terms in sums.items() if terms}
        equations = [
            Equation(
                namer(*place),
                _signed_sum((sign, (self.symbols.christoffel(*triple), self._rate(k))) for sign, triple, k in terms),
            )
            for place, terms in sums.items()
        ]
        short = {place: terms for place, terms in sums.items() if self._is_short(terms)}
        return LaidOut(
            tuple(equation_lines(equations)),
            by_entry=True,
            has_zeros=len(equations) < self.entries.robot.n**2,
            values=tuple((namer(*place), self.entries.rate_value(terms)) for place, terms in short.items()),
            blanks=tuple(equation.left.tex for equation in equations),
        )

    def _is_short(self, terms: Sequence[RateTerm]) -> bool:
        """Whether a sum is worth copying with the Christoffel symbols put in."""
        total = sum(self.entries.christoffel(*term.triple).terms(1, 1) for term in terms)
        return total <= self.layouter.policy.flat_terms

    def named_torque(self) -> LaidOut:
        """Each equation of motion: inertia, centrifugal and Coriolis terms, gravity, friction."""
        joints = range(1, self.entries.robot.n + 1)
        names = {i: self.symbols.torque(i) for i in joints}
        equations = [break_lines(concatenate(names[i], EQUALS), self._torque_pieces(i)) for i in joints]
        limit = self.layouter.policy.flat_terms
        return LaidOut(
            tuple(line for lines in equations for line in lines),
            values=tuple(
                (names[i], self.entries.torque_value(i)) for i in joints if self.entries.tau.terms(i, 1) <= limit
            ),
            blanks=tuple(name.tex for name in names.values()),
        )

    def _torque_pieces(self, i: int) -> tuple[Piece, ...]:
        entries = self.entries
        terms: list[Signed] = [
            (1, (self.inertia_entry(i, j), self._acceleration(j)))
            for j in range(1, entries.robot.n + 1)
            if entries.B.terms(min(i, j), max(i, j))
        ]
        for row, j, k in entries.triples:
            if row == i:
                symbol = self.symbols.christoffel(i, j, k)
                square = (symbol, self._rate(j, italic("2")))
                terms.append((1, square if j == k else (italic("2"), symbol, self._rate(j), self._rate(k))))
        if entries.g.terms(i, 1):
            terms.append((1, (self.symbols.component("g", i),)))
        value = entries.friction(i)
        friction = self.layouter.printer.pieces(value) if value != 0 else []
        if not terms:
            return tuple(friction) or (Piece(italic("0")),)
        if friction:
            friction = [binary("-", 0), *friction[1:]] if friction[0] == MINUS else [binary("+", 0), *friction]
        return (*_signed_sum(terms), *friction)

    def _rate(self, k: int, power: Box = EMPTY) -> Box:
        return self._glyph(velocity_name(self.entries.robot.joints[k - 1].variable), power)

    def _acceleration(self, k: int) -> Box:
        return self._glyph(acceleration_name(self.entries.robot.joints[k - 1].variable), EMPTY)

    def _glyph(self, name: str, power: Box) -> Box:
        return self.layouter.printer.notation.glyph(name).power(power)


def _signed_sum(terms: Iterable[Signed]) -> tuple[Piece, ...]:
    """Pieces of a sum of products, to be broken before a sign or between factors; 0 for an empty sum."""
    row: list[Piece] = []
    for sign, factors in terms:
        if row:
            row.append(binary("+" if sign > 0 else "-", 0))
        elif sign < 0:
            row.append(MINUS)
        row += [Piece(factor, Break.FACTOR if k else Break.NEVER) for k, factor in enumerate(factors)]
    return tuple(row) or (Piece(italic("0")),)

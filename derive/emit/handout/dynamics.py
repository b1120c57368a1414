"""The dynamics on the sheet: B, Christoffel symbols, C, N, g and the equations of motion.

The Christoffel symbols are the named intermediate terms of everything that follows from B: C_ij = sum_k c_i,jk qd_k and
N_ij = sum_k (c_j,ik - c_i,jk) qd_k, for dB_ij/dq_k = c_i,jk + c_j,ik (Siciliano et al., Robotics, eq. 7.44 and 7.47).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import sympy

from derive.algebra.to_sympy import expression_to_sympy
from derive.emit.latex.layout import EQUALS, Equation, displays, equation_lines
from derive.emit.latex.lines import break_lines
from derive.emit.latex.metrics import EMPTY, Box, concatenate, italic
from derive.emit.latex.names import Glyph
from derive.emit.latex.pieces import Break, Piece, binary
from derive.emit.latex.printer import MINUS, LatexPrinter
from derive.emit.latex.quantity import Block, Item, Layouter
from derive.emit.latex.symbols import EntryNamer, Symbols
from derive.emit.quantity import Quantities
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.robot import Robot

Triple = tuple[int, int, int]
Signed = tuple[int, tuple[Box, ...]]


@dataclass(frozen=True, slots=True)
class DynamicsBlocks:
    """The parts of the dynamics as LaTeX.

    Attributes:
        inertia: B.
        christoffel: The Christoffel symbols that are not zero, j <= k.
        coriolis: C.
        skew: N.
        potential: U.
        gravity: g.
        torque: Equations of motion.
        coriolis_named: Whether C is given through Christoffel symbols.
        skew_named: Whether N is.
        torque_named: Whether the equations of motion are given through entries of B, Christoffel symbols and g.
        torque_long: Whether even that is too long, and only the matrix form is given.
    """

    inertia: Block
    christoffel: Block
    coriolis: Block
    skew: Block
    potential: Block
    gravity: Block
    torque: Block
    coriolis_named: bool
    skew_named: bool
    torque_named: bool
    torque_long: bool


@dataclass(frozen=True)
class DynamicsLayout:
    """Lays out the dynamics of one robot.

    Attributes:
        robot: The robot.
        quantities: Its derived quantities.
        layouter: How a quantity is laid out.
        symbols: Names of entries.
    """

    robot: Robot
    quantities: Quantities
    layouter: Layouter
    symbols: Symbols

    def blocks(self) -> DynamicsBlocks:
        """All parts."""
        triples = list(self._nonzero_triples())
        limit = self.layouter.policy.grouped_terms
        inertia = self.layouter.block(
            self._matrix("B"), self._entry("b"), self.quantities["B"], group=2, symmetric=True, limit=limit
        )
        coriolis_named = not self._is_compact("C")
        skew_named = coriolis_named or not self._is_compact("N")
        torque_named = coriolis_named or not self._is_compact("tau")
        torque_long = torque_named and 2 * len(triples) > self.layouter.policy.named_products * self.robot.n
        return DynamicsBlocks(
            inertia=inertia,
            christoffel=self._christoffel(triples),
            coriolis=self._coriolis(triples) if coriolis_named else self._closed("C", 4),
            skew=self._skew(triples) if skew_named else self._closed("N", 5),
            potential=self._potential(),
            gravity=self._vector("g"),
            torque=self._torque(triples, torque_named, torque_long),
            coriolis_named=coriolis_named,
            skew_named=skew_named,
            torque_named=torque_named,
            torque_long=torque_long,
        )

    def _matrix(self, letter: str) -> Box:
        arguments = {"B": "\\mathbf{q}", "g": "\\mathbf{q}"}.get(letter, "\\mathbf{q}, \\dot{\\mathbf{q}}")
        return Box(f"\\mathbf{{{letter}}}({arguments})", 36.0)

    def _entry(self, letter: str) -> EntryNamer:
        return EntryNamer(self.symbols, letter)

    def _is_compact(self, name: str) -> bool:
        """Whether the closed form is short enough to be printed as it is."""
        quantity = self.quantities[name]
        rows, columns = quantity.shape
        total = 0
        for i in range(1, rows + 1):
            total += sum(quantity.terms(i, j) for j in range(1, columns + 1))
            if total > self.layouter.policy.compact_terms:
                return False
        return True

    def _closed(self, name: str, group: int) -> Block:
        limit = self.layouter.policy.grouped_terms
        return self.layouter.block(
            self._matrix(name), self._entry(name), self.quantities[name], group=group, limit=limit
        )

    def _vector(self, name: str) -> Block:
        symbols = self.symbols

        def component(row: int, _: int) -> Box:
            return symbols.torque(row) if name == "tau" else symbols.component(name, row)

        symbol = Box("\\boldsymbol{\\tau}", 8.0) if name == "tau" else self._matrix(name)
        limit = self.layouter.policy.grouped_terms
        return self.layouter.block(symbol, component, self.quantities[name], group=6, limit=limit)

    def _potential(self) -> Block:
        letter = Box("\\mathcal{U}", 8.0)
        quantity, limit = self.quantities["potential"], self.layouter.policy.grouped_terms
        item = Item(letter, quantity.terms(1, 1), lambda: quantity.entry(1, 1))
        if not item.terms:
            return Block(tuple(displays([letter.tex + " = 0"])))
        return self.layouter.entries([item], group=7, limit=limit)

    # -- Christoffel symbols

    def _nonzero_triples(self) -> Iterator[Triple]:
        n = range(1, self.robot.n + 1)
        for triple in ((i, j, k) for i in n for j in n for k in n if j <= k):
            if self._terms(triple):
                yield triple

    def _terms(self, triple: Triple) -> int:
        return self.quantities[_key(triple)].terms(1, 1)

    def _christoffel(self, triples: list[Triple]) -> Block:
        """Each symbol by its expression, or by an earlier symbol that is the same up to the sign."""
        known: dict[Any, Any] = {}
        symbols: dict[str, Glyph] = {}
        items = []
        for index, triple in enumerate(triples):
            box = self.symbols.christoffel(*triple)
            alias = sympy.Symbol(f"_c{index}")
            symbols[alias.name] = Glyph(box)
            items.append(Item(box, self._terms(triple), self._christoffel_writer(triple, alias, known)))
        notation = self.layouter.printer.notation.with_terms(symbols)
        layouter = replace(self.layouter, printer=LatexPrinter(notation))
        block = layouter.entries(items, group=3, limit=layouter.policy.grouped_terms)
        return replace(block, has_zeros=True)

    def _christoffel_writer(self, triple: Triple, alias: Any, known: dict[Any, Any]) -> Callable[[], Any]:
        def write() -> Any:
            entry = self.quantities[_key(triple)].entry(1, 1)
            if entry in known:
                return known[entry]
            if -entry in known:
                return -known[-entry]
            known[entry] = alias
            return entry

        return write

    # -- through named terms

    def _coriolis(self, triples: list[Triple]) -> Block:
        nonzero = set(triples)
        rows = []
        for i, j in self._places():
            ks = [k for k in self._joints() if _sorted(i, j, k) in nonzero]
            terms = [(1, (self.symbols.christoffel(*_sorted(i, j, k)), self._rate(k))) for k in ks]
            if terms:
                rows.append(Equation(self._entry("C")(i, j), signed_sum(terms)))
        return Block(tuple(displays(equation_lines(rows))), by_entry=True, has_zeros=len(rows) < self.robot.n**2)

    def _skew(self, triples: list[Triple]) -> Block:
        """The entries above the diagonal; the others follow from N = -N^T."""
        nonzero = set(triples)
        rows = []
        for i, j in self._places():
            terms = [term for k in self._joints() for term in self._skew_terms(i, j, k, nonzero)] if i < j else []
            if terms:
                rows.append(Equation(self._entry("N")(i, j), signed_sum(terms)))
        return Block(tuple(displays(equation_lines(rows))), by_entry=True, has_zeros=True)

    def _skew_terms(self, i: int, j: int, k: int, nonzero: set[Triple]) -> Iterator[Signed]:
        for sign, triple in ((1, _sorted(j, i, k)), (-1, _sorted(i, j, k))):
            if triple in nonzero:
                yield sign, (self.symbols.christoffel(*triple), self._rate(k))

    def _torque(self, triples: list[Triple], named: bool, long: bool) -> Block:
        if not named:
            return self._vector("tau")
        if long:
            return Block(())
        lines: list[str] = []
        for i in self._joints():
            head = concatenate(self.symbols.torque(i), EQUALS)
            lines += break_lines(head, self._motion_terms(i, triples))
        return Block(tuple(displays(lines)), by_entry=True)

    def _motion_terms(self, i: int, triples: list[Triple]) -> tuple[Piece, ...]:
        inertia, gravity = self.quantities["B"], self.quantities["g"]
        terms: list[Signed] = []
        for j in self._joints():
            if inertia.terms(min(i, j), max(i, j)):
                terms.append((1, (self._entry("b")(min(i, j), max(i, j)), self._rate(j, 2))))
        for triple in triples:
            if triple[0] == i:
                terms.append((1, self._velocity_product(triple)))
        if gravity.terms(i, 1):
            terms.append((1, (self.symbols.component("g", i),)))
        return signed_sum(terms) + self._friction(i, bool(terms))

    def _velocity_product(self, triple: Triple) -> tuple[Box, ...]:
        symbol, (_, j, k) = self.symbols.christoffel(*triple), triple
        if j == k:
            return (symbol, self._rate(j, square=True))
        return (italic("2"), symbol, self._rate(j), self._rate(k))

    def _friction(self, i: int, follows: bool) -> tuple[Piece, ...]:
        link = self.robot.links[i - 1]
        rate = sympy.Symbol(velocity_name(self.robot.joints[i - 1].variable))
        viscous, coulomb = expression_to_sympy(link.viscous), expression_to_sympy(link.coulomb)
        friction = viscous * rate + coulomb * sympy.sign(rate)
        if friction == 0:
            return ()
        pieces = self.layouter.printer.pieces(friction)
        if not follows:
            return tuple(pieces)
        if pieces[0] == MINUS:
            return (binary("-", 0), *pieces[1:])
        return (binary("+", 0), *pieces)

    # -- joints

    def _joints(self) -> range:
        return range(1, self.robot.n + 1)

    def _places(self) -> Iterator[tuple[int, int]]:
        return ((i, j) for i in self._joints() for j in self._joints())

    def _rate(self, k: int, order: int = 1, square: bool = False) -> Box:
        variable = self.robot.joints[k - 1].variable
        name = velocity_name(variable) if order == 1 else acceleration_name(variable)
        return self.layouter.printer.notation.glyph(name).power(italic("2") if square else EMPTY)


def _key(triple: Triple) -> str:
    return f"christoffel[{triple[0]},{triple[1]},{triple[2]}]"


def _sorted(i: int, j: int, k: int) -> Triple:
    return (i, min(j, k), max(j, k))


def signed_sum(terms: Iterable[Signed]) -> tuple[Piece, ...]:
    """A sum of products of boxes, each with its sign."""
    row: list[Piece] = []
    for sign, factors in terms:
        if row:
            row.append(binary("+" if sign > 0 else "-", 0))
        elif sign < 0:
            row.append(MINUS)
        row += [Piece(factor, Break.FACTOR if k else Break.NEVER) for k, factor in enumerate(factors)]
    return tuple(row) or (Piece(italic("0")),)

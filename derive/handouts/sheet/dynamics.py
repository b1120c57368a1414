"""The dynamics of one robot on its way to the page: multiplied out where short, else in entries of B, c_ijk and g."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property, partial

import sympy

from derive.handouts.layout.lines import Equation, break_lines, equated, equation_lines
from derive.handouts.layout.quantity import Item, LaidOut, Layouter, Namer
from derive.handouts.notation.notation import Glyph
from derive.handouts.notation.pieces import MINUS, Box, Break, TexPiece, binary, bracketed, italic, script, signed_sum
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.notation.symbols import Group, Symbols
from derive.lecture.sympy_conversion import Expr
from derive.model.entries import Entries, ModelEntries
from derive.robot.names import acceleration_name, velocity_name

Signed = tuple[int, tuple[Box, ...]]  # a product of boxes with its sign


@dataclass(frozen=True)
class DynamicsLayout:
    """Lays out the dynamics of one robot."""

    entries: ModelEntries  # its closed forms
    layouter: Layouter  # how a quantity is laid out
    symbols: Symbols  # names of entries

    @property
    def inertia_symbol(self) -> Box:
        """B(q)."""
        return Box(f"\\mathbf{{{self.symbols.inertia_letter}}}(\\mathbf{{q}})", 30.0)

    def inertia_entry(self, row: int, column: int) -> Box:
        """b_ij, always that above the diagonal."""
        return self.symbols.entry(self.symbols.inertia_letter.lower(), min(row, column), max(row, column))

    def is_compact(self, quantity: Entries) -> bool:
        """Whether a closed form is short enough to be printed multiplied out."""
        return quantity.is_short(self.layouter.policy.compact_terms)

    # -- closed forms

    def closed(self, name: str) -> LaidOut:
        """A quantity of the dynamics multiplied out."""
        symbols, entry = self.symbols, self.inertia_entry
        if name in ("kinetic", "potential"):
            letter, group = ("T", Group.KINETIC) if name == "kinetic" else ("U", Group.POTENTIAL)
            box, energy = Box(f"\\mathcal{{{letter}}}", 8.0), getattr(self.entries, name)
            if not energy.terms(1, 1):
                return LaidOut((box.tex + " = 0",), blanks=(box.tex,))
            item = Item(box, energy.terms(1, 1), lambda: energy.entry(1, 1))
            return self.layouter.entries([item], group=group, limit=self.layouter.policy.grouped_terms)
        rate = f"\\dot{{\\mathbf{{{symbols.inertia_letter}}}}}(\\mathbf{{q}}, \\dot{{\\mathbf{{q}}}})"
        rows: dict[str, tuple[Box, Namer, int]] = {
            "B": (self.inertia_symbol, entry, Group.B),
            "Bdot": (Box(rate, 44.0), lambda i, j: Glyph(entry(i, j), accent="\\dot").box, Group.DERIVATIVE),
            "C": (self._rate_symbol("C"), partial(symbols.entry, "C"), Group.C),
            "N": (self._rate_symbol("N"), partial(symbols.entry, "N"), Group.N),
            "g": (Box("\\mathbf{g}(\\mathbf{q})", 36.0), lambda row, _: symbols.component("g", row), Group.TORQUE),
            "tau": (Box("\\boldsymbol{\\tau}", 8.0), lambda row, _: symbols.torque(row), Group.TORQUE),
        }
        symbol, namer, group = rows[name]
        limit, is_symmetric = self.layouter.policy.grouped_terms, name in ("B", "Bdot")
        quantity = getattr(self.entries, name)
        return self.layouter.lay_out(symbol, namer, quantity, group=group, symmetric=is_symmetric, limit=limit)

    def _rate_symbol(self, letter: str) -> Box:
        return Box(f"\\mathbf{{{letter}}}(\\mathbf{{q}}, \\dot{{\\mathbf{{q}}}})", 36.0)

    def body(self, symbol: Box, quantity: Entries, group: int, symmetric: bool = False) -> LaidOut:
        """A quantity of one link or rotor, within a budget that leaves room for those of all the others."""
        held = bracketed(symbol)
        policy = replace(
            self.layouter.policy, flat_terms=40, quantity_entries=4, entry_lines=6, quantity_lines=24, landscape_total=0
        )
        return replace(self.layouter, policy=policy).lay_out(
            symbol, lambda i, j: script(held, italic(f"{i}{j}")), quantity, group=group, symmetric=symmetric
        )

    # -- by Christoffel symbols

    def christoffel(self) -> LaidOut:
        """Each symbol by its expression, or by an earlier symbol that is the same up to the sign."""
        triples = {self.symbols.christoffel(*triple): triple for triple in self.entries.triples}
        aliases = {box: sympy.Symbol(f"_c{index}") for index, box in enumerate(triples)}
        quantities = {box: self.entries.christoffel(*triple) for box, triple in triples.items()}
        known: dict[Expr, Expr] = {}
        pairs = quantities.items()
        items = [Item(box, entry.terms(1, 1), partial(_once, entry, aliases[box], known)) for box, entry in pairs]
        notation = self.layouter.printer.notation.with_terms({alias.name: Glyph(box) for box, alias in aliases.items()})
        layouter = replace(self.layouter, printer=LatexPrinter(notation))
        laid_out = layouter.entries(items, group=Group.CHRISTOFFEL, limit=self.layouter.policy.grouped_terms)
        spelled_out = tuple((box, quantities[box].entry(1, 1)) for box, _ in laid_out.values)
        return replace(laid_out, has_zeros=True, values=spelled_out, blanks=() if laid_out.omitted else ("",))

    def rate_sums(self, name: str) -> LaidOut:
        """C, or the entries of N above the diagonal, as sums of Christoffel symbols times velocities."""
        n, namer = self.entries.robot.dof, partial(self.symbols.entry, name)
        if name == "C":
            sums = {place: self.entries.coriolis_sum(*place) for place in self.entries.C.places}
        else:
            sums = {(i, j): self.entries.skew_sum(i, j) for i, j in self.entries.N.places if i < j}
        sums = {place: terms for place, terms in sums.items() if terms}
        equations, values = [], []
        for place, terms in sums.items():
            products = ((sign, (self.symbols.christoffel(*triple), self._rates[k].box)) for sign, triple, k in terms)
            equations.append(Equation(namer(*place), _signed_sum(products)))
            size = sum(self.entries.christoffel(*term.triple).terms(1, 1) for term in terms)
            if size <= self.layouter.policy.flat_terms:
                values.append((namer(*place), self.entries.rate_value(terms)))
        lines, blanks = tuple(equation_lines(equations)), (self._rate_symbol(name).tex,)
        return LaidOut(lines, has_zeros=len(equations) < n**2, values=tuple(values), blanks=blanks)

    def named_torque(self) -> LaidOut:
        """Each equation of motion by entries of B, Christoffel symbols, g and friction."""
        entries, rates, two, lines = self.entries, self._rates, italic("2"), list[str]()
        joints = range(1, entries.robot.dof + 1)
        names = {i: self.symbols.torque(i) for i in joints}
        glyph = self.layouter.printer.notation.glyph
        for i in joints:
            terms: list[Signed] = [
                (1, (self.inertia_entry(i, j), glyph(acceleration_name(joint.variable)).box))
                for j, joint in enumerate(entries.robot.variables, 1)
                if entries.B.terms(min(i, j), max(i, j))
            ]
            for row, j, k in entries.triples:
                if row == i:
                    symbol = self.symbols.christoffel(i, j, k)
                    square = (symbol, rates[j].power(two))
                    terms.append((1, square if j == k else (two, symbol, rates[j].box, rates[k].box)))
            terms += [(1, (self.symbols.component("g", i),))] if entries.g.terms(i, 1) else []
            value = entries.friction(i)
            friction = self.layouter.printer.pieces(value) if value != 0 else []
            if terms and friction:
                friction = [binary("-", 0), *friction[1:]] if friction[0] == MINUS else [binary("+", 0), *friction]
            pieces = (*(_signed_sum(terms) if terms or not friction else ()), *friction)
            lines += break_lines(equated(names[i]), pieces)
        short = [i for i in joints if entries.tau.terms(i, 1) <= self.layouter.policy.flat_terms]
        values = tuple((names[i], entries.torque_value(i)) for i in short)
        return LaidOut(tuple(lines), values=values, blanks=tuple(name.tex for name in names.values()))

    @cached_property
    def _rates(self) -> dict[int, Glyph]:
        glyph = self.layouter.printer.notation.glyph
        return {k: glyph(velocity_name(joint.variable)) for k, joint in enumerate(self.entries.robot.variables, 1)}


def _once(quantity: Entries, alias: Expr, known: dict[Expr, Expr]) -> Expr:
    """The expression of a scalar, or the alias of an earlier one that is the same up to the sign."""
    if (entry := quantity.entry(1, 1)) in known:
        return known[entry]
    if -entry in known:
        return -known[-entry]
    known[entry] = alias
    return entry


def _signed_sum(terms: Iterable[Signed]) -> tuple[TexPiece, ...]:
    """Pieces of a sum of products, to be broken before a sign or between factors; 0 for an empty sum."""
    products = (
        (sign < 0, [TexPiece(factor, Break.FACTOR if k else Break.NEVER) for k, factor in enumerate(factors)])
        for sign, factors in terms
    )
    return tuple(signed_sum(products)) or (TexPiece(italic("0")),)

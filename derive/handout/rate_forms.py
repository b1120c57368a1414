"""C, N and the equations of motion through named terms: entries of B, Christoffel symbols and g.

C_ij = sum_k c_i,jk qd_k and N_ij = sum_k (c_j,ik - c_i,jk) qd_k, for dB_ij/dq_k = c_i,jk + c_j,ik (Siciliano et al.,
Robotics, eq. 7.44 and 7.47).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy

from derive.handout.dynamics import DERIVATIVE_GROUP, DynamicsLayout, Triple, is_short, key
from derive.handout.layout.lines import EQUALS, Equation, break_lines, equation_lines
from derive.handout.layout.quantity import LaidOut, places
from derive.handout.notation.pieces import EMPTY, Box, Break, Piece, binary, concatenate, italic
from derive.handout.notation.printer import MINUS
from derive.handout.notation.symbols import EntryNamer
from derive.lecture.to_sympy import expression_to_sympy
from derive.robot.names import acceleration_name, velocity_name

Signed = tuple[int, tuple[Box, ...]]
Coefficients = tuple[tuple[int, Triple, int], ...]
"""A sum of sign * c_triple * qd_k."""


@dataclass(frozen=True)
class RateForms:
    """What contains rates, in named terms.

    Attributes:
        layout: The dynamics.
    """

    layout: DynamicsLayout

    @cached_property
    def coriolis_named(self) -> bool:
        """Whether C is given through Christoffel symbols."""
        return not self.layout.is_compact("C")

    @cached_property
    def skew_named(self) -> bool:
        """Whether N is."""
        return self.coriolis_named or not self.layout.is_compact("N")

    @cached_property
    def torque_named(self) -> bool:
        """Whether the equations of motion are given through entries of B, Christoffel symbols and g."""
        return self.coriolis_named or not self.layout.is_compact("tau")

    @property
    def torque_long(self) -> bool:
        """Whether even that is too long, and only the matrix form is given."""
        products = self.layout.layouter.policy.named_products * self.layout.robot.n
        return self.torque_named and 2 * len(self.layout.triples) > products

    # -- C and N

    def coriolis(self) -> LaidOut:
        """C."""
        n = self.layout.robot.n
        sums = {place: tuple(self._coriolis_sum(*place)) for place in places((n, n))}
        return self._block("C", sums)

    def _coriolis_sum(self, i: int, j: int) -> Iterator[tuple[int, Triple, int]]:
        for k in self._joints:
            if _sorted(i, j, k) in self._nonzero:
                yield 1, _sorted(i, j, k), k

    def skew(self) -> LaidOut:
        """The entries of N above the diagonal; the others follow from N = -N^T."""
        n = self.layout.robot.n
        return self._block("N", {(i, j): tuple(self._skew_sum(i, j)) for i, j in places((n, n)) if i < j})

    def _skew_sum(self, i: int, j: int) -> Iterator[tuple[int, Triple, int]]:
        for k in self._joints:
            for sign, triple in ((1, _sorted(j, i, k)), (-1, _sorted(i, j, k))):
                if triple in self._nonzero:
                    yield sign, triple, k

    def _block(self, letter: str, sums: dict[tuple[int, int], Coefficients]) -> LaidOut:
        namer = EntryNamer(self.layout.symbols, letter)
        sums = {place: coefficients for place, coefficients in sums.items() if coefficients}
        rows = [Equation(namer(*place), signed_sum(map(self._signed, found))) for place, found in sums.items()]
        values = ((namer(*place), self._value(found)) for place, found in sums.items())
        return LaidOut(
            tuple(equation_lines(rows)),
            by_entry=True,
            has_zeros=len(rows) < self.layout.robot.n**2,
            values=tuple((name, value) for name, value in values if value is not None),
            blanks=tuple(row.left.tex for row in rows),
        )

    def _signed(self, coefficient: tuple[int, Triple, int]) -> Signed:
        sign, triple, k = coefficient
        return sign, (self.layout.symbols.christoffel(*triple), self._rate(k))

    def _value(self, coefficients: Coefficients) -> Any:
        """The sum with the Christoffel symbols put in, for copying; None where it is long."""
        if sum(self.layout.terms(triple) for _, triple, _ in coefficients) > self.layout.layouter.policy.flat_terms:
            return None
        quantities = self.layout.quantities
        return sympy.Add(
            *(sign * quantities[key(triple)].entry(1, 1) * self._rate_symbol(k) for sign, triple, k in coefficients)
        )

    # -- equations of motion

    def motion(self) -> LaidOut:
        """Each equation: inertia, centrifugal and Coriolis terms, gravity, friction."""
        lines: list[str] = []
        names = [self.layout.symbols.torque(i) for i in self._joints]
        for i, name in zip(self._joints, names, strict=True):
            lines += break_lines(concatenate(name, EQUALS), self._motion_terms(i))
        values = ((name, self._motion_value(i)) for i, name in zip(self._joints, names, strict=True))
        return LaidOut(
            tuple(lines),
            values=tuple((name, value) for name, value in values if value is not None),
            blanks=tuple(name.tex for name in names),
        )

    def _motion_value(self, i: int) -> Any:
        """One equation with everything put in, for copying; None where it is long."""
        layout, quantities = self.layout, self.layout.quantities
        if quantities["tau"].terms(i, 1) > layout.layouter.policy.flat_terms:
            return None
        accelerations = (sympy.Symbol(acceleration_name(joint.variable)) for joint in layout.robot.joints)
        inertial = (quantities["B"].entry(i, j) * growth for j, growth in zip(self._joints, accelerations, strict=True))
        velocity = (
            (1 if j == k else 2)
            * quantities[key((row, j, k))].entry(1, 1)
            * self._rate_symbol(j)
            * self._rate_symbol(k)
            for row, j, k in layout.triples
            if row == i
        )
        return sympy.Add(*inertial, *velocity, quantities["g"].entry(i, 1), self._friction_value(i))

    def _motion_terms(self, i: int) -> tuple[Piece, ...]:
        layout = self.layout
        terms: list[Signed] = []
        for j in self._joints:
            if layout.quantities["B"].terms(min(i, j), max(i, j)):
                terms.append((1, (layout.inertia_entry(i, j), self._rate(j, 2))))
        for triple in layout.triples:
            if triple[0] == i:
                terms.append((1, self._velocity_product(triple)))
        if layout.quantities["g"].terms(i, 1):
            terms.append((1, (layout.symbols.component("g", i),)))
        if not terms:
            return self._friction(i, follows=False) or (Piece(italic("0")),)
        return signed_sum(terms) + self._friction(i, follows=True)

    def _velocity_product(self, triple: Triple) -> tuple[Box, ...]:
        symbol, (_, j, k) = self.layout.symbols.christoffel(*triple), triple
        if j == k:
            return (symbol, self._rate(j, square=True))
        return (italic("2"), symbol, self._rate(j), self._rate(k))

    def _friction(self, i: int, follows: bool) -> tuple[Piece, ...]:
        friction = self._friction_value(i)
        if friction == 0:
            return ()
        pieces = self.layout.layouter.printer.pieces(friction)
        if not follows:
            return tuple(pieces)
        if pieces[0] == MINUS:
            return (binary("-", 0), *pieces[1:])
        return (binary("+", 0), *pieces)

    def _friction_value(self, i: int) -> Any:
        link, rate = self.layout.robot.links[i - 1], self._rate_symbol(i)
        return expression_to_sympy(link.viscous) * rate + expression_to_sympy(link.coulomb) * sympy.sign(rate)

    # -- the check that N is skew-symmetric

    def bdot(self) -> LaidOut | None:
        """The derivative of B with respect to time; None where it is long."""
        if not self.layout.is_compact("Bdot"):
            return None
        letter = self.layout.letter
        symbol = Box(f"\\dot{{\\mathbf{{{letter}}}}}(\\mathbf{{q}}, \\dot{{\\mathbf{{q}}}})", 44.0)

        def entry(row: int, column: int) -> Box:
            box = self.layout.inertia_entry(row, column)
            return Box(f"\\dot{{{box.tex}}}", box.width)

        limit = self.layout.layouter.policy.grouped_terms
        return self.layout.layouter.block(
            symbol, entry, self.layout.quantities["Bdot"], group=DERIVATIVE_GROUP, symmetric=True, limit=limit
        )

    def is_skew(self) -> bool:
        """Whether the entries of dB/dt - 2C and of its transpose, multiplied out, add to zero; False where long."""
        derivative, coriolis = self.layout.quantities["Bdot"], self.layout.quantities["C"]
        limit = self.layout.layouter.policy.compact_terms
        if not (is_short(derivative, limit) and is_short(coriolis, limit)):
            return False
        n = self.layout.robot.n

        def doubled(i: int, j: int) -> Any:
            sums = coriolis.entry(i, j) + coriolis.entry(j, i)
            return sympy.expand(derivative.entry(i, j) + derivative.entry(j, i) - 2 * sums)

        return all(doubled(i, j) == 0 for i, j in places((n, n)) if i <= j)

    # -- joints

    @property
    def _joints(self) -> range:
        return range(1, self.layout.robot.n + 1)

    @cached_property
    def _nonzero(self) -> frozenset[Triple]:
        return frozenset(self.layout.triples)

    def _rate_symbol(self, k: int) -> Any:
        return sympy.Symbol(velocity_name(self.layout.robot.joints[k - 1].variable))

    def _rate(self, k: int, order: int = 1, square: bool = False) -> Box:
        variable = self.layout.robot.joints[k - 1].variable
        name = velocity_name(variable) if order == 1 else acceleration_name(variable)
        return self.layout.layouter.printer.notation.glyph(name).power(italic("2") if square else EMPTY)


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

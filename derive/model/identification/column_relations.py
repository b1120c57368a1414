"""Columns of the regressor in terms of others, solved exactly and proven."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.residues import ResidueDomain, echelon
from derive.algebra.ring import Polynomial
from derive.errors import DeriveError
from derive.mechanics.chain import build_chain
from derive.model.identification.unit_dynamics import UnitDynamics
from derive.robot.inertial_parameters import Parameter

MOVING = frozenset({Kind.SINE, Kind.COSINE, Kind.VARIABLE})
"""Generators that joint variables enter."""

RegressorColumn = Mapping[Hashable, Polynomial]
"""By entry of B or g and monomial in the joint variables, the coefficient: a polynomial in the geometry."""


class Unproven(DeriveError):
    """A relation that holds at the points is no identity: the points were unlucky."""


@dataclass(frozen=True, slots=True)
class Coefficient:
    """An exact quotient of polynomials in the geometry; the denominator is not zero."""

    numerator: Polynomial
    denominator: Polynomial


class ColumnSolver:
    """Solves for columns of B and g in other columns.

    Args:
        domain: The ring; its robot has unit rotors.
        residues: Its image at points, for choosing equations.
    """

    def __init__(self, domain: PolynomialDomain, residues: ResidueDomain) -> None:
        self.domain = domain
        self.residues = residues
        self._units: UnitDynamics[Polynomial] = UnitDynamics(build_chain(domain.robot, domain), ends=False)
        self._moving = [i for i, g in enumerate(domain.generators) if g.kind in MOVING]

    def solve(self, wanted: Parameter, basis: Sequence[Parameter]) -> list[Coefficient]:
        """The coefficients of independent columns in a column that depends on them, by Cramer's rule.

        Args:
            wanted: Whose column depends on the others.
            basis: Whose columns are independent.

        Returns:
            One coefficient for each parameter of the basis, proven as identities of polynomials.

        Raises:
            Unproven: There are none.
            TooManyTerms: A product is beyond the budget of the ring.
        """
        right, columns = self._column(wanted), [self._column(parameter) for parameter in basis]
        keys = sorted({*right, *(key for column in columns for key in column)}, key=repr)
        zero = self.domain.ring.zero
        rows = [[column.get(key, zero) for column in (*columns, right)] for key in keys]
        rows.sort(key=lambda row: sum(map(len, row)))
        chosen = self._independent_rows(rows, len(basis))
        matrix = [row[:-1] for row in chosen]
        scale = _determinant(self.domain.ring.one, matrix)
        tops = [
            _determinant(self.domain.ring.one, [[*row[:k], row[-1], *row[k + 1 : -1]] for row in chosen])
            for k in range(len(basis))
        ]
        for row in rows:
            if scale * row[-1] != self.domain.ring.sum(top * entry for top, entry in zip(tops, row[:-1], strict=True)):
                raise Unproven(f"{wanted.name} depends on other parameters only at some points")
        return [_reduced(top, scale) for top in tops]

    def _column(self, parameter: Parameter) -> RegressorColumn:
        entries: dict[Hashable, Polynomial] = {pair: value for pair, value in self._units.inertia(parameter).items()}
        entries |= dict(enumerate(self._units.gravity(parameter)))
        ring = self.domain.ring
        return {
            (place, monomial): coefficient
            for place, value in entries.items()
            for monomial, coefficient in ring.coefficients(value, self._moving).items()
        }

    def _independent_rows(self, rows: list[list[Polynomial]], rank: int) -> list[list[Polynomial]]:
        """The first rows whose left parts are independent."""
        if not rank:
            return []
        values = [[int(self.residues.value(entry).values.flat[0]) for entry in row[:-1]] for row in rows]
        pivots, _ = echelon(np.array(values, dtype=np.int64).T, self.residues.prime)
        if len(pivots) < rank:
            raise Unproven("columns that are independent at the points are not")
        return [rows[k] for k in pivots]


def _determinant(one: Polynomial, matrix: Sequence[Sequence[Polynomial]]) -> Polynomial:
    """Along the first row; the matrices are small and mostly zero."""
    if not matrix:
        return one
    first, *rest = matrix
    total = one - one
    for k, entry in enumerate(first):
        if entry:
            minor = _determinant(one, [[*row[:k], *row[k + 1 :]] for row in rest])
            total = total + (entry * minor if k % 2 == 0 else -(entry * minor))
    return total


def _reduced(top: Polynomial, bottom: Polynomial) -> Coefficient:
    """top / bottom without common factors, a constant denominator being 1."""
    ring = top.ring
    if not top:
        return Coefficient(ring.zero, ring.one)
    common = top.raw.gcd(bottom.raw)
    numerator, denominator = ring.wrap(divmod(top.raw, common)[0]), ring.wrap(divmod(bottom.raw, common)[0])
    if denominator.is_constant:
        return Coefficient(numerator * (1 / denominator.constant_term), ring.one)
    return Coefficient(numerator, denominator)

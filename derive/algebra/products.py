"""Products of powers as SymPy objects, in SymPy's canonical order without asking it to find that order again."""

from __future__ import annotations

from bisect import insort
from fractions import Fraction
from functools import cmp_to_key
from typing import Any

import sympy
from sympy.core.basic import Basic

from derive.algebra.generators import Kind
from derive.algebra.terms import FactorTable, Monomial
from derive.algebra.to_sympy import factor_to_sympy

Expr = Any

PLAIN = frozenset({Kind.SINE, Kind.COSINE, Kind.VARIABLE, Kind.PARAMETER, Kind.RATE, Kind.ACCELERATION})
"""Factors that SymPy never merges with another or with a number."""

_order = cmp_to_key(Basic.compare)


class ProductBuilder:
    """Turns monomials over a `FactorTable` into SymPy products.

    Args:
        table: What the factor numbers mean.
    """

    def __init__(self, table: FactorTable) -> None:
        self._table = table
        self._powers: dict[tuple[int, int], Expr] = {}
        self._sorted: list[Any] = []
        self._rank: dict[tuple[int, int], int] = {}
        self._cache: dict[tuple[Fraction, Monomial], Expr] = {}

    def term(self, coefficient: Fraction, monomial: Monomial) -> Expr:
        """coefficient * monomial."""
        key = (coefficient, monomial)
        if key not in self._cache:
            self._cache[key] = self._build(coefficient, monomial)
        return self._cache[key]

    def _build(self, coefficient: Fraction, monomial: Monomial) -> Expr:
        number = sympy.Rational(coefficient.numerator, coefficient.denominator)
        powers = [self._power(pair) for pair in monomial]
        if not coefficient or not monomial or any(self._table.factors[f].kind not in PLAIN for f, _ in monomial):
            return sympy.Mul(number, *powers)
        if len(powers) == 1 and coefficient == 1:
            return powers[0]
        ordered = [self._powers[pair] for pair in sorted(monomial, key=self._rank.__getitem__)]
        return sympy.Mul._from_args(ordered if coefficient == 1 else [number, *ordered])

    def _power(self, pair: tuple[int, int]) -> Expr:
        if pair not in self._powers:
            factor, exponent = pair
            value = factor_to_sympy(self._table.domain, self._table.factors[factor]) ** exponent
            self._powers[pair] = value
            insort(self._sorted, (_order(value), pair), key=lambda item: item[0])
            self._rank = {p: i for i, (_, p) in enumerate(self._sorted)}
        return self._powers[pair]

"""Determinants of square blocks of polynomials, exactly."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from derive.algebra.ring import Polynomial


def determinant(rows: Sequence[Sequence[Polynomial]]) -> Polynomial:
    """The determinant by Laplace expansion, every minor computed once.

    With the rows taken from the last one up, a minor is fixed by its columns; a matrix of size n has 2^n of them.
    """
    size = len(rows)
    ring = rows[0][0].ring

    @cache
    def minor(columns: tuple[int, ...]) -> Polynomial:
        if not columns:
            return ring.one
        row = rows[size - len(columns)]
        total = ring.zero
        for place, column in enumerate(columns):
            if row[column]:
                rest = row[column] * minor(columns[:place] + columns[place + 1 :])
                total = total - rest if place % 2 else total + rest
        return total

    return minor(tuple(range(size)))

"""Matrices of formulas."""

from __future__ import annotations

import pytest

from derive.checking.latex.matrices import Entry, Table
from derive.errors import CheckError
from derive.robot.expression import Name, add, multiply, negate

a, b, c, d = map(Name, "abcd")


def table(*rows: tuple[Name, ...]) -> Table:
    return Table(tuple(tuple(Entry(name, name.name, 7) for name in row) for row in rows))


def test_sums_products_and_transposes() -> None:
    square = table((a, b), (c, d))
    assert square.transposed.rows[0][1].formula == c
    assert square.plus(square).rows[0][0].formula == add(a, a)
    assert square.times(table((a,), (b,))).rows[1][0].formula == add(multiply(c, a), multiply(d, b))


def test_only_what_is_printed_as_it_stands_keeps_its_text() -> None:
    square = table((a, b), (c, d))
    assert square.transposed.rows[0][0].text == "a"
    assert square.changed(negate).rows[0][0] == Entry(negate(a), "", 7)


def test_a_determinant_is_expanded() -> None:
    assert table((a, b), (c, d)).determinant.formula == add(multiply(a, d), negate(multiply(b, c)))


def test_shapes_that_do_not_fit_are_refused() -> None:
    row = table((a, b))
    for refused in (lambda: row.plus(row.transposed), lambda: row.times(row), lambda: row.determinant):
        with pytest.raises(CheckError):
            refused()

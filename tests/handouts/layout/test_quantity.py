"""A quantity on the sheet: whole if it fits, else entry by entry, and nothing is lost in named terms."""

from dataclasses import replace
from typing import Any

import sympy
from sympy import Symbol, cos, sin

from derive.handouts.layout.quantity import POLICY, Item, Layouter, omitted
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import Box, italic, script
from derive.handouts.notation.printer import LatexPrinter
from derive.model.entries import Entries, of_matrix
from derive.robot.robot import Robot

A, B, C, D, X = (Symbol(name) for name in ("a1", "b1", "c3", "d1", "x9"))


def given(rows: list[list[Any]]) -> Entries:
    return of_matrix(sympy.ImmutableMatrix(rows))


def layouter(**budgets: int) -> Layouter:
    printer = LatexPrinter(Notation.of(Robot.load("planar-2r-perugia")))
    return Layouter(printer, replace(POLICY, **budgets), lambda group, k: script(italic("u"), italic(str(k))))


def name(row: int, column: int) -> Box:
    return script(italic("t"), italic(f"{row}{column}"))


def test_a_small_matrix_is_printed_whole_with_its_zeros() -> None:
    found = layouter().lay_out(italic("T"), name, given([[cos(A), 0], [0, 1]]))
    assert found.lines == (r"T = \begin{bmatrix} \cos a_{1} & 0 \\ 0 & 1 \end{bmatrix}",)
    assert [box.tex for box, _ in found.values] == ["t_{11}", "t_{22}"]


def test_a_symmetric_matrix_asks_for_its_upper_half_and_prints_all() -> None:
    found = layouter().lay_out(italic("B"), name, given([[A, B], [X, D]]), symmetric=True)
    assert "x_{9}" not in found.lines[0]
    assert found.lines[0].count("b_{1}") == 2


def test_brackets_that_entries_share_get_a_name_which_stands_for_them() -> None:
    shared = sympy.Add(A, B, C, evaluate=False)
    rows = [[sympy.Mul(sin(X), shared, evaluate=False), sympy.Mul(cos(X), shared, evaluate=False)]]
    found = layouter(matrix_terms=0).lay_out(italic("T"), name, given(rows))
    assert found.by_entry
    assert len(found.named) == 1
    assert found.named[0].startswith("u_{1} = ")
    assert " ".join(found.lines).count("u_{1}") == 2
    assert [value for _, value in found.values] == rows[0]


def test_what_is_too_long_is_listed_with_its_number_of_terms() -> None:
    found = layouter(matrix_terms=0, flat_terms=2).lay_out(italic("T"), name, given([[A + B + C, A + B]]))
    assert [box.tex for box, _ in found.values] == ["t_{12}"]
    assert found.omitted == (omitted(Item(name(1, 1), 3, lambda: None), "terms").tex,)
    assert "3" in found.omitted[0]


def test_places_go_row_by_row_from_one() -> None:
    assert given([[A, B], [C, D]]).places == [(1, 1), (1, 2), (2, 1), (2, 2)]

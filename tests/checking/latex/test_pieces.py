"""A matrix is one sign of a piece, and its entries are pieces with their own places."""

from __future__ import annotations

import pytest

from derive.checking.latex.pieces import MATRIX_MARK, LatexPiece, display_piece
from derive.errors import CheckError, Location

START = Location("notes.tex")


def piece(text: str) -> LatexPiece:
    return display_piece(text, 0, len(text), text, START)


def test_a_matrix_is_one_sign_with_entries_of_its_own() -> None:
    whole = piece(r"T = \begin{bmatrix} a & b \\ \frac{c}{d} & e \\ \end{bmatrix}^T")
    assert whole.text.replace(" ", "") == f"T={MATRIX_MARK}^T"
    assert [[cell.text.strip() for cell in row] for row in whole.matrices[0].rows] == [
        ["a", "b"],
        [r"\frac{c}{d}", "e"],
    ]


def test_bars_make_a_determinant() -> None:
    for text in (r"\begin{vmatrix} a \end{vmatrix}", r"\left| \begin{array}{c} a \end{array} \right|"):
        assert piece(text.replace(r"\left", "").replace(r"\right", "")).matrices[0].is_determinant
    assert not piece(r"\begin{bmatrix} a \end{bmatrix}").matrices[0].is_determinant


def test_a_part_keeps_its_own_matrices_and_every_entry_its_place() -> None:
    text = r"\begin{matrix} a \end{matrix} + \begin{matrix} b \\ c \end{matrix}"
    whole = piece(text)
    second = whole.part(whole.text.index("+"), len(whole.text))
    entries = [row[0] for row in second.matrices[0].rows]
    assert [text[entry.start : entry.end] for entry in entries] == ["b", "c"]
    assert [t.strip() for t in second.texts] == [second.text.strip(), "b", "c"]


def test_nested_environments_have_a_limit() -> None:
    with pytest.raises(CheckError, match="nested too deeply"):
        piece(r"\begin{split}" * 12 + "a" + r"\end{split}" * 12)

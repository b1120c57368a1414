"""What the rules of the grammar make of formulas, before anything is said about places in a file."""

from __future__ import annotations

import pytest
from lark.exceptions import UnexpectedInput

from derive.checking.latex.grammar import MisplacedError, parsed
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.names import LatexNames
from derive.checking.latex.pieces import MATRIX_MARK
from derive.lecture.shorthand import read_formula
from derive.robot.expression import Expression, Name
from derive.robot.robot import Robot

SCARA = Robot.load("scara-perugia-zup")
COLUMN = Table(((Entry(Name("a1")),), (Entry(Name("a2")),)))


def made(text: str) -> Expression | Table:
    tables = {i: COLUMN for i, sign in enumerate(text) if sign == MATRIX_MARK}
    return parsed(text, LatexNames(SCARA), tables)


@pytest.mark.parametrize(
    ("latex", "plain"),
    [(r"c_1^2 a_2", "c1**2*a2"), (r"\frac{a_1}{2}", "a1/2"), (r"c(\theta_1)^2", "c1**2"), (r"\dot\theta_1", "qd1")],
)
def test_a_formula_is_a_tree_in_the_order_of_print(latex: str, plain: str) -> None:
    assert made(latex) == read_formula(plain, SCARA)


def test_a_matrix_is_scaled_added_and_transposed() -> None:
    table = made(f"2{MATRIX_MARK} + {MATRIX_MARK}")
    assert isinstance(table, Table)
    assert [row[0].formula for row in table.rows] == [read_formula(f"2*{a} + {a}", SCARA) for a in ("a1", "a2")]
    assert made(f"{MATRIX_MARK}^T") == COLUMN.transposed


@pytest.mark.parametrize(("text", "offset"), [("a_1 + bogus_1", 6), ("2 3", 2), (r"a_1 \cos^{-1}\theta_1", 4)])
def test_what_is_misplaced_says_where(text: str, offset: int) -> None:
    with pytest.raises(MisplacedError) as caught:
        made(text)
    assert caught.value.offset == offset


def test_what_is_outside_the_grammar_is_larks_to_refuse() -> None:
    with pytest.raises(UnexpectedInput):
        made("a_1 +")

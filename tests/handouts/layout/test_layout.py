"""Quantities and formulas over several lines: nothing is lost, nothing is too wide, nothing else is changed."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st
from sympy import Symbol, cos, sin

from derive.handouts.assemble import context_of
from derive.handouts.layout.flow import breakable, matrix_equation, whole_equations
from derive.handouts.layout.lines import (
    EQUALS,
    INDENTS,
    Equation,
    break_lines,
    equation_lines,
    matrix,
    matrix_rows,
    pack,
)
from derive.handouts.layout.quantity import POLICY, Item, LaidOut, Layouter, omitted
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import Box, Break, TexPiece, concatenate, italic, joined, script
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.sheet.context import Context, component_namer, entry_namer, formula, side_by_side, textbook
from derive.handouts.sheet.document import Paragraph, Rows, Section, Steps, blocks_of, spans
from derive.handouts.sheet.latex_writer import latex_template
from derive.model.entries import Entries, of_matrix
from derive.robot.robot import Robot
from derive.targets.templating import template_folder
from tests.random_robots import swept_catalogue

HEAD = Box("b = ", 30.0)
ROBOTS = swept_catalogue(8, usual=("scara-perugia", "stanford-deluca"))  # the entries of others are too many to write


@st.composite
def rows(draw: st.DrawFn) -> list[TexPiece]:
    count = draw(st.integers(1, 60))
    widths = draw(st.lists(st.floats(1.0, 150.0), min_size=count, max_size=count))
    kinds = draw(st.lists(st.sampled_from(list(Break)), min_size=count, max_size=count))
    depths = draw(st.lists(st.integers(0, 4), min_size=count, max_size=count))
    breaks = [Break.NEVER if not k or k % 3 == 1 else kind for k, kind in enumerate(kinds)]
    return [TexPiece(Box(f"<{k}>", widths[k]), breaks[k], depths[k]) for k in range(count)]


@given(rows())
def test_every_piece_appears_once_and_in_order(pieces: list[TexPiece]) -> None:
    text = "".join(break_lines(HEAD, pieces, 455.0))
    places = [text.index(piece.box.tex) for piece in pieces]
    assert places == sorted(places)
    assert all(text.count(piece.box.tex) == 1 for piece in pieces)


@given(st.lists(st.floats(1.0, 300.0), min_size=1, max_size=60), st.integers(0, 3))
def test_lines_fit_where_every_piece_may_start_one(widths: list[float], depth: int) -> None:
    pieces = [TexPiece(Box(f"<{k}>", width), Break.BINARY, depth) for k, width in enumerate(widths)]
    for number, line in enumerate(break_lines(HEAD, pieces, 455.0)):
        used = sum(piece.box.width for piece in pieces if piece.box.tex in line)
        indentation = 30.0 if number == 0 else (10.0, 20.0, 30.0, 30.0)[depth]
        assert used + indentation <= 455.0 + 1e-6


def test_lines_break_outside_of_brackets_if_they_can() -> None:
    """The sum outside is broken though the bracket would fill the line further."""
    terms = [TexPiece(Box("x", 110.0), Break.BINARY if k else Break.NEVER) for k in range(3)]
    bracket = [TexPiece(Box("(", 5.0), Break.BINARY), *(TexPiece(Box("y", 40.0), Break.BINARY, 1) for _ in range(6))]
    lines = break_lines(HEAD, [*terms, *bracket], 455.0)
    assert [line.count("x") for line in lines] == [3, 0]
    assert "(" in lines[1]


def test_short_equations_share_a_line_and_boxes_are_packed_within_the_width() -> None:
    equations = [Equation(italic(letter), (TexPiece(italic("x")),)) for letter in "abcdefgh"]
    (line,) = equation_lines(equations)
    assert re.findall(r"(\w) =", line) == list("abcdefgh")
    assert pack([Box("a", 200.0), Box("b", 200.0), Box("c", 200.0)], 455.0) == ["a \\qquad b", "c"]
    assert pack([], 455.0) == []


def test_columns_make_the_width_of_a_matrix_and_rows_of_fractions_keep_off_each_other() -> None:
    cell = Box("x", 20.0)
    assert matrix([[cell, cell], [cell, Box("y", 50.0)]]).width >= 20.0 + 50.0 + 10.0
    rows = matrix_rows([["\\tfrac{1}{2}", "0"], ["x", "\\tfrac{1}{3}"], ["0", "1"]])
    assert rows == ["\\tfrac{1}{2} & 0 \\\\[0.6ex]", "x & \\tfrac{1}{3} \\\\", "0 & 1"]
    assert matrix_rows([["x"]]) == ["x"]


A, B, C, D, X = (Symbol(place_name) for place_name in ("a1", "b1", "c3", "d1", "x9"))


def entries_of(rows: list[list[Any]]) -> Entries:
    return of_matrix(sympy.ImmutableMatrix(rows))


def layouter(**budgets: int) -> Layouter:
    printer = LatexPrinter(Notation.of(Robot.load("planar-2r-perugia")))
    return Layouter(printer, replace(POLICY, **budgets), lambda group, k: script(italic("u"), italic(str(k))))


def place_name(row: int, column: int) -> Box:
    return script(italic("t"), italic(f"{row}{column}"))


def test_a_small_matrix_is_printed_whole_and_a_symmetric_one_asks_for_its_upper_half() -> None:
    found = layouter().lay_out(italic("T"), place_name, entries_of([[cos(A), 0], [0, 1]]))
    assert found.lines == (r"T = \begin{bmatrix} \cos a_{1} & 0 \\ 0 & 1 \end{bmatrix}",)
    assert [box.tex for box, _ in found.values] == ["t_{11}", "t_{22}"]
    found = layouter().lay_out(italic("B"), place_name, entries_of([[A, B], [X, D]]), symmetric=True)
    assert "x_{9}" not in found.lines[0]
    assert found.lines[0].count("b_{1}") == 2


def test_brackets_that_entries_share_get_a_name_which_stands_for_them() -> None:
    shared = sympy.Add(A, B, C, evaluate=False)
    rows = [[sympy.Mul(sin(X), shared, evaluate=False), sympy.Mul(cos(X), shared, evaluate=False)]]
    found = layouter(matrix_terms=0).lay_out(italic("T"), place_name, entries_of(rows))
    assert "bmatrix" not in "".join(found.lines)
    assert len(found.named) == 1
    assert found.named[0].startswith("u_{1} = ")
    assert " ".join(found.lines).count("u_{1}") == 2
    assert [value for _, value in found.values] == rows[0]


def test_what_is_too_long_is_listed_with_its_number_of_terms() -> None:
    found = layouter(matrix_terms=0, flat_terms=2).lay_out(italic("T"), place_name, entries_of([[A + B + C, A + B]]))
    assert [box.tex for box, _ in found.values] == ["t_{12}"]
    assert found.omitted == (omitted(Item(place_name(1, 1), 3, lambda: None), "terms").tex,)
    assert "3" in found.omitted[0]


MARK = re.compile(r"\\(?:brk|fac)[0-9] ")


def equations_of(name: str) -> list[Equation]:
    context = context_of(Robot.load(name))
    entries = [value for matrix in (context.entries.model.J, context.entries.model.J_dot) for value in matrix if value]
    names = (context.symbols.entry("J", 1, k) for k in range(1, len(entries) + 1))
    return [Equation(left, tuple(context.printer.pieces(right))) for left, right in zip(names, entries, strict=True)]


@pytest.mark.parametrize("name", ROBOTS)
def test_broken_lines_become_whole_again_and_marks_are_all_that_is_added(name: str) -> None:
    equations = equations_of(name)
    whole = [concatenate(equation.left, EQUALS, joined(equation.right)).tex for equation in equations]
    for width in (200.0, 455.0, 1e9):
        found = whole_equations(equation_lines(equations, width))
        assert [re.sub(r"\s+", "", line) for line in found] == [re.sub(r"\s+", "", line) for line in whole]
        assert [MARK.sub("", breakable(line)) for line in found] == found


@pytest.mark.parametrize(
    ("equation", "marked"),
    [
        ("x = -a + b", "x = -a \\brk0 + b"),
        ("x = a(b + c[d - e])", "x = a(b \\brk1 + c[d \\brk2 - e])"),
        ("\\mathbf{p} = \\frac{a + b}{2}q^{n + 1}", "\\mathbf{p} = \\frac{a + b}{2}q^{n + 1}"),
        ("x = \\operatorname{atan2}(a,\\, -b)", "x = \\operatorname{atan2}(a,\\, \\brk1 -b)"),
        ("x = a_{1}b_{2}c_{3}d_{4}e_{5}f_{6}g_{7}", "x = a_{1}b_{2}c_{3}d_{4}e_{5}f_{6}\\fac0 g_{7}"),
        ("x = \\tfrac{1}{2} \\left( a + b \\right)", "x = \\tfrac{1}{2} \\bigl( a \\brk1 + b \\bigr)"),
        ("x = 0{,}5a - 2\\cos q", "x = 0{,}5a \\brk0 - 2\\cos q"),
    ],
)
def test_a_line_may_end_before_a_sign_outside_of_braces(equation: str, marked: str) -> None:
    assert breakable(equation) == marked


def test_a_line_that_was_broken_behind_a_name_may_end_there_again() -> None:
    (whole,) = whole_equations(["x = a\\sin \\phi ", f"{INDENTS[0].tex}{{}}- b\\cos \\phi "])
    assert breakable(whole).count("\\brk") == 1


def test_a_matrix_is_also_its_entries() -> None:
    matrix = matrix_equation("\\phantom{A} = \\begin{bmatrix} a & b \\\\ b & 0 \\end{bmatrix}")
    assert matrix.entries() == ["(A)_{11} = a", "(A)_{12} = b"]
    column = matrix_equation("p = AB = \\begin{bmatrix} x \\\\ 0 \\\\ y \\end{bmatrix}")
    assert column.entries() == ["(p)_{1} = x", "(p)_{3} = y"]
    spaced = matrix_equation("p = \\begin{bmatrix} \\tfrac{1}{2} \\\\[0.6ex] \\tfrac{1}{3} \\end{bmatrix}")
    assert spaced.entries() == ["(p)_{1} = \\tfrac{1}{2}", "(p)_{2} = \\tfrac{1}{3}"]
    assert matrix_equation("x = a + b") is None


P, R = Box("P", 10.0), Box("R", 10.0)
q1 = sympy.Symbol("q1")


@pytest.fixture(scope="module")
def context() -> Context:
    return context_of(Robot.load("planar-3r"))


def test_small_matrices_share_a_line_and_a_wide_one_is_not_small(context: Context) -> None:
    matrix = of_matrix(sympy.Matrix([[sympy.cos(q1), 0], [0, 1]]))
    found = [context.layouter.small(symbol, entry_namer(symbol), matrix) for symbol in (P, R)]
    together = side_by_side([one for one in found if one is not None])
    body = "\\begin{bmatrix} c_{1} & 0 \\\\ 0 & 1 \\end{bmatrix}"
    assert together.lines == (f"P = {body} \\qquad R = {body}",)
    assert together.blanks == ("P", "R")
    assert [name.tex for name, _ in together.values] == ["(P)_{11}", "(P)_{22}", "(R)_{11}", "(R)_{22}"]
    wide = sympy.Matrix([[sympy.Symbol("a1") ** k * sympy.Symbol("a2") ** k for k in range(2, 22)]])
    assert context.layouter.small(P, entry_namer(P), of_matrix(wide)) is None


def test_components_of_a_vector_have_one_index() -> None:
    assert component_namer(P)(2, 1).tex == "(P)_{2}"
    assert entry_namer(P, ",")(2, 10).tex == "(P)_{2,10}"


def test_what_is_left_out_is_said_and_entries_are_copied_as_latex_and_python(context: Context) -> None:
    plain = LaidOut(("P = 0",))
    assert formula(context, plain).note == ""
    sparse = LaidOut(("P = 0",), has_zeros=True)
    assert formula(context, sparse).note == "Entries that are not listed are zero."
    symmetric = LaidOut(("P = 0",), has_zeros=True, symmetric=True)
    assert formula(context, symmetric).note.startswith("The matrix is symmetric; ")
    laid_out = LaidOut(("P = c_{1}",), values=((P, sympy.cos(q1)),))
    (entry,) = formula(context, laid_out).entries()
    assert (entry.name, entry.latex, entry.python) == ("P", "c_{1}", "cos(q1)")


FOLDER = Path(str(template_folder())) / "handout"
MACROS = latex_template("textbook.tex.jinja").module
NAMES = [name for name in dir(MACROS) if not name.startswith("_")]
FLAGS = ("rotors", "armatures", "friction", "revolute", "prismatic")


@pytest.mark.parametrize("flag", [True, False])
@pytest.mark.parametrize("name", NAMES)
def test_every_formula_is_balanced(name: str, flag: bool) -> None:
    names = getattr(MACROS, name).arguments
    given = {argument: ("word" if flag else "") if argument in FLAGS else "X" for argument in names}
    lines = textbook(name, **given).lines
    assert lines or (name == "link_jacobians" and not flag)
    for line in lines:
        plain = re.sub(r"\\[{}]", "", line)
        assert plain.count("{") == plain.count("}")
        assert line.count("\\left") == line.count("\\right")
        assert line == line.strip()
        assert not re.search(r"<<|>>|<%|%>|<#|#>|\n", line)


def test_an_indented_line_continues_the_one_before() -> None:
    assert textbook("rotor_jacobians").lines == (
        "\\mathbf{J}_{v,i}^{m_i} = \\mathbf{0}, \\qquad \\mathbf{J}_{\\omega,i}^{m_i} = k_{r_i}\\,\\mathbf{z}_{m_i}",
    )


ROWS = Rows(("a = b",))
SECTION = Section("table", "Table", (Paragraph("one"), Steps("two", (ROWS, Paragraph("three"))), Paragraph("four")))


def test_a_text_has_words_mathematics_and_code_and_blocks_of_steps_are_of_the_section() -> None:
    found = list(spans("The matrix $\\mathbf{R}$ of `inertia_matrix`."))
    assert [mark for mark, _ in found] == ["", "$", "", "`", ""]
    assert [text for _, text in found] == ["The matrix ", "\\mathbf{R}", " of ", "inertia_matrix", "."]
    assert list(spans("")) == []
    texts = [block.text for block in blocks_of(SECTION) if isinstance(block, Paragraph)]
    assert texts == ["one", "three", "four"]

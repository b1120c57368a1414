"""Formulas: notes, small matrices side by side, entries to copy, and those of textbooks, line by line balanced."""

import re
from pathlib import Path

import pytest
import sympy

from derive.handouts.assemble import context_of
from derive.handouts.layout.quantity import LaidOut
from derive.handouts.notation.pieces import Box
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import (
    Paragraph,
    Rows,
    Section,
    Steps,
    blocks_of,
    spans,
)
from derive.handouts.sheet.formula import component_namer, entry_namer, formula, side_by_side, small, textbook
from derive.handouts.sheet.latex_writer import macros
from derive.model.entries import of_matrix
from derive.robot.robot import Robot
from derive.targets.templating import template_folder

A, B = Box("A", 10.0), Box("B", 10.0)
q1 = sympy.Symbol("q1")


@pytest.fixture(scope="module")
def context() -> Context:
    return context_of(Robot.load("planar-3r"))


def test_small_matrices_share_a_line(context: Context) -> None:
    matrix = of_matrix(sympy.Matrix([[sympy.cos(q1), 0], [0, 1]]))
    found = [small(context, symbol, matrix, entry_namer(symbol)) for symbol in (A, B)]
    together = side_by_side([one for one in found if one is not None])
    body = "\\begin{bmatrix} c_{1} & 0 \\\\ 0 & 1 \\end{bmatrix}"
    assert together.lines == (f"A = {body} \\qquad B = {body}",)
    assert together.blanks == ("A", "B")
    assert [name.tex for name, _ in together.values] == ["(A)_{11}", "(A)_{22}", "(B)_{11}", "(B)_{22}"]


def test_a_wide_matrix_is_not_small(context: Context) -> None:
    wide = sympy.Matrix([[sympy.Symbol("a1") ** k * sympy.Symbol("a2") ** k for k in range(2, 22)]])
    assert small(context, A, of_matrix(wide), entry_namer(A)) is None


def test_components_of_a_vector_have_one_index() -> None:
    assert component_namer(A)(2, 1).tex == "(A)_{2}"
    assert entry_namer(A, ",")(2, 10).tex == "(A)_{2,10}"


def test_what_is_left_out_is_said(context: Context) -> None:
    plain = LaidOut(("A = 0",), by_entry=True)
    assert formula(context, plain).note == ""
    sparse = LaidOut(("A = 0",), by_entry=True, has_zeros=True)
    assert formula(context, sparse).note == "Entries that are not listed are zero."
    symmetric = LaidOut(("A = 0",), by_entry=True, has_zeros=True, symmetric=True)
    assert formula(context, symmetric).note.startswith("The matrix is symmetric; ")


def test_entries_are_copied_as_latex_and_python(context: Context) -> None:
    laid_out = LaidOut(("A = c_{1}",), values=((A, sympy.cos(q1)),))
    (entry,) = formula(context, laid_out).entries
    assert (entry.name, entry.latex, entry.python) == ("A", "c_{1}", "cos(q1)")


FOLDER = Path(str(template_folder())) / "handout"
TEMPLATE = "textbook.tex.jinja"
NAMES = [name for name in dir(macros(TEMPLATE)) if not name.startswith("_")]
FLAGS = ("rotors", "armatures", "friction", "revolute", "prismatic")


@pytest.mark.parametrize("flag", [True, False])
@pytest.mark.parametrize("name", NAMES)
def test_every_formula_is_balanced(name: str, flag: bool) -> None:
    names = getattr(macros(TEMPLATE), name).arguments
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


def test_a_text_has_words_mathematics_and_code() -> None:
    found = list(spans("The matrix $\\mathbf{B}$ of `inertia_matrix`."))
    assert [kind.value for kind, _ in found] == ["words", "mathematics", "words", "code", "words"]
    assert [text for _, text in found] == ["The matrix ", "\\mathbf{B}", " of ", "inertia_matrix", "."]
    assert list(spans("")) == []


def test_blocks_inside_of_steps_are_blocks_of_the_section() -> None:
    texts = [block.text for block in blocks_of(SECTION) if isinstance(block, Paragraph)]
    assert texts == ["one", "three", "four"]

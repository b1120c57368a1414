"""Equations that TeX breaks itself: whole again, marked where a line may end, nothing else changed."""

import re

import pytest

from derive.handouts.assemble import context_of
from derive.handouts.layout.flow import breakable, matrix_equation, whole_equations
from derive.handouts.layout.lines import EQUALS, INDENTS, Equation, equation_lines
from derive.handouts.notation.pieces import concatenate, joined
from derive.robot.robot import Robot
from tests.random_robots import swept_catalogue

MARK = re.compile(r"\\(?:brk|fac)[0-9] ")


def equations_of(name: str) -> list[Equation]:
    context = context_of(Robot.load(name))
    entries = [value for matrix in (context.entries.model.J, context.entries.model.J_dot) for value in matrix if value]
    names = (context.symbols.entry("J", 1, k) for k in range(1, len(entries) + 1))
    return [Equation(left, tuple(context.printer.pieces(right))) for left, right in zip(names, entries, strict=True)]


@pytest.mark.parametrize("name", ["scara-perugia", "stanford-deluca"])
def test_broken_lines_become_whole_again(name: str) -> None:
    equations = equations_of(name)
    whole = [concatenate(equation.left, EQUALS, joined(equation.right)).tex for equation in equations]
    for width in (200.0, 455.0, 1e9):
        found = whole_equations(equation_lines(equations, width))
        assert [re.sub(r"\s+", "", line) for line in found] == [re.sub(r"\s+", "", line) for line in whole]


@pytest.mark.parametrize("name", ["scara-perugia", "stanford-deluca"])
def test_marks_are_all_that_is_added(name: str) -> None:
    for line in whole_equations(equation_lines(equations_of(name))):
        assert MARK.sub("", breakable(line)) == line


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
    assert matrix is not None
    assert matrix.entries() == ["(A)_{11} = a", "(A)_{12} = b"]
    column = matrix_equation("p = AB = \\begin{bmatrix} x \\\\ 0 \\\\ y \\end{bmatrix}")
    assert column is not None
    assert column.entries() == ["(p)_{1} = x", "(p)_{3} = y"]
    spaced = matrix_equation("p = \\begin{bmatrix} \\tfrac{1}{2} \\\\[0.6ex] \\tfrac{1}{3} \\end{bmatrix}")
    assert spaced is not None
    assert spaced.entries() == ["(p)_{1} = \\tfrac{1}{2}", "(p)_{2} = \\tfrac{1}{3}"]
    assert matrix_equation("x = a + b") is None


@pytest.mark.parametrize("name", swept_catalogue())
def test_lines_of_every_robot_become_whole_again(name: str) -> None:
    robot = Robot.load(name)
    if robot.n > 8:
        pytest.skip("its entries are too many to write")
    test_broken_lines_become_whole_again(name)
    test_marks_are_all_that_is_added(name)

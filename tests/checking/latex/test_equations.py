"""How LaTeX is taken apart: displays, equations, sides."""

from __future__ import annotations

import pytest

from derive.checking.latex.equations import equations
from derive.errors import CheckError, Location

START = Location("notes.tex")


def sides(text: str, document: bool = False) -> list[list[str]]:
    return [[" ".join(side.text.split()) for side in e] for e in equations(text, START, document=document)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a + b", [["a + b"]]),
        ("x = a = b", [["x", "a", "b"]]),
        (r"x = a, \quad y = b.", [["x", "a"], ["y", "b"]]),
        (r"x = a \\ y = b", [["x", "a"], ["y", "b"]]),
        (r"x = a \\ + b", [["x", "a + b"]]),
        (r"x = (a \\ b)", [["x", "(a b)"]]),
        (r"f(q, p) = a", [["f(q, p)", "a"]]),
        (r"\begin{align} x &= a & y &= b \end{align}", [["x", "a"], ["y", "b"]]),
        (r"\begin{align} x &= a \\ &= b \end{align}", [["x", "a", "b"]]),
        (r"\begin{gather} x = a \\ y = b \end{gather}", [["x", "a"], ["y", "b"]]),
        (r"\[ x := a \]", [["x", "a"]]),
        (r"x = a \text{ where } y = b", [["x", "a"], ["y", "b"]]),
        (r"Now $x = a$ and $y = b$.", [["x", "a"], ["y", "b"]]),
    ],
)
def test_equations_and_their_sides(text: str, expected: list[list[str]]) -> None:
    assert sides(text) == expected


def test_prose_of_a_document_is_passed_over() -> None:
    text = "\\begin{document} Let \\[ x = a \\] \\begin{itemize} \\item $n = 2$ \\end{itemize} \\end{document}"
    assert sides(text, document=True) == [["x", "a"]]


@pytest.mark.parametrize(
    ("text", "column"), [(r"a \begin{foo} b \end{foo}", 3), (r"\begin{bmatrix} a", 1), (r"a \end{bmatrix}", 3)]
)
def test_environments_that_are_no_displays_are_refused(text: str, column: int) -> None:
    with pytest.raises(CheckError) as caught:
        list(equations(text, START))
    assert caught.value.location == Location("notes.tex", 1, column)

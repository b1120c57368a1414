"""Documents become text in which mathematics stands as LaTeX writes it, and their verdicts one web page.

Every character keeps its place in the file. The page has slips beside what is right, nothing from a network, and no
text of the document that runs.
"""

import json
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive.api.check import formula_printout
from derive.checking.documents import MAX_DEPTH, Manuscript, document_of, expanded, read_document
from derive.checking.page import verdict_page
from derive.checking.spelling import from_plain_text, spelled
from derive.cli.main import main
from derive.errors import CheckError
from tests.checking.test_pages import ANT


def words(document: Manuscript) -> str:
    return " ".join(document.text.split())


@pytest.mark.parametrize(
    ("suffix", "typed", "kept"),
    [
        (".md", "a `$x$` b $y$", "a b $y$"),
        (".md", "```python\nx = '$1'\n```\n$$y$$", "$$y$$"),
        (".md", "```math\ny = 1\n```\n", "$$ y = 1 $$"),
        (".md", "so $`y = 1`$ <!-- $z$ --> and <br> on", "so $ y = 1 $ and on"),
        (".md", "it costs 5 $\n\n$$\ny\n\n$$", "it costs 5 $$ y $$"),
        (".md", "About $\\hat X_2\n\nlater $y$", "About \\hat X_2 later $y$"),
        (
            ".md",
            "$$ a = b\n\nThen some words follow here. $$ c = d $$",
            "a = b Then some words follow here. $$ c = d $$",
        ),
        (".tex", "$a$ % $ is a comment\n50\\% $b$", "$a$ 50\\% $b$"),
        ("", "# T\n\n$$x$$", "# T $$x$$"),
    ],
)
def test_only_mathematics_and_prose_are_left(suffix: str, typed: str, kept: str) -> None:
    assert words(document_of(typed, "notes", suffix)) == kept


@pytest.mark.parametrize(
    ("typed", "written"),
    [
        (r"\newcommand{\ct}[1]{\cos\theta_{#1}} $\ct{1}\ct2$", r"$\cos\theta_{1}\cos\theta_{2}$"),
        (r"\newcommand\mat[2][T]{\mathbf{#1}_{#2}} $\mat{1} \mat[R]{2}$", r"$\mathbf{T}_{1} \mathbf{R}_{2}$"),
        (r"\def\half#1{\frac{#1}{2}} $\half{a}$", r"$\frac{a}{2}$"),
        (r"\DeclareMathOperator{\at}{atan2} $\at(y, x)$", r"$\operatorname{atan2}(y, x)$"),
        (r"\newcommand{\q}{\theta} \newcommand{\cq}[1]{\cos\q_{#1}} $\cq{1}$", r"$\cos\theta_{1}$"),
        (r"\newcommand{\bt}{\theta} $\bt x$", r"$\theta x$"),
        (r"\newcommand{\two}[2]{#1 #2} $\two{1}$", r"$\two{1}$"),
    ],
)
def test_macros_of_the_author_are_written_out(typed: str, written: str) -> None:
    assert words(document_of(typed, "a.tex", ".tex")) == written


def test_macros_that_call_themselves_end() -> None:
    text, origins = expanded(r"\def\a{\b\b}\def\b{\a\a} $\a$")
    assert len(text) == len(origins)
    assert len(text) < 3_000_000
    text, _ = expanded(r"\def\a{x\a} $\a$")
    assert text.count("x") == MAX_DEPTH


def test_a_character_of_a_macro_stands_where_the_macro_is_called() -> None:
    document = document_of("\\newcommand{\\ct}[1]{\\cos\\theta_{#1}}\nx = \\ct{12} + b", "a.tex", ".tex")
    place = document.location(document.text.index("\\cos"))
    assert (place.line, place.column) == (2, 5)
    place = document.location(document.text.index("12"))
    assert (place.line, place.column) == (2, 9)


@given(text=st.text(alphabet="a$\\{}#1\n `%", max_size=60))
def test_any_text_keeps_its_lines_and_places(text: str) -> None:
    for suffix in (".tex", ".md"):
        document = document_of(text, "a", suffix)
        assert len(document.text) == len(document.origins)
        assert all(
            document.typed[origin] == "\n"
            for c, origin in zip(document.text, document.origins, strict=False)
            if c == "\n"
        )


def test_a_notebook_is_read_cell_by_cell() -> None:
    cells = [
        {"cell_type": "markdown", "source": ["# T\n", "\n", "$x = 1$"]},
        {"cell_type": "code", "source": ["y = '$z$'"]},
        {"cell_type": "markdown", "source": "and\n$$y$$"},
    ]
    document = document_of(json.dumps({"cells": cells}), "a.ipynb", ".ipynb")
    assert words(document) == "# T $x = 1$ and $$y$$"
    assert str(document.location(document.text.index("x"))) == "a.ipynb, cell 1:3:2"
    assert str(document.location(document.text.index("y"))) == "a.ipynb, cell 3:2:3"
    with pytest.raises(CheckError, match="is not a notebook"):
        document_of("{", "a.ipynb", ".ipynb")


PAGE = "# Arm\n$a$\n## Table\n$b$\n## Motion of it\n$c$\n# End\n$d$\n"


def test_a_part_is_named_by_lines_or_by_its_heading() -> None:
    document = document_of(PAGE, "a.md", ".md")
    assert words(document.within(lines=(4, 6))) == "$b$ ## Motion of it $c$"
    assert words(document.within(section="arm")) == "# Arm $a$ ## Table $b$ ## Motion of it $c$"
    assert words(document.within(section="motion of")) == "## Motion of it $c$"
    tex = document_of("\\section{A $x$}a\\subsection*{B}b\\section{C}c", "a.tex", ".tex")
    assert words(tex.within(section="b")) == "\\subsection*{B}b"
    with pytest.raises(CheckError, match="no section 'Joints'; allowed: 'Arm', 'Table'"):
        document.within(section="Joints")


@pytest.mark.parametrize(
    ("data", "message"),
    [(b"%PDF-1.5", "is a PDF; derive check reads .tex, .md"), (b"PK\x03\x04", "Office"), (b"\xff\xfe", "not UTF-8")],
)
def test_what_is_no_text_is_refused(data: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "notes.md"
    path.write_bytes(data)
    with pytest.raises(CheckError, match=message):
        read_document(str(path))
    with pytest.raises(CheckError, match="cannot be read"):
        read_document(str(tmp_path / "none.md"))


NOTES = r"""
$$p_z = d_1 + a_2 s_2 - a_3 s_{23}$$
$$p_x = c_1 (a_2 c_2 + a_3 c_{23})$$
$$p_y = 0.3$$
$${}^0R_3 = \begin{bmatrix} c_1 c_{23} & s_1 c_{23} & s_{23} \\
-c_1 s_{23} & -s_1 s_{23} & c_{23} \\ s_1 & -c_1 & 0 \end{bmatrix}$$
"""


def page_of(text: str, name: str = "notes.md") -> str:
    return verdict_page([formula_printout(ANT, "", document_of(text, name, ".md"), latex=True)], [ANT])


def test_a_page_tells_slips_what_is_right_and_what_was_not_compared() -> None:
    page = page_of(NOTES)
    for words in (
        "Slips",
        "Not compared",
        "Right",
        "the matrix is transposed",
        "is a numeric example",
        "sign of the 3rd",
    ):
        assert words in page
    assert "a_{3}s_{23}" in re.sub(r"\s", "", page)


def test_a_page_needs_no_network_and_runs_nothing_of_the_document() -> None:
    page = page_of(r"$$p_z = d_1 + a_2 s_2 \text{</script><img src=x onerror=alert(1)>}$$" + NOTES, "<b>.md")
    assert not re.findall(r"(?:src|href)\s*=\s*[\"']?(?:https?:)?//", page)
    assert "<img src=x" not in page
    assert "<b>.md" not in page


def test_only_latex_becomes_a_web_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "page.html"
    assert main(["check", "planar-2r-perugia", "--quantity", "p[1]", "--expression", "a1*c1", "-o", str(target)]) == 2
    assert "a web page of formulas that are no LaTeX" in capsys.readouterr().err
    assert not target.exists()
    assert main(["check", "planar-2r-perugia", "--latex", "x = a_1 c_1", "-o", str(target), "--quiet"]) == 1
    assert target.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


@pytest.mark.parametrize(
    ("typed", "latex"),
    [
        ("\u1e8b + q\u0307_1", r"\dot{x} + \dot{q}_1"),
        ("\u221a(a + b) \u221a3", r"\sqrt{a + b} \sqrt{3}"),
        (r"\frac l2 \tfrac{a}b \frac{a}{b}", r"\frac{l}{2} \tfrac{a}{b} \frac{a}{b}"),
        (r"c{12} \sin{2}", r"c_{12} \sin{2}"),
        (r"\pmatrix{a & b \cr c & d}", r"\begin{pmatrix}a & b \\ c & d\end{pmatrix}"),
    ],
)
def test_what_is_spelled_otherwise_becomes_latex(typed: str, latex: str) -> None:
    assert spelled(typed)[0] == latex


def test_lines_of_plain_text_that_are_equations_become_displays() -> None:
    text = "My arm\n- x = a1*cos(theta1)\nso x = the length of it\ntheta2 = atan2(y, x)"
    assert from_plain_text(text)[0].splitlines()[1::2] == [
        r"$$x = a1*\operatorname{cos}(\theta_{1})$$",
        r"$$\theta_{2} = \operatorname{atan2}(y, x)$$",
    ]
    assert from_plain_text(f"{text} $y$")[0] == f"{text} $y$"


@given(st.text(alphabet="\u1e8bq\u0307\u221a(a) \\frac{l}2c12=", max_size=30))
def test_every_character_of_a_spelling_comes_from_one_in_the_same_order(text: str) -> None:
    for found, origins in (spelled(text), from_plain_text(text)):
        assert len(found) == len(origins)
        assert list(origins) == sorted(origins)

"""Documents become text in which mathematics stands as LaTeX writes it, and their verdicts one web page.

Printed Denavit-Hartenberg tables become robots with the same transforms, whatever their columns are called.
Every character keeps its place in the file. The page has slips beside what is right, nothing from a network, and no
text of the document that runs.
"""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive import Model, Robot
from derive.checking.documents import MAX_DEPTH, Manuscript, document_of, expanded, read_document
from derive.checking.files import formula_printout
from derive.checking.latex.typography import spelled
from derive.checking.page import verdict_page
from derive.checking.plain_text import from_plain_text
from derive.checking.table import robot_of_table
from derive.cli.main import main
from derive.errors import CheckError
from tests.checking.test_pages import ANT
from tests.refusals import one_message
from tests.rows import robot_of_rows


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
    return verdict_page([formula_printout(ANT, "", document_of(text, name, ".md"), latex=True)])


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
    among = from_plain_text(f"{text} $y$\n$$x\ny = sin(q1)$$")[0].splitlines()
    assert among[1:] == [
        r"$$x = a1*\operatorname{cos}(\theta_{1})$$",
        *f"{text} $y$".splitlines()[2:],
        "$$x",
        "y = sin(q1)$$",
    ]


@given(st.text(alphabet="\u1e8bq\u0307\u221a(a) \\frac{l}2c12=", max_size=30))
def test_every_character_of_a_spelling_comes_from_one_in_the_same_order(text: str) -> None:
    for found, origins in (spelled(text), from_plain_text(text)):
        assert len(found) == len(origins)
        assert list(origins) == sorted(origins)


ELBOW = "standard: theta1,d1,0,pi/2 theta2,0,a2,0 theta3,0,a3,0"
SCARA = "standard: theta1,d1,l1,0 theta2,0,l2,pi theta3,0,0,0 0,d4,0,0"
CRAIG = "modified: theta1,0,0,0 theta2,0,L1,pi/2 theta3,0,L2,0"
TABLES = {
    r"""| $i$ | $\theta_i$ | $d_i$ | $a_i$ | $\alpha_i$ |
|---|---|---|---|---|
| 1 | $\theta_1$ | $d_1$ | 0 | $90^\circ$ |
| 2 | $\theta_2$ | 0 | $a_2$ | $0^\circ$ |
| 3 | $\theta_3$ | 0 | $a_3$ | $0^\circ$ |
""": ELBOW,
    """Link | \N{GREEK SMALL LETTER ALPHA} | a | d | \N{GREEK SMALL LETTER THETA}
---|---|---|---|---
1 | π/2 | 0 | d₁ | θ₁
2 | 0 | a₂ | 0 | θ₂
3 | 0 | a₃ | 0 | θ₃
""": ELBOW,
    r"""\begin{tabular}{|c|c|c|c|c|} \hline
Joint & $a_i$ & $\alpha_i$ (deg) & $d_i$ & $\theta_i$ \\ \hline
1 & 0 & 90 & $d_1$ & $\theta_1^*$ \\ \hline
2 & $a_2$ & 0 & 0 & $\theta_2^*$ \\ \hline
3 & $a_3$ & 0 & 0 & $\theta_3^*$ \\ \hline
\end{tabular}
""": ELBOW,
    r"""$$\begin{array}{c|cccc} i & a_i & \alpha_i & d_i & \theta_i \\ \hline
1 & 0 & \frac{\pi}{2} & d_1 & \theta_1 \\
2 & a_2 & 0 & 0 & \theta_2 \\
3 & a_3 & 0 & 0 & \theta_3 \end{array}$$
""": ELBOW,
    r"""| Eslabón ($i$) | $\theta_i$ (Rotación en $Z$) | $d_i$ (Distancia en $Z$) | $a_i$ | $\alpha_i$ (Torsión) |
| :---: | :---: | :---: | :---: | :---: |
| **1** | $\theta_1^*$ | $d_1$ | $l_1$ | $0^\circ$ |
| **2** | $\theta_2^*$ | $0$ | $l_2$ | $180^\circ$ |
| **3** | $\theta_3^*$ | $0$ | $0$ | $0^\circ$ |
| **4** | $0^\circ$ | $d_4^*$ | $0$ | $0^\circ$ |
""": SCARA,
    r"""| $i$ | $\alpha_{i-1}$ | $a_{i-1}$ | $d_i$ | $\theta_i$ |
|-----|-----|-----|-----|-----|
| 1 | 0 | 0 | 0 | $\theta_1$ |
| 2 | $90°$ | $L_1$ | 0 | $\theta_2$ |
| 3 | 0 | $L_2$ | 0 | $\theta_3$ |
""": CRAIG,
    """| Joint | alpha(i-1) [deg] | a(i-1) | d(i) | theta(i) |
| --- | --- | --- | --- | --- |
| 1 | 0 | 0 | 0 | theta1 |
| 2 | 90 | L1 | 0 | theta2 |
| 3 | 0 | L2 | 0 | theta3 |
""": CRAIG,
    """| link | twist | link length | offset | theta |
|---|---|---|---|---|
| 1 | -90 | 0 | 0 | q1 |
| 2 | 90 | 0 | d2 | q2 - 90 |
| 3 | 0 | 0 | q3 | 0 |
""": "standard: q1,0,0,-pi/2 q2-pi/2,d2,0,pi/2 0,q3,0,0",
    """| i | theta | d | a | alpha |
|---|---|---|---|---|
| 1 | theta1 | 0 | a1 | 5 |
| 2 | theta2 + 0 | 0 | a2 | 90 |
""": "standard: theta1,0,a1,pi/36 theta2,0,a2,pi/2",
    """| i | theta | d (mm) | a (mm) | alpha |
|---|---|---|---|---|
| 1 | theta1 | 330 | 75 | -pi/2 |
| 2 | theta2 | 0 | 300 | 0 |
""": "standard: theta1,0.33,0.075,-pi/2 theta2,0,0.3,0",
}


def text_of(rows: str) -> Robot:
    convention, *joints = rows.split()
    lines = []
    for row in joints:
        theta, d, a, alpha = row.split(",")
        q = theta.split("-")[0] if theta[0] in "tq" else d
        kind = "R" if theta[0] in "tq" else "P"
        lines.append(f"{kind} q: {q}, theta: {theta}, d: {d}, a: {a}, alpha: {alpha}")
    return robot_of_rows("|".join(lines), convention=convention.removesuffix(":"))


@pytest.mark.parametrize("table", TABLES, ids=range(len(TABLES)))
def test_a_printed_table_is_the_robot_that_it_describes(table: str) -> None:
    kind = ".tex" if "\\begin" in table else ".md"
    text, where = robot_of_table(document_of(f"Prose before.\n\n{table}\nand after\n", "page", kind), "arm")
    read, meant = Robot.from_text(text), text_of(TABLES[table])
    assert read.convention == meant.convention
    assert [joint.variable for joint in read.joints] == [joint.variable for joint in meant.joints]
    assert Model(read).quantity("T") == Model(meant).quantity("T")
    assert where.line == 3 if kind == ".md" else where.line in (3, 4)


def test_a_last_row_without_a_variable_is_the_tool() -> None:
    rows = "| i | theta | d | a | alpha |\n|---|---|---|---|---|\n| 1 | theta1 | 0 | a1 | 0 |\n"
    text, _ = robot_of_table(document_of(f"{rows}| 2 | pi/2 | d2 | a2 | -pi/2 |\n", "page", ".md"), "arm")
    meant = robot_of_rows("R q: theta1, a: a1", "tool: [[0, 0, -1, 0], [1, 0, 0, a2], [0, -1, 0, d2], [0, 0, 0, 1]]")
    assert np.array_equal(Model(Robot.from_text(text)).quantity("T"), Model(meant).quantity("T"))


HEAD = "| i | theta | d | a | alpha |\n|---|---|---|---|---|\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("no table here\n", "no Denavit-Hartenberg table"),
        (f"{HEAD}| 1 | q1 | 0 | a1 | 0 |\n\nprose\n\n{HEAD}| 1 | q1 | 0 | a2 | 0 |\n", "2 Denavit-Hartenberg tables"),
        (f"{HEAD}| 1 | 0 | 0 | a1 | 0 |\n| 2 | q2 | 0 | a2 | 0 |\n", "row 1 has no variable"),
        (f"{HEAD}| 1 | q1 | ? | a1 | 0 |\n", "cell '?' of column d"),
        (f"{HEAD}| 1 | q1 | d(1 | a1 | 0 |\n", "a table that is no robot"),
    ],
)
def test_what_is_no_table_is_refused_with_its_place(text: str, message: str) -> None:
    with one_message(CheckError, "page.md[0-9:]*", message):
        robot_of_table(document_of(text, "page.md", ".md"), "arm")


def test_a_command_writes_the_file_and_lines_choose_the_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("notes.md").write_text(f"{HEAD}| 1 | q1 | 0 | a1 | 0 |\n\nprose\n\n{HEAD}| 1 | q1 | 0 | a2 | 0 |\n")
    assert main(["new", "arm", "--from-table", "notes.md"]) == 2
    assert not Path("arm.yaml").exists()
    assert main(["new", "arm", "--from-table", "notes.md", "--lines", "6-9"]) == 0
    assert Robot.load("arm.yaml").joints[0].variable == "q1"
    assert "a2" in Path("arm.yaml").read_text()
    assert main(["new", "two", "--from-table", "notes.md", "--joints", "2"]) == 2


def test_a_document_with_its_table_is_checked_without_a_robot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    rows = "| 1 | theta1 | 0 | a1 | 0 |\n| 2 | theta2 | 0 | a2 | 0 |\n"
    Path("notes.md").write_text(
        f"# Arm\n{HEAD}{rows}\n$$x = a_1 c_1 + a_2 c_{{12}}$$\n$$y = a_1 s_1 - a_2 s_{{12}}$$\n"
    )
    assert main(["check", "--latex", "notes.md"]) == 1
    said = capsys.readouterr().out
    assert said.startswith("notes.md: the robot is that of the table at notes.md:2:1\n")
    assert "p[1]: same form" in said
    assert "p[2] is wrong" in said
    assert main(["check", "--latex", "x = a_1 c_1"]) == 2
    assert main(["check"]) == 2
    assert "name a corpus file" in capsys.readouterr().err

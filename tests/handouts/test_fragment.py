"""Fragments: every quantity can be put into notes, alone, names the packages that it needs, and fits its line."""

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from derive.errors import DeriveError, QuantityError, TargetError
from derive.handouts.render import fragment, fragment_text
from derive.handouts.sheet.document import Paragraph, Rows, Section, Table
from derive.handouts.sheet.language import Text
from derive.model.quantities import REGISTRY
from derive.programs.functions import ROWS
from derive.robot.options.handout import PARTS, InertiaLetter, NotationOptions
from derive.robot.robot import Robot
from tests.handouts.latex_runner import overfull_boxes, require_latex, run_latex
from tests.random_robots import swept_catalogue
from tests.rows import TWO_BARS, robot_of_rows

NAMES = (
    *("T", "T[0,1]", "A[1]", "p", "R", "J", "Jv_com[2]", "B", "B[1,2]", "Bdot", "C", "N", "g", "tau", "tau[1]"),
    *("kinetic", "potential", "christoffel[1,1,2]"),
)


@pytest.fixture(scope="module")
def bar() -> Robot:
    return robot_of_rows("R a: a1 | R a: a2", TWO_BARS, name="bar")


@pytest.mark.parametrize("name", NAMES)
def test_a_quantity_stands_alone(bar: Robot, name: str) -> None:
    heading, body = fragment_text(bar, bar.handout, name).split("\n", 1)
    assert heading.startswith(f"% {name} of bar: written by derive")
    assert r"needs \usepackage{amsmath}" in heading
    assert "=" in body
    assert r"\documentclass" not in body
    assert body.count("{") - body.count(r"\{") == body.count("}") - body.count(r"\}")
    assert body.count(r"\begin") == body.count(r"\end")


@pytest.mark.parametrize(
    ("book", "ours"),
    [
        ("M", "B"),
        ("mass matrix", "B"),
        ("T02", "T[0,2]"),
        ("^0T_2[1,4]", "T[0,2][1,4]"),
        ("b_12", "B[1,2]"),
        ("det(J)", "detJ"),
    ],
)
def test_names_of_books_are_understood_as_by_show(bar: Robot, book: str, ours: str) -> None:
    assert (
        fragment_text(bar, bar.handout, book).split("\n", 1)[1]
        == fragment_text(bar, bar.handout, ours).split("\n", 1)[1]
    )


def test_what_has_several_meanings_or_none_is_refused_with_what_may_be_meant(bar: Robot) -> None:
    with pytest.raises(QuantityError, match="several meanings"):
        fragment_text(bar, bar.handout, "euler angles")
    with pytest.raises(TargetError, match="did you mean 'inertia'"):
        fragment_text(bar, bar.handout, "inerta")
    plain = robot_of_rows("R a: a1")
    with pytest.raises(QuantityError, match="no links"):
        fragment_text(plain, plain.handout, "B")


def test_a_name_with_line_breaks_stays_in_its_comment_and_wide_matrices_say_so(bar: Robot) -> None:
    assert fragment_text(bar, bar.handout, "mass\n matrix").startswith("% mass matrix of bar")
    robot = robot_of_rows(" | ".join("P" * 11))
    text = fragment_text(robot, robot.handout, "J")
    assert "c@MaxMatrixCols\\endcsname=11" in text


def test_functions_and_symbols_are_those_of_the_registry(bar: Robot) -> None:
    functions = {row.interface.name for row in ROWS}
    named = {row.name: row.function for row in REGISTRY.values() if row.function}
    assert set(named.values()) <= functions
    assert named["B"] == "inertia_matrix"
    letter = replace(bar.handout, notation=NotationOptions(inertia=InertiaLetter.M))
    assert "\\mathbf{J}_v^{l_{2}}" in fragment_text(bar, letter, "Jv_com[2]")
    assert "\\mathbf{M}^{l_{1}}" in fragment_text(bar, letter, "B_link[1]")
    assert "\\dot{\\mathbf{M}}" in fragment_text(bar, letter, "Bdot")


@pytest.mark.parametrize("width", ["84", "wide", "-3cm", "1em\\input{x}", "10 mm"])
def test_a_width_that_is_none_is_refused(bar: Robot, width: str) -> None:
    with pytest.raises(QuantityError, match="such as 84mm"):
        fragment_text(bar, bar.handout, "B", width)


PLANE = "planar-2r-perugia"
LARGE = 8
"""Joints beyond which only these quantities are short enough to be asked for one by one."""
OF_LARGE = ("A", "T", "p", "R", "J", "J_end")

CLASSES = [
    f"[{size}{columns}]{{{name}}}"
    for name in ("article", "book")
    for size in ("10pt", "11pt", "12pt")
    for columns in ("", ",twocolumn")
]
SLIDE = "[11pt]{article}"
SLIDE_SIZE = (
    "\\textwidth=307pt\\hsize=\\textwidth\\linewidth=\\textwidth\\columnwidth=\\textwidth\\textheight=244pt\\sffamily"
)
"""The frame of a slide, for machines without beamer."""


def fragments_of(name: str, folder: Path) -> list[str]:
    robot, texts = Robot.load(name), []
    wanted = [row for row in REGISTRY.values() if robot.n <= LARGE or row.name in OF_LARGE]
    indexed = [(row.name, ",".join("1" * min(row.indices))) for row in wanted]
    for asked in (*PARTS, *(f"{row}[{indices}]" if indices else row for row, indices in indexed)):
        try:
            texts.append(fragment_text(robot, robot.handout, asked))
        except DeriveError:  # what this robot does not have
            continue
        (folder / f"fragment-{len(texts)}.tex").write_text(texts[-1])
    return texts


def assert_fits(texts: list[str], document_class: str, folder: Path) -> None:
    packages = sorted({name for text in texts for name in re.findall(r"\\usepackage\{(\w+)\}", text.split("\n")[0])})
    is_beamer = "beamer" in document_class
    before, after = ("\\begin{frame}[allowframebreaks]{A}\n", "\n\\end{frame}") if is_beamer else ("", "")
    inputs = [f"{before}\\input{{fragment-{k}}}{after}" for k in range(1, len(texts) + 1)]
    lines = [
        f"\\documentclass{document_class}",
        *(f"\\usepackage{{{name}}}" for name in packages),
        "\\hfuzz=0.1pt\\vfuzz=0.1pt",
        "\\begin{document}",
        SLIDE_SIZE if document_class == SLIDE else "",
        *inputs,
        "\\end{document}",
    ]
    log = run_latex("\n".join(lines), folder)
    assert not log.faults, document_class
    assert not overfull_boxes(log), document_class


@pytest.mark.slow
def test_every_fragment_of_a_robot_fits_its_line(tmp_path: Path) -> None:
    texts = fragments_of(PLANE, tmp_path)
    assert len(texts) > len(PARTS)
    for document_class in ("[12pt,twocolumn]{book}", SLIDE):
        assert_fits(texts, document_class, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", swept_catalogue())
def test_every_fragment_of_every_robot_fits_every_class(name: str, tmp_path: Path) -> None:
    texts = fragments_of(name, tmp_path)
    for document_class in (*CLASSES, SLIDE):
        assert_fits(texts, document_class, tmp_path)
    if has_beamer():
        assert_fits(texts, "[11pt]{beamer}", tmp_path)


def has_beamer() -> bool:
    finder = shutil.which("kpsewhich")
    if finder is None:
        return False
    found = subprocess.run([finder, "beamer.cls", "pgfmath.sty"], capture_output=True, text=True, check=False)
    return len(found.stdout.split()) == 2


def test_only_figures_need_more_than_amsmath() -> None:
    robot = Robot.load(PLANE)
    needs = {
        name: fragment_text(robot, robot.handout, name).split("\n")[0]
        for name in ("figure", "convention", "table", "B", "T")
    }
    drawn = {name for name, line in needs.items() if "graphicx" in line}
    assert drawn == {"figure", "convention"}
    assert all("\\usepackage{amsmath}" in line for line in needs.values())


def test_a_width_sets_lines_as_a_document_of_that_width_does(tmp_path: Path) -> None:
    """The same height, which is another one than that of wide lines."""
    require_latex()
    robot = Robot.load(PLANE)
    for name, width in (("free", ""), ("set", "50mm")):
        (tmp_path / f"{name}.tex").write_text(fragment_text(robot, robot.handout, "transforms", width))
    narrow = "\\hsize=50mm\\linewidth=\\hsize"
    lines = [
        f"\\setbox3\\vbox{{{before}\\input{{{name}}}}}\\typeout{{height {name} \\the\\ht3}}"
        for before, name in (("", "free"), ("", "set"), (narrow, "free"))
    ]
    body = "\n".join(lines)
    log = run_latex(
        f"\\documentclass{{article}}\\usepackage{{amsmath}}\\begin{{document}}\n{body}\n\\end{{document}}", tmp_path
    )
    wide, fixed, found = re.findall(r"height \w+ ([0-9.]+)pt", log.text)
    assert fixed == found != wide


def test_what_no_line_holds_becomes_smaller_or_stands_row_by_row(tmp_path: Path) -> None:
    """A table of twelve long cells, a matrix times a vector, and the same where there is room."""
    cells = tuple(f"a long cell {k}" for k in range(12))
    product = "\\begin{bmatrix} " + " & ".join(["aaaa"] * 8) + " \\end{bmatrix} x"
    blocks = (Paragraph("Words."), Table(cells, (cells, cells)), Rows((product, "x = a \\qquad y = b")))
    text = fragment(Section("", "", blocks), Text(), name="all", robot="bar")
    (tmp_path / "fragment-1.tex").write_text(text)
    for document_class in ("[12pt,twocolumn]{article}", "[10pt]{article}"):
        assert_fits([text], document_class, tmp_path)

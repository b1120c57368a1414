"""Printed LaTeX against a robot: left sides, meanings, equations."""

from functools import cache
from pathlib import Path
from typing import Any

import pytest
import sympy
import yaml

from derive.checking.formulas.findings import Outcome, judge
from derive.checking.latex.check import check_latex
from derive.checking.latex.equations import equations
from derive.checking.latex.left import Turned, taken_apart
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.meanings import Meanings, entry_named
from derive.checking.latex.targets import Target, candidates, is_scalar
from derive.errors import CheckError, Location
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import LatexPrinter
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.model import Model
from derive.robot.expression import ZERO
from derive.robot.robot import Robot
from tests.refusals import one_message

FILE = Path(__file__).with_name("latex_snippets.yaml")
GROUPS = yaml.safe_load(FILE.read_text(encoding="utf-8"))
SNIPPETS = [row for name, rows in GROUPS.items() if name not in ("robot", "refused") for row in rows]


def label(row: dict[str, Any]) -> str:
    return " ".join(row["latex"].split())[:50].replace("\\", "/")


@cache
def model(name: str) -> Model:
    return Model(Robot.load(FILE if name == "textbook-2r" else name))


@pytest.mark.first(60)
@pytest.mark.parametrize("row", SNIPPETS, ids=label)
def test_right_formulas_pass_and_wrong_ones_do_not(row: dict[str, Any]) -> None:
    findings = check_latex(model(row["robot"]), row["latex"], row.get("quantity", "")).findings
    right = [finding.entry for finding in findings if finding.verdict.equal]
    wrong = [finding.entry for finding in findings if not finding.verdict.equal]
    assert (len(right), len(wrong)) == (row["equal"], row["wrong"]), (right, wrong)
    assert not [finding.unknown for finding in findings if finding.unknown]


@pytest.mark.parametrize("row", GROUPS["refused"], ids=label)
def test_what_is_not_understood_is_refused_in_words(row: dict[str, Any]) -> None:
    with one_message(CheckError, r"<latex>:\d+:\d+", row["message"]):
        check_latex(model(row["robot"]), row["latex"], row.get("quantity", ""))


def test_a_finding_stands_where_its_formula_does() -> None:
    text = (
        "\\begin{align}\n  x &= a_1 c_1 + a_2 c_{12} \\\\\n  y &= a_1 s_1 \\\\\n    &\\quad - a_2 s_{12}\n\\end{align}"
    )
    found = check_latex(model("planar-2r-perugia"), text, start=Location("notes.tex")).findings
    assert [str(f.location) for f in found] == ["notes.tex:2:8", "notes.tex:3:8"]


def test_an_unknown_name_concerns_its_entry_only_and_one_defined_twice_means_what_stands_before() -> None:
    text = r"p = \begin{bmatrix} a_1 c_1 + a_7 c_{12} \\ a_1 s_1 + a_2 s_{12} \\ 0 \end{bmatrix}"
    first, *others = check_latex(model("planar-2r-perugia"), text).findings
    assert "unknown name 'a7'" in str(first.unknown)
    assert all(finding.verdict.equal for finding in others)
    text = r"h = a_1 c_1 \\ x = h + a_2 c_{12} \\ h = a_1 s_1 \\ y = h + a_2 s_{12}"
    assert [f.verdict.equal for f in check_latex(model("planar-2r-perugia"), text).findings] == [True, True]


def test_of_a_document_the_displays_are_read_and_the_rest_is_named() -> None:
    text = (
        "\\documentclass{article}\\begin{document}\nThe arm has $n = 2$ joints.\n\\section{Kinematics}\n"
        "\\begin{itemize}\\item \\[ x = a_1 c_1 + a_2 c_{12} \\]\\end{itemize}\n"
        "\\begin{equation} K_i = \\sum_j m_j \\end{equation}\n\\end{document}"
    )
    report = check_latex(model("planar-2r-perugia"), text)
    assert [f.entry for f in report.findings] == ["p[1]"]
    assert [skipped.location.line for skipped in report.skipped] == [5]


@pytest.mark.parametrize(("change", "equal"), [("", True), ("1e-5", True), ("5e-5", False)])
def test_numbers_may_be_rounded_to_the_digits_that_are_printed(change: str, equal: bool) -> None:
    puma = model("puma560-corke")
    right = puma.quantity("B[2,2]") + sympy.Rational(change or 0)
    printed = LatexPrinter(Notation.of(puma.robot)).latex(right)
    assert check_latex(puma, printed, "B[2,2]").findings[0].verdict.equal is equal


def test_long_matrices_are_read_entry_by_entry_and_a_missing_small_term_is_no_rounding() -> None:
    puma = model("puma560-corke")
    printed = LatexPrinter(Notation.of(puma.robot)).latex(puma.quantity("B[2,2]"))
    assert "+ 0.00030216c_{4}^{2}" in printed
    lacking = printed.replace("+ 0.00030216c_{4}^{2}", "")
    assert not check_latex(puma, lacking, "B[2,2]").findings[0].verdict.equal
    findings = check_latex(puma, sympy.latex(puma.quantity("B")), "B").findings
    assert len(findings) == 36
    assert all(judge(finding).outcome is Outcome.SAME_FORM for finding in findings)


INVERSES = [
    r"J^{T} = \begin{bmatrix} -a_1 s_1 - a_2 s_{12} & a_1 c_1 + a_2 c_{12} \\ -a_2 s_{12} & a_2 c_{12} \end{bmatrix}",
    r"J^{-1} = \frac{1}{a_1 a_2 s_2} \begin{bmatrix} a_2 c_{12} & a_2 s_{12} \\"
    r" -a_1 c_1 - a_2 c_{12} & -a_1 s_1 - a_2 s_{12} \end{bmatrix}",
    r"\left(\mathbf{A}_1^0\right)^{-1} = \begin{bmatrix} c_1 & s_1 & 0 & -a_1 \\"
    r" -s_1 & c_1 & 0 & 0 \\ 0 & 0 & 1 & 0 \\ 0 & 0 & 0 & 1 \end{bmatrix}",
    r"B^{-1} = \frac{1}{b_{11} b_{22} - b_{12}^2} \begin{bmatrix} b_{22} & -b_{12} \\ -b_{12} & b_{11} \end{bmatrix}",
    r"(\mathbf{R}_2^0)^T = \mathbf{R}_0^2",
    r"R_1^{0\,\top} = \begin{bmatrix} c_1 & s_1 \\ -s_1 & c_1 \end{bmatrix}",
]


@pytest.mark.parametrize("text", INVERSES)
def test_transposes_and_inverses_of_what_is_derived_are_compared(text: str) -> None:
    """Each is right as it stands; one sign more is wrong, in one entry or in all."""
    arm = model("planar-2r-perugia")
    assert all(finding.verdict.equal for finding in check_latex(arm, text).findings)
    left, right = text.split(" = ", 1)
    if "begin" in right:
        wrong = check_latex(arm, left + " = " + right.replace("c_1", "-c_1", 1).replace("{ b_{22}", "{ -b_{22}"))
        assert not all(finding.verdict.equal for finding in wrong.findings) or "c_1" not in right


SPONG = (
    r"c_{ijk} = \frac{1}{2} \left( \frac{\partial d_{kj}}{\partial q_i} + \frac{\partial d_{ki}}{\partial q_j}"
    r" - \frac{\partial d_{ij}}{\partial q_k} \right) \\ "
)


def test_the_order_of_the_indices_is_that_of_the_definition_in_the_text() -> None:
    """Spong's c_{112} is our c_{211}: the index of the torque is that of the derivative which is subtracted."""
    arm, symbol = model("planar-2r-perugia"), r"c_{112} = m_{l2} a_1 l_2 s_2"
    (finding,) = check_latex(arm, SPONG + symbol).findings
    assert (finding.entry, finding.verdict.equal) == ("christoffel[2,1,1]", True)
    ours = SPONG.replace("q_k", "q_x").replace("q_i", "q_k").replace("q_x", "q_i")
    (finding,) = check_latex(arm, ours + symbol).findings
    assert (finding.entry, finding.verdict.equal) == ("christoffel[1,1,2]", False)


def test_another_order_of_the_indices_is_named_where_it_fits() -> None:
    (finding,) = check_latex(model("planar-2r-perugia"), r"c_{112} = m_{l2} a_1 l_2 s_2").findings
    repair = judge(finding).repair
    assert repair.text.endswith("; or other order of the indices: it is christoffel[2,1,1]")
    (finding,) = check_latex(model("planar-2r-perugia"), r"c_{112} = 3 m_{l2} a_1 l_2 s_2").findings
    repair = judge(finding).repair
    assert repair is None or "indices" not in repair.text


def meanings(text: str) -> list[Target]:
    left = taken_apart(text)
    return [] if left is None else list(candidates(left, 3))


@pytest.mark.parametrize(
    ("text", "quantity"),
    [
        (r"\mathbf{T}_3^0", "T[0,3]"), (r"T^0_2", "T[0,2]"), (r"^0T_2", "T[0,2]"), (r"^{0}_{2}T", "T[0,2]"),
        (r"T_e^b", "T"), (r"\mathbf{A}_2^1(q_2)", "A[2]"), (r"^{1}A_{2}", "A[2]"), ("B(q)", "B"),
        (r"\mathbf{C}(\mathbf{q}, \dot{\mathbf{q}})", "C"), (r"\dot{\mathbf{B}}", "Bdot"),
        (r"C(q,\dot q)\dot q", "Cqd"), (r"\Gamma_{1,12}", "christoffel[1,1,2]"), (r"\det(\mathbf{J})", "detJ"),
        (r"\mathbf{J}_v^{\ell_2}", "Jv_com[2]"), (r"J_{\omega_{c2}}", "Jw_com[2]"),
        (r"\boldsymbol{\phi}_{\mathrm{RPY}}", "rpy"),
    ],
)  # fmt: skip
def test_the_likeliest_meaning_comes_first(text: str, quantity: str) -> None:
    assert meanings(text)[0] == Target(quantity)


@pytest.mark.parametrize(
    ("text", "target"),
    [
        (r"\mathbf{J}^T", Target("J", turned=Turned.TRANSPOSED)),
        (r"(\mathbf{T}^0_2)^{-1}", Target("T[0,2]", turned=Turned.INVERTED)),
        (r"R_2^{0\top}", Target("T[0,2]", (1, 2, 3), (1, 2, 3), turned=Turned.TRANSPOSED)),
        (r"^0R_2^{-1}", Target("T[0,2]", (1, 2, 3), (1, 2, 3), turned=Turned.INVERTED)),
        (r"J^{-T}", Target("J", turned=Turned.BOTH)),
        (r"M(q)^{-1}", Target("B", turned=Turned.INVERTED)),
        ("b_{12}", Target("B", (1,), (2,))),
        (r"\tau_2", Target("tau", (2,))),
        ("p_x", Target("p", (1,))),
        ("y", Target("p", (2,))),
        ("n_z", Target("T", (3,), (1,))),
        ("J_P", Target("J", (1, 2, 3))),
        ("T_{14}", Target("T", (1,), (4,))),
        (r"\mathbf{R}_2^0", Target("T[0,2]", (1, 2, 3), (1, 2, 3))),
    ],
)
def test_parts_transposes_and_inverses_are_those_of_what_is_known(text: str, target: Target) -> None:
    assert target in meanings(text)
    assert all(other.turned is target.turned for other in meanings(text))


def test_frames_have_the_labels_of_the_joints_and_an_entry_is_one_formula() -> None:
    left = taken_apart("T_6^3")
    assert candidates(left, 3, first=4)[0] == Target("T[0,3]")
    assert is_scalar(Target("B", (1,), (2,)))
    assert is_scalar(Target("g", (1,)))
    assert not is_scalar(Target("B"))


@pytest.mark.parametrize("text", ["a + b", r"\frac{a}{b}", "", "2", "T T"])
def test_what_is_no_single_symbol_names_nothing(text: str) -> None:
    assert meanings(text) == []


MODEL = Model(Robot.load("planar-2r-perugia"))
MEANINGS = Meanings(MODEL)


def values(text: str) -> list[object]:
    left = taken_apart(text)
    return [right.value for target in MEANINGS.targets(left) if (right := MEANINGS.right(target))]


def test_left_sides_and_names_of_entries_stand_for_what_is_derived() -> None:
    assert MODEL.quantity("B") in values(r"\mathbf{B}(\mathbf{q})")
    assert MODEL.quantity("B").extract([0], [1]) in values("b_{12}")
    assert entry_named(MEANINGS, None, "b12") == expression_from_sympy(MODEL.quantity("B")[0, 1])
    assert entry_named(MEANINGS, None, "b19") is entry_named(MEANINGS, None, "a1b") is None


def test_what_is_asked_about_agrees_with_its_entries_only_and_a_vector_fits_as_a_row_too() -> None:
    (whole,) = (right for right in MEANINGS.asked("B") if right.rows == (1, 2))
    assert whole.shown == "B"
    lefts = filter(None, map(taken_apart, ("b_{12}", "g_1")))
    entry, of_gravity = (next(r for t in MEANINGS.targets(left) if (r := MEANINGS.right(t))) for left in lefts)
    assert entry.shown == "B[1,2]"
    assert entry.agrees(whole)
    assert not of_gravity.agrees(whole)
    (gravity, *_) = MEANINGS.asked("g")
    row = Table(((Entry(ZERO), Entry(ZERO)),))
    assert gravity.fitting(row) == row.transposed
    assert gravity.fitting(Table(((Entry(ZERO),),))) is None


START = Location("notes.tex")


def sides(text: str) -> list[list[str]]:
    return [[" ".join(side.text.split()) for side in e] for e in equations(text, START)]


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


@pytest.mark.parametrize(
    ("text", "column"), [(r"a \begin{foo} b \end{foo}", 3), (r"\begin{bmatrix} a", 1), (r"a \end{bmatrix}", 3)]
)
def test_environments_that_are_no_displays_are_refused(text: str, column: int) -> None:
    with one_message(CheckError, f"notes.tex:1:{column}", ""):
        list(equations(text, START))

"""LaTeX as people have it: right formulas pass, wrong ones do not, and what cannot be read is refused in words."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import sympy
import yaml

from derive.checking.formulas.findings import Outcome, judge
from derive.checking.latex.check import check_latex
from derive.errors import CheckError, Location
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import LatexPrinter
from derive.model.model import Model
from derive.robot.robot import Robot

FILE = Path(__file__).with_name("latex_snippets.yaml")
GROUPS = yaml.safe_load(FILE.read_text(encoding="utf-8"))
SNIPPETS = [row for name, rows in GROUPS.items() if name not in ("robot", "refused") for row in rows]


def label(row: dict[str, Any]) -> str:
    return " ".join(row["latex"].split())[:50].replace("\\", "/")


@cache
def model(name: str) -> Model:
    return Model(Robot.load(FILE if name == "textbook-2r" else name))


@pytest.mark.parametrize("row", SNIPPETS, ids=label)
def test_right_formulas_pass_and_wrong_ones_do_not(row: dict[str, Any]) -> None:
    findings = check_latex(model(row["robot"]), row["latex"], row.get("quantity", "")).findings
    right = [finding.entry for finding in findings if finding.verdict.equal]
    wrong = [finding.entry for finding in findings if not finding.verdict.equal]
    assert (len(right), len(wrong)) == (row["equal"], row["wrong"]), (right, wrong)
    assert not [finding.unknown for finding in findings if finding.unknown]


@pytest.mark.parametrize("row", GROUPS["refused"], ids=label)
def test_what_is_not_understood_is_refused_in_words(row: dict[str, Any]) -> None:
    with pytest.raises(CheckError) as caught:
        check_latex(model(row["robot"]), row["latex"], row.get("quantity", ""))
    assert row["message"] in str(caught.value)
    assert caught.value.location is not None


def test_a_finding_stands_where_its_formula_does() -> None:
    text = (
        "\\begin{align}\n  x &= a_1 c_1 + a_2 c_{12} \\\\\n  y &= a_1 s_1 \\\\\n    &\\quad - a_2 s_{12}\n\\end{align}"
    )
    places = [
        str(f.location) for f in check_latex(model("planar-2r-perugia"), text, start=Location("notes.tex")).findings
    ]
    assert places == ["notes.tex:2:8", "notes.tex:3:8"]


def test_a_wrong_entry_comes_with_the_change_that_repairs_it() -> None:
    text = r"J = \begin{bmatrix} -a_1 s_1 - a_2 s_{12} & a_2 s_{12} \\ a_1 c_1 + a_2 c_{12} & a_2 c_{12} \end{bmatrix}"
    verdicts = [judge(finding) for finding in check_latex(model("planar-2r-perugia"), text).findings]
    assert [verdict.outcome for verdict in verdicts].count(Outcome.WRONG) == 1
    assert [verdict.repair.text for verdict in verdicts if verdict.repair] == ["sign: -a2*s12 instead of a2*s12"]


def test_an_unknown_name_concerns_its_entry_only() -> None:
    text = r"p = \begin{bmatrix} a_1 c_1 + a_7 c_{12} \\ a_1 s_1 + a_2 s_{12} \\ 0 \end{bmatrix}"
    first, *others = check_latex(model("planar-2r-perugia"), text).findings
    assert "unknown name 'a7'" in str(first.unknown)
    assert all(finding.verdict.equal for finding in others)


def test_a_name_that_is_defined_twice_means_what_stands_before() -> None:
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


def test_a_missing_small_term_is_no_rounding() -> None:
    puma = model("puma560-corke")
    printed = LatexPrinter(Notation.of(puma.robot)).latex(puma.quantity("B[2,2]"))
    assert "+ 0.00030216c_{4}^{2}" in printed
    lacking = printed.replace("+ 0.00030216c_{4}^{2}", "")
    assert not check_latex(puma, lacking, "B[2,2]").findings[0].verdict.equal


def test_a_long_matrix_of_another_program_is_read_entry_by_entry() -> None:
    puma = model("puma560-corke")
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


def test_an_inverse_that_is_long_or_has_no_end_is_refused() -> None:
    with pytest.raises(CheckError, match=re.escape("'J^{-1}' is not derived")):
        check_latex(model("puma560-usp"), r"J^{-1} = \begin{bmatrix} c_1 & s_1 \\ -s_1 & c_1 \end{bmatrix}")


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
    assert repair is not None
    assert repair.text.endswith("; or other order of the indices: it is christoffel[2,1,1]")
    (finding,) = check_latex(model("planar-2r-perugia"), r"c_{112} = 3 m_{l2} a_1 l_2 s_2").findings
    repair = judge(finding).repair
    assert repair is None or "indices" not in repair.text

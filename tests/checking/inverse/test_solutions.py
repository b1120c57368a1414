"""Printed solutions in files: the block ``inverse_kinematics:`` with lines or LaTeX."""

from __future__ import annotations

import pytest

from derive.api.robots import load
from derive.checking.comparison import check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.findings import Finding, Outcome, judge
from derive.checking.inverse.check import names_inverse
from derive.errors import CheckError
from derive.model.model import Model

ARM = """\
robot:
  name: arm
  convention: standard
  joints: [{type: revolute, a: a1}, {type: revolute, a: a2}]
inverse_kinematics:
"""
LINES = """\
  lines:
    - theta1 = atan2(y, x) - atan2(a2*s2, a1 + a2*c2)
    - D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2)
    - theta2 = atan2(+-sqrt(1 - D**2), D)
"""
LATEX = r"""  task: [x, y]
  latex: |
    D = \frac{x^2 + y^2 - a_1^2 - a_2^2}{2 a_1 a_2}
    \theta_2 = \arccos D \\
    \theta_1 = \operatorname{atan2}(y, x) - \operatorname{atan2}(a_2 s_2, a_1 + a_2 c_2)
"""


def findings(block: str) -> tuple[Finding, ...]:
    return check_file(corpus_from_bytes((ARM + block).encode(), "notes.yaml")).findings


def test_lines_in_any_order_are_one_solution() -> None:
    assert [f.verdict.equal for f in findings(LINES)] == [True, True, True]


def test_a_text_of_several_lines_will_do() -> None:
    block = "  lines: |\n    D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2)\n    theta2 = atan2(+-sqrt(1 - D), D)\n"
    (wrong,) = findings(block)
    assert (judge(wrong).outcome, str(wrong.location)) == (Outcome.WRONG, "notes.yaml:8:14")


def test_latex_is_placed_in_the_file() -> None:
    some, right, branches = findings(LATEX.replace("a_2}\n", "a_2} \\\\\n"))
    assert (judge(some).outcome, str(some.location)) == (Outcome.SOME, "notes.yaml:9:16")
    assert right.verdict.equal
    assert branches.missing == ("elbow up",)


def test_several_solutions_are_a_list_and_errata_are_marked() -> None:
    item = "  - lines: [{}]\n    status: {}\n"
    block = item.format("theta2 = acos(x)", "erratum") + item.format('"theta2 = atan2(r21, r11) - theta1"', "ok")
    found = findings(block)
    assert [f.erratum for f in found if not f.verdict.equal] == [True]
    assert [f.erratum for f in found if f.verdict.equal] == [False, False]


@pytest.mark.parametrize("order", ["atan2: xy\n", ""])
def test_the_cosine_may_be_the_first_argument_where_the_file_says_so(order: str) -> None:
    found = findings(f'  lines: ["theta2 = atan2(r11, r21) - theta1"]\n  {order}')
    assert found[0].verdict.equal is bool(order)


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("  note: none\n", "needs either 'lines', 'latex' or 'formulas'"),
        ("  lines: [theta2]\n", "notes.yaml:6:11: line that is no equation"),
        ("  lines: ['']\n", "empty solution"),
        ("  lines: [theta2 = 0]\n  task: [x, w]\n", "notes.yaml:7:9"),
        ("  lines: [theta2 = 0]\n  atan2: yz\n", "allowed: yx, xy"),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_place(block: str, message: str) -> None:
    with pytest.raises(CheckError) as caught:
        findings(block)
    assert message in str(caught.value)


def test_an_unknown_name_leaves_the_solution_undecidable() -> None:
    for unknown in ("zz", "atan2(zz, x)"):
        (found,) = findings(f'  lines: ["theta2 = {unknown}"]\n')
        assert judge(found).outcome is Outcome.UNDECIDABLE
        assert found.location.line == 6


def test_the_quantity_has_the_names_of_books() -> None:
    model = Model(load("planar-2r-perugia"))
    assert names_inverse(model, "inverse")
    assert not names_inverse(model, "T")
    assert not names_inverse(model, "")
    assert not names_inverse(model, "nothing")

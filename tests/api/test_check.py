"""`derive.check` and `derive.check_formula` do what the command does."""

from fractions import Fraction
from pathlib import Path

import pytest

from derive.api.check import check, check_formula, check_inverse
from derive.errors import UnknownNameError

NOTES = """\
robot:
  name: pendulum
  convention: standard
  joints:
    - {type: revolute, a: a1}
expected:
  - quantity: p
    entries: {"1": "a1*c1", "2": "-a1*s1", "3": "z"}
"""


def test_a_file_of_formulas_gets_a_verdict_on_each(tmp_path: Path) -> None:
    (tmp_path / "notes.yaml").write_text(NOTES)
    checked = check(tmp_path / "notes.yaml")
    assert [verdict.outcome for verdict in checked.verdicts] == ["same form", "wrong", "undecidable name"]
    assert not checked.passed
    wrong = checked.verdicts[1]
    assert (wrong.quantity, wrong.printed, wrong.right) == ("p[2]", "-a1*s1", "a1*s1")
    assert wrong.place.endswith("notes.yaml:8:35")
    assert str(checked).endswith("1 equal (1 in the same form), 1 wrong, 1 undecidable")


def test_one_formula_is_text_or_latex() -> None:
    assert check_formula("scara-perugia", "p[1]", "a1*c1 + a2*c12").outcome == "same form"
    found = check_formula(
        "planar-2r-perugia", "B[2,2]", r"I_{\ell_2} + m_{\ell_2} \ell_2^2 + k_{r2} I_{m_2}", latex=True
    )
    assert not found.equal
    assert "kr2**2 instead of kr2" in found.change
    assert "is wrong" in str(found)
    with pytest.raises(UnknownNameError, match="zz"):
        check_formula("scara-perugia", "p[1]", "zz")


def test_numbers_have_six_digits_for_people_and_all_for_programs() -> None:
    wrong = check_formula("puma560-corke", "B[6,6]", "0.2")
    assert "\n  right: 0.194105 (numbers with 6 digits)\n" in wrong.report
    assert Fraction(wrong.right) == Fraction(48_526_126_417, 250_000_000_000)
    assert wrong.change == "missing term: -0.00589549"
    assert check_formula("puma560-corke", "B[6,6]", "0.194105").outcome == "equal"
    assert check_formula("puma560-corke", "B[6,6]", "0.194106").outcome == "wrong"
    assert "digits" not in check_formula("puma560-corke", "christoffel[2,3,3]", "1").report


def test_an_inverse_solution_has_a_verdict_for_each_line_and_one_for_the_branches() -> None:
    found = check_inverse("planar-2r-perugia", "theta2 = +-acos((x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2))")
    assert [verdict.outcome for verdict in found.verdicts] == ["equal", "equal"]
    assert found.passed
    some = check_inverse(
        "planar-2r-perugia", r"\theta_2 = \arccos\frac{x^2 + y^2 - a_1^2 - a_2^2}{2 a_1 a_2}", latex=True
    )
    assert [verdict.outcome for verdict in some.verdicts] == ["right for some branches"] * 2
    assert not some.passed
    assert "missing: elbow up" in some.report

"""Printed inverse kinematics: formulas in the entries of T against the joint variables."""

from __future__ import annotations

import pytest

from derive.checking.comparison import check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.findings import Finding, Role, judge
from derive.checking.inverse.block import POSE_NAMES
from derive.errors import CheckError

ARM = """\
robot:
  name: polar
  convention: standard
  joints: [{type: revolute, alpha: -pi/2}, {type: prismatic, theta: pi, alpha: pi/2}]
inverse_kinematics:
  formulas:
"""
"""The tip stands at (-q2 sin(q1), q2 cos(q1), 0)."""


def findings(*formulas: str) -> tuple[Finding, ...]:
    text = ARM + "".join(f"    - {{{formula}}}\n" for formula in formulas)
    return check_file(corpus_from_bytes(text.encode(), "notes.yaml")).findings


@pytest.mark.parametrize(
    ("printed", "equal"),
    [
        ("atan2(-ox/q2, oy/q2)", True),
        ("atan2(oy/q2, -ox/q2)", False),
        ("atan2(-ox/q2, oy/q2) + 2*pi", True),
        ("atan2(-ox/q2, oy/q2) + pi", False),
    ],
)
def test_an_angle_is_right_up_to_full_turns(printed: str, equal: bool) -> None:
    (found,) = findings(f'unknown: q1, value: q1, printed: "{printed}", angle: true')
    assert found.role is Role.SOLUTION
    assert found.verdict.equal is equal


def test_a_wrong_formula_has_its_slip_named_and_its_correction_checked() -> None:
    wrong, correction = findings(
        'unknown: q2, value: q2**2, printed: "ox**2 - oy**2", correct: "ox**2 + oy**2", status: erratum'
    )
    assert (wrong.verdict.equal, wrong.erratum, wrong.role) == (False, True, Role.SOLUTION)
    assert (correction.verdict.equal, correction.erratum, correction.role) == (True, False, Role.CORRECTION)
    repair = judge(wrong).repair
    assert repair is not None
    assert "sign" in repair.text


def test_the_printed_plus_minus_is_the_sign_of_the_unknown() -> None:
    (found,) = findings('unknown: q2, value: q2, printed: "sgn*sqrt(ox**2 + oy**2)"')
    assert found.verdict.equal


def test_a_name_that_is_no_entry_of_the_pose_is_undecidable() -> None:
    (found,) = findings('unknown: q2, value: q2, printed: "oo + ox"')
    assert found.unknown is not None


def test_a_block_without_formulas_is_refused() -> None:
    assert len(POSE_NAMES) == 13
    with pytest.raises(CheckError, match="either 'lines', 'latex' or 'formulas'"):
        corpus_from_bytes((ARM.rsplit("  formulas", 1)[0] + "  note: none\n").encode(), "notes.yaml")

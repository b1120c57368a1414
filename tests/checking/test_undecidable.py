"""A name that the robot does not know: nothing can be said about its entry, and everything about the others."""

from __future__ import annotations

import pytest

from derive.checking.comparison import check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.findings import FileReport, Finding, Outcome, judge
from derive.errors import Location
from tests.checking.test_files import ARM

MIXED = 'expected:\n  - {quantity: "T", entries: {"1,4": "a1*c1 + b2*c12", "2,4": "a1*s1 - a2*s12", "1,1": "c12"}}\n'


def report(tail: str) -> FileReport:
    return check_file(corpus_from_bytes((ARM + tail).encode(), "notes.yaml"))


def outcomes(tail: str) -> list[Outcome]:
    return [judge(finding).outcome for finding in report(tail).findings]


def only(tail: str) -> Finding:
    (finding,) = report(tail).undecidable
    return finding


def test_one_unknown_one_wrong_and_one_right_entry_are_told_apart() -> None:
    assert outcomes(MIXED) == [Outcome.UNDECIDABLE, Outcome.WRONG, Outcome.SAME_FORM]
    found = report(MIXED)
    assert ([f.entry for f in found.wrong], [f.entry for f in found.undecidable]) == (["T[][2,4]"], ["T[][1,4]"])
    assert (found.equal, found.passed) == (1, False)


def test_a_file_without_wrong_formulas_has_not_passed_if_one_is_undecidable() -> None:
    assert not report('expected:\n  - {quantity: p, entries: {"1": "a1*c1 + foo"}}\n').passed


def test_the_unknown_name_is_placed_and_the_nearest_names_are_given() -> None:
    finding = only(MIXED)
    assert finding.location == Location("notes.yaml", 8, 47)
    assert "unknown name 'b2'" in str(finding.unknown)
    assert "did you mean" in str(finding.unknown)


@pytest.mark.parametrize("formula", ["c3", "qd3", "foo", "1/foo", "sqrt(-foo)"])
def test_labels_without_a_joint_and_names_under_functions_are_undecidable(formula: str) -> None:
    assert outcomes(f'expected:\n  - {{quantity: p, entries: {{"1": "{formula}"}}}}\n') == [Outcome.UNDECIDABLE]


def test_in_folded_text_the_place_is_its_beginning() -> None:
    tail = 'expected:\n  - quantity: p\n    entries:\n      "1": >-\n        a1*c1\n        + foo\n'
    assert only(tail).location == Location("notes.yaml", 10, 12)


def test_an_entry_printed_with_an_unknown_name_is_not_one_of_the_rest() -> None:
    found = report('expected:\n  - {quantity: p, entries: {"1": "foo", "2": "a1*s1 + a2*s12"}, rest: zero}\n')
    assert [f.entry for f in found.findings] == ["p[1]", "p[2]", "p[3]"]
    assert not found.wrong


def test_a_correction_with_an_unknown_name_leaves_the_erratum_wrong() -> None:
    tail = 'expected:\n  - {quantity: p, entries: {"1": "a1*c1"}, status: erratum, correct: {"1": "a1*c1 + foo"}}\n'
    assert outcomes(tail) == [Outcome.WRONG, Outcome.UNDECIDABLE]


def test_an_erratum_with_an_unknown_name_is_still_marked_as_one() -> None:
    assert only('expected:\n  - {quantity: p, entries: {"1": "foo"}, status: erratum}\n').erratum


def test_an_abbreviation_with_an_unknown_name_concerns_the_entries_that_use_it() -> None:
    tail = (
        'expected:\n  - {quantity: p, matrix: [["a1*c1 + a2*c12"], ["a1*s1 + a2*s12"], [0]],\n'
        '     abbreviations: {h: "a2*foo", k: "2*h", m: "a2*s12"}, abbreviated: [["a1*c1 + k"], ["a1*s1 + m"], [0]]}\n'
    )
    assert [outcome is Outcome.UNDECIDABLE for outcome in outcomes(tail)] == [False] * 3 + [True, False, False]
    assert only(tail).location == Location("notes.yaml", 9, 29)


@pytest.mark.parametrize("sides", ["left: c12, right: foo", "left: foo, right: c12"])
def test_an_identity_with_an_unknown_name_on_either_side(sides: str) -> None:
    tail = f"identities: [{{{sides}}}, {{left: c12, right: c12}}]\n"
    assert outcomes(tail)[0] is Outcome.UNDECIDABLE
    assert outcomes(tail)[1] is not Outcome.UNDECIDABLE


@pytest.mark.parametrize(("value", "printed"), [("q1 + q2", "atan2(r21, foo)"), ("foo", "atan2(r21, r11)")])
def test_inverse_kinematics_with_an_unknown_name(value: str, printed: str) -> None:
    good = '{unknown: phi, value: q1 + q2, printed: "atan2(r21, r11)", angle: true}'
    bad = f'{{unknown: phi, value: {value}, printed: "{printed}", angle: true}}'
    found = report(f"inverse_kinematics:\n  formulas:\n    - {bad}\n    - {good}\n")
    assert [f.unknown is None for f in found.findings] == [False, True]
    assert found.equal == 1

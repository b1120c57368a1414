"""Printed formulas against derived ones: every slip is found, nothing right is called wrong."""

from __future__ import annotations

import random
import re
from dataclasses import replace

import pytest

from derive.checking.comparison import check_expression, check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.findings import Finding, Role, judge
from derive.checking.formulas.printed import CorpusFile, Printed
from derive.errors import CheckError, QuantityError
from derive.lecture.shorthand import read_formula
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.checking.test_files import ARM

P = 'p, entries: {"1": "a1*c1 + a2*c12"}'


def check(tail: str) -> tuple[Finding, ...]:
    return check_file(corpus_from_bytes((ARM + tail).encode(), "notes.yaml")).findings


def outcome(tail: str) -> list[tuple[Role, str, bool]]:
    return [(finding.role, finding.entry, finding.verdict.equal) for finding in check(tail)]


def test_a_right_and_a_wrong_entry() -> None:
    found = outcome('expected:\n  - {quantity: p, entries: {"1": "a1*c1 + a2*c12", "2": "a1*s1 - a2*s12"}}\n')
    assert found == [(Role.PRINTED, "p[1]", True), (Role.PRINTED, "p[2]", False)]


def test_an_erratum_is_wrong_as_printed_and_its_correction_is_checked() -> None:
    tail = 'expected:\n  - {quantity: p, entries: {"1": "a1*c1"}, status: erratum, correct: {"1": "a1*c1 + a2*c12"}}\n'
    assert outcome(tail) == [(Role.PRINTED, "p[1]", False), (Role.CORRECTION, "p[1]", True)]
    assert outcome(tail.replace("+ a2", "- a2"))[1] == (Role.CORRECTION, "p[1]", False)


def test_the_rest_of_a_matrix_is_zero_only_where_it_is() -> None:
    tail = 'expected:\n  - {quantity: "A[1]", entries: {"1,1": c1, "2,2": c1, "3,3": 1, "4,4": 1}, rest: zero}\n'
    wrong = [entry for role, entry, right in outcome(tail) if role is Role.REST and not right]
    assert wrong == ["A[1][1,2]", "A[1][1,4]", "A[1][2,1]", "A[1][2,4]"]


def test_a_single_formula_is_an_entry_where_the_quantity_is_a_matrix() -> None:
    assert outcome('expected:\n  - {quantity: "T[1,4]", matrix: [["a1*c1 + a2*c12"]]}\n')[0][2]


def test_identities_and_products_are_compared() -> None:
    found = outcome(
        'identities: [{left: c12, right: "c1*c2 - s1*s2"}, {left: s12, right: "s1*c2 - c1*s2"}]\n'
        'factorisation: {of: T, factors: ["T[0,1]", "T[1,2]"]}\n'
    )
    assert [right for role, _, right in found if role is Role.IDENTITY] == [True, False]
    assert [right for role, _, right in found if role is Role.FACTORISATION] == [True] * 16


@pytest.mark.parametrize(
    ("item", "error", "line"),
    [
        ("{quantity: X, matrix: [[1]]}", QuantityError, 8),
        ("{quantity: B, matrix: [[1]]}", QuantityError, 8),
        ("{quantity: T, matrix: [[1, 2]]}", CheckError, 8),
        ('{quantity: p, entries: {"4": "0"}}', CheckError, 8),
        ('{quantity: p, entries: {"1,2": "0"}}', CheckError, 8),
        ('{quantity: p, entries: {"1": "1/(a1 - a1)"}}', CheckError, 8),
    ],
)
def test_what_does_not_fit_the_robot_is_refused_at_its_line(item: str, error: type, line: int) -> None:
    with pytest.raises(error) as caught:
        check(f"expected:\n  - {item}\n")
    assert caught.value.location is not None
    assert caught.value.location.line == line


def test_one_formula_without_a_file() -> None:
    model = Model(Robot.load("scara-perugia"))
    assert check_expression(model, "T[1,4]", "a1*c1 + a2*c12").verdict.equal
    wrong = check_expression(model, "T[1,4]", "c1*(a1 + a2*c2)")
    assert not wrong.verdict.equal
    assert wrong.entry == "T[1,4]"
    with pytest.raises(CheckError, match="--expression:1:4"):
        check_expression(model, "T[1,4]", "a1*x1")


SLIPS = [
    (r"\+", "-"),
    (r"-", "+"),
    (r"\bc(?=\d)", "s"),
    (r"\bs(?=\d)", "c"),
    (r"\ba1\b", "a2"),
    (r"\bc12\b", "c1"),
    (r"\*\*2", ""),
    (r"\b2\*", ""),
    (r"\bqd1\b", "qd2"),
]


def slips(printed: Printed, robot: Robot) -> list[Printed]:
    """The formula with one thing changed, as a typist or a scanner would."""
    found = []
    for pattern, instead in SLIPS:
        for match in re.finditer(pattern, printed.text):
            text = printed.text[: match.start()] + instead + printed.text[match.end() :]
            try:
                found.append(replace(printed, text=text, formula=read_formula(text, robot)))
            except CheckError:
                continue
    return found


@pytest.mark.parametrize("name", ["004-planar-2r.yaml", "004-scara-perugia.yaml", "002-puma560.yaml"])
def test_every_slip_in_a_right_formula_is_found(name: str) -> None:
    from tests.lectures.robot_results import corpus_file

    file = corpus_file(name)
    rng = random.Random(name)
    items = [item for item in file.expected if item.status == "ok"]
    changed = [
        replace(item, entries=(slip,), shape=None, abbreviated=(), rest_zero=False)
        for item in items
        for entry in item.entries
        for slip in slips(entry, file.robot)
    ]
    sample = tuple(rng.sample(changed, min(60, len(changed))))
    report = check_file(CorpusFile(name, file.robot, sample))
    assert len(report.wrong) == len(sample), [f.text for f in report.findings if f.verdict.equal]


def test_the_sign_of_a_velocity_is_a_symbol_in_a_difference() -> None:
    link = "{mass: m1, com: [0, 0, 0], inertia: {zz: J1}, friction: {coulomb: f1}}"
    text = "name: wheel\nconvention: standard\njoints: [{type: revolute, d: 0, a: 0, alpha: 0}]\ngravity: [0, 0, -g]\n"
    model = Model(Robot.from_text(f"{text}links: [{link}]\n"))
    found = check_expression(model, "tau[1]", "J1*qdd1 + 3*f1*sign(qd1)")
    assert [str(term) for term in judge(found).difference] == ["2*f1*sign(qd1)"]
    lacking = judge(check_expression(model, "tau[1]", "J1*qdd1"))
    assert lacking.repair is not None
    assert lacking.repair.text == "missing term: f1*sign(qd1)"

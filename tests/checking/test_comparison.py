"""Comparisons, styles, spots, and what cannot be decided."""

import pytest

from derive.checking.comparison import check_expression, check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.edits import float_value, is_token, spots
from derive.checking.formulas.findings import FileReport, Finding, Outcome, Role, judge
from derive.checking.style_finding import Example, StyleEvidence
from derive.errors import CheckError, Location, QuantityError
from derive.lecture.shorthand import read_formula
from derive.model.model import Model
from derive.robot.expression import Expression, Name, Sum, number
from derive.robot.options.style import Style
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.reading.size_limits import FORMULA_LIMITS
from derive.robot.robot import Robot
from tests.checking.test_files import ARM
from tests.refusals import one_message
from tests.rows import robot_of_rows


def report(tail: str) -> FileReport:
    return check_file(corpus_from_bytes((ARM + tail).encode(), "notes.yaml"))


def check(tail: str) -> tuple[Finding, ...]:
    return report(tail).findings


def outcome(tail: str) -> list[tuple[Role, str, bool]]:
    return [(finding.role, finding.entry, finding.verdict.equal) for finding in check(tail)]


def test_right_and_wrong_entries_are_told_and_of_an_erratum_the_correction_is_checked() -> None:
    found = outcome('expected:\n  - {quantity: p, entries: {"1": "a1*c1 + a2*c12", "2": "a1*s1 - a2*s12"}}\n')
    assert found == [(Role.PRINTED, "p[1]", True), (Role.PRINTED, "p[2]", False)]
    tail = 'expected:\n  - {quantity: p, entries: {"1": "a1*c1"}, status: erratum, correct: {"1": "a1*c1 + a2*c12"}}\n'
    assert outcome(tail) == [(Role.PRINTED, "p[1]", False), (Role.CORRECTION, "p[1]", True)]
    assert outcome(tail.replace("+ a2", "- a2"))[1] == (Role.CORRECTION, "p[1]", False)


def test_the_rest_of_a_matrix_is_zero_only_where_it_is_and_one_formula_may_be_an_entry() -> None:
    tail = 'expected:\n  - {quantity: "A[1]", entries: {"1,1": c1, "2,2": c1, "3,3": 1, "4,4": 1}, rest: zero}\n'
    wrong = [entry for role, entry, right in outcome(tail) if role is Role.REST and not right]
    assert wrong == ["A[1][1,2]", "A[1][1,4]", "A[1][2,1]", "A[1][2,4]"]
    assert outcome('expected:\n  - {quantity: "T[1,4]", matrix: [["a1*c1 + a2*c12"]]}\n')[0][2]


def test_identities_and_products_are_compared() -> None:
    found = outcome(
        'identities: [{left: c12, right: "c1*c2 - s1*s2"}, {left: s12, right: "s1*c2 - c1*s2"}]\n'
        'factorisation: {of: T, factors: ["T[0,1]", "T[1,2]"]}\n'
    )
    assert [right for role, _, right in found if role is Role.IDENTITY] == [True, False]
    assert [right for role, _, right in found if role is Role.FACTORISATION] == [True] * 16


@pytest.mark.parametrize(
    ("item", "error"),
    [
        ("{quantity: X, matrix: [[1]]}", QuantityError),
        ("{quantity: B, matrix: [[1]]}", QuantityError),
        ("{quantity: T, matrix: [[1, 2]]}", CheckError),
        *(
            (f"{{quantity: p, entries: {{{cell}}}}}", CheckError)
            for cell in ('"4": 0', '"1,2": 0', '"1": "1/(a1 - a1)"')
        ),
    ],
)
def test_what_does_not_fit_the_robot_is_refused_at_its_line(item: str, error: type) -> None:
    with one_message(error, r".*:8:\d+", ""):
        check(f"expected:\n  - {item}\n")


def test_the_sign_of_a_velocity_is_a_symbol_in_a_difference() -> None:
    link = "{mass: m1, com: [0, 0, 0], inertia: {zz: J1}, friction: {coulomb: f1}}"
    model = Model(robot_of_rows("R", f"gravity: [0, 0, -g]\nlinks: [{link}]"))
    found = check_expression(model, "tau[1]", "J1*qdd1 + 3*f1*sign(qd1)")
    assert [str(term) for term in judge(found).difference] == ["2*f1*sign(qd1)"]
    lacking = judge(check_expression(model, "tau[1]", "J1*qdd1"))
    assert lacking.repair.text == "missing term: f1*sign(qd1)"


LINKS = "[{mass: m1, com: [l1 - a1, 0, 0], inertia: {zz: I1}}, {mass: m2, com: [l2 - a2, 0, 0], inertia: {zz: I2}}]"
PLANAR = robot_of_rows("R a: a1 | R a: a2", f"gravity: [0, -g, 0]\nlinks: {LINKS}")
ELBOW = robot_of_rows("R alpha: pi/2 | R a: a2 | R a: a3, alpha: -pi/2 | R d: d4, alpha: pi/2")


def example(robot: Robot, quantity: str, text: str) -> Example:
    return Example(robot, quantity, read_formula(text, robot), text)


FORMS = [
    ("inertia: expanded", PLANAR, "B[1,1]", "I1 + I2 + m1*l1**2 + m2*a1**2 + m2*l2**2 + 2*m2*a1*l2*c2"),
    ("gravity: body", PLANAR, "g[1]", "m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)"),
    ("g: term", PLANAR, "g[1]", "(m1*g*l1 + m2*g*a1)*c1 + m2*g*l2*c12"),
    ("g: outside", PLANAR, "g[1]", "g*((m1*l1 + m2*a1)*c1 + m2*l2*c12)"),
    ("potential: function", PLANAR, "potential", "(m1*l1 + m2*a1)*g*s1 + m2*l2*g*s12"),
    ("velocities: symbol", PLANAR, "coriolis_vector[1]", "-m2*a1*l2*s2*(2*qd1*qd2 + qd2**2)"),
    ("velocities: factored", PLANAR, "coriolis_vector[1]", "-m2*a1*l2*s2*qd2*(2*qd1 + qd2)"),
    ("coriolis: product", PLANAR, "C[1,2]", "-m2*a1*l2*s2*qd1 - m2*a1*l2*s2*qd2"),
    (
        "kinetic: body",
        PLANAR,
        "kinetic",
        "m1*l1**2*qd1**2/2 + I1*qd1**2/2 + I2*(qd1 + qd2)**2/2"
        " + m2*(a1**2*qd1**2 + l2**2*(qd1 + qd2)**2 + 2*a1*l2*c2*qd1*(qd1 + qd2))/2",
    ),
    ("rotations: tool", ELBOW, "T[][1,1]", "c4*c1*c23 - s4*s1"),
    ("positions: expanded", ELBOW, "T[][1,4]", "a2*c1*c2 + a3*c1*c23 - d4*c1*s23"),
]


@pytest.mark.parametrize(("option", "robot", "quantity", "text"), FORMS, ids=[row[0] for row in FORMS])
def test_an_option_is_found_from_a_formula_that_it_writes(option: str, robot: Robot, quantity: str, text: str) -> None:
    evidence = StyleEvidence([example(robot, quantity, text)])
    style = evidence.best_style()
    assert evidence.reproduced(style) == 1
    assert [found.outcome for found in evidence.verdicts(style)] == [Outcome.SAME_FORM]
    assert evidence.reproduced(Style.of(option)) == 1


def test_of_two_ways_to_write_the_more_frequent_one_is_taken_and_the_other_is_explained() -> None:
    evidence = StyleEvidence(
        [
            example(PLANAR, "g[1]", "m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)"),
            example(
                PLANAR,
                "tau[1]",
                "(I1 + m1*l1**2 + I2 + m2*(a1**2 + l2**2 + 2*a1*l2*c2))*qdd1"
                " + (I2 + m2*(l2**2 + a1*l2*c2))*qdd2 - m2*a1*l2*s2*(2*qd1*qd2 + qd2**2)"
                " + m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)",
            ),
            example(PLANAR, "coriolis_vector[1]", "-2*m2*a1*l2*s2*qd1*qd2 - m2*a1*l2*s2*qd2**2"),
            example(PLANAR, "potential", "g*(m1*l1*s1 + m2*a1*s1 + m2*l2*s12)"),
            example(PLANAR, "B[2,2]", "I2 + m2*l2"),
        ]
    )
    style = evidence.best_style()
    assert style.gravity.value == "body"
    findings = list(evidence.verdicts(style))
    assert findings[-1].outcome == Outcome.WRONG
    assert findings[-1].reason == "it is not equal to the derived formula"
    assert evidence.reproduced(style) >= 2
    assert all(found.reason for found in findings if found.outcome == Outcome.EQUAL)


def test_an_equation_of_motion_gives_every_part_its_own_option() -> None:
    craig = (
        "m2*l2**2*(qdd1 + qdd2) + I1*qdd1 + I2*(qdd1 + qdd2) + m2*a1*l2*c2*(2*qdd1 + qdd2)"
        " + m1*l1**2*qdd1 + m2*a1**2*qdd1 - m2*a1*l2*s2*qd2**2 - 2*m2*a1*l2*s2*qd1*qd2"
        " + m1*g*l1*c1 + m2*g*a1*c1 + m2*g*l2*c12"
    )
    evidence = StyleEvidence([example(PLANAR, "tau[1]", craig)])
    style = evidence.best_style()
    assert evidence.reproduced(style) == 1
    assert style.accelerations.value == "term"
    assert style.velocities.value in ("product", "expanded")


def test_without_an_example_the_others_decide() -> None:
    texts = ["m2*g*l2*c12", "m1*g*l1*c1 + m2*g*(a1*c1 + l2*c12)"]
    evidence = StyleEvidence([example(PLANAR, f"g[{2 - i}]", text) for i, text in enumerate(texts)])
    assert evidence.best_style().gravity.value == "body"
    assert evidence.best_style(without=1) == Style()


MIXED = 'expected:\n  - {quantity: "T", entries: {"1,4": "a1*c1 + b2*c12", "2,4": "a1*s1 - a2*s12", "1,1": "c12"}}\n'


def outcomes(tail: str) -> list[Outcome]:
    return [judge(finding).outcome for finding in report(tail).findings]


def only(tail: str) -> Finding:
    (finding,) = report(tail).undecidable
    return finding


def test_unknown_wrong_and_right_entries_are_told_apart_and_an_unknown_name_is_placed() -> None:
    assert outcomes(MIXED) == [Outcome.UNDECIDABLE, Outcome.WRONG, Outcome.SAME_FORM]
    found = report(MIXED)
    assert ([f.entry for f in found.wrong], [f.entry for f in found.undecidable]) == (["T[][2,4]"], ["T[][1,4]"])
    assert (found.equal, found.passed) == (1, False)
    assert not report('expected:\n  - {quantity: p, entries: {"1": "a1*c1 + foo"}}\n').passed
    finding = only(MIXED)
    assert finding.location == Location("notes.yaml", 8, 47)
    assert "unknown name 'b2'" in str(finding.unknown)
    assert "did you mean" in str(finding.unknown)
    tail = 'expected:\n  - quantity: p\n    entries:\n      "1": >-\n        a1*c1\n        + foo\n'
    assert only(tail).location == Location("notes.yaml", 10, 12)


@pytest.mark.parametrize("formula", ["c3", "qd3", "foo", "1/foo", "sqrt(-foo)"])
def test_labels_without_a_joint_and_names_under_functions_are_undecidable(formula: str) -> None:
    assert outcomes(f'expected:\n  - {{quantity: p, entries: {{"1": "{formula}"}}}}\n') == [Outcome.UNDECIDABLE]


def test_an_unknown_name_is_not_one_of_the_rest_and_an_erratum_with_one_is_still_marked() -> None:
    found = report('expected:\n  - {quantity: p, entries: {"1": "foo", "2": "a1*s1 + a2*s12"}, rest: zero}\n')
    assert [f.entry for f in found.findings] == ["p[1]", "p[2]", "p[3]"]
    assert not found.wrong
    tail = 'expected:\n  - {quantity: p, entries: {"1": "a1*c1"}, status: erratum, correct: {"1": "a1*c1 + foo"}}\n'
    assert outcomes(tail) == [Outcome.WRONG, Outcome.UNDECIDABLE]
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


NUMBERS = {"a": 0.7, "b": -1.3, "c": 0.4, "q1": 0.2, "q2": 0.9, "x": 1.9}
FORMULAS = ["a*(b + c*cos(q1 + q2))**2 - 3*a", "atan2(a, b + c)/b", "sign(a - b)*sqrt(x + c)", "a", "-sin(2*q1)"]


def tree(text: str) -> Expression:
    return parse_expression(text, Location("<test>"), FORMULA_FUNCTIONS | {"sign"}, FORMULA_LIMITS)


@pytest.mark.parametrize("text", FORMULAS)
def test_value_and_formula_of_a_change_agree_and_what_stands_there_is_none(text: str) -> None:
    for spot in spots(tree(text), NUMBERS):
        assert spot.formula(spot.node) == tree(text)
        for new in (spot.node, Name("x"), number(2)):
            changed = float_value(spot.formula(new), NUMBERS)
            assert spot.value(float_value(new, NUMBERS)) == pytest.approx(changed, rel=1e-14)


def test_known_values_of_nodes_stand_for_them() -> None:
    whole = tree("a*cos(q1 + q2) + b")
    assert isinstance(whole, Sum)
    assert float_value(whole, {"b": 2.0}, {whole.terms[0]: 3.0}) == 5.0


def test_angles_of_plain_sines_and_cosines_are_no_places() -> None:
    found = [spot.node for spot in spots(tree("a*cos(q1 + q2)"), NUMBERS)]
    assert found == [tree("a*cos(q1 + q2)"), Name("a"), tree("cos(q1 + q2)")]
    assert is_token(tree("cos(q1 + q2)"))
    assert not is_token(tree("cos(q1 + 1)"))
    assert not is_token(tree("tan(q1)"))

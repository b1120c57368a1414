"""Files with expectations: frames, methods, solutions."""

import random
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import sympy

from derive.checking.comparison import check_file
from derive.checking.files import corpus_from_bytes, file_printout
from derive.checking.formulas.findings import FileReport, Finding, Role, judge
from derive.checking.formulas.printed import CorpusFile
from derive.checking.frames_file import compose, point, rotation, translation
from derive.checking.methods_file import ARMS, SETS, cases
from derive.errors import CheckError, DeriveError, ExpressionError, Location
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.refusals import one_message

ARM = """\
robot:
  name: arm
  convention: standard
  joints:
    - {type: revolute, a: a1}
    - {type: revolute, a: a2}
"""


def read(tail: str) -> CorpusFile:
    return corpus_from_bytes((ARM + tail).encode(), "notes.yaml")


def test_entries_matrices_and_corrections_are_read_with_their_places() -> None:
    file = read(
        "expected:\n"
        '  - {quantity: p, entries: {"1": "a1*c1", "2": "a1*s1"}, status: erratum, correct: {"1": "a1*c1 + a2*c12"}}\n'
        '  - {quantity: "A[1]", matrix: [["c1", 0], [0, 1]]}\n'
    )
    first, second = file.expected
    assert [(e.row, e.column, e.text) for e in first.entries] == [(1, 1, "a1*c1"), (2, 1, "a1*s1")]
    assert first.entries[0].location == Location("notes.yaml", 8, 35)
    assert (first.status, first.corrections[0].text) == ("erratum", "a1*c1 + a2*c12")
    assert second.shape == (2, 2)
    assert second.status == "ok"


@pytest.mark.parametrize(
    ("tail", "line", "message"),
    [
        ('expected:\n  - {quantity: p, entries: {"1": "a1*"}}\n', 8, "ends too early"),
        ('expected:\n  - {quantity: p, entries: {"0,1": "0"}}\n', 8, "place '0,1'"),
        ('expected:\n  - {quantity: p, entries: {"1": "0", "1,1": "0"}}\n', 8, "place '1,1' twice"),
        ('expected:\n  - {quantity: p, entries: {x: "0"}}\n', 8, "place 'x'"),
        ("expected:\n  - {quantity: p}\n", 8, "either 'matrix' or 'entries'"),
        ("expected:\n  - {quantity: p, matrix: [[1, 2], [3]]}\n", 8, "rows differ in length"),
        ("expected:\n  - {quantity: p, matrix: []}\n", 8, "rows differ in length or are empty"),
        ("expected:\n  - {quantity: p, matrix: [[1]], statsu: ok}\n", 8, "did you mean 'status'"),
        ("expected:\n  - {quantity: p, matrix: [[1]], status: fine}\n", 8, "allowed: ok, erratum"),
        ("expected:\n  - {matrix: [[1]]}\n", 8, "without 'quantity'"),
        ("expected: 5\n", 7, "expected is not a list"),
        ("expected: [5]\n", 7, "an item of expected is not a mapping"),
        ("expected:\n  - {quantity: p, matrix: [[1]], status: [ok]}\n", 8, "status is not a single text"),
        ("expectd: []\n", 7, "did you mean 'expected'"),
        ('expected:\n  - {quantity: p, entries: {"1": 1}, correct: {"2": 1}}\n', 8, "not among the printed entries"),
        ("expected:\n  - {quantity: p, matrix: [[1]], abbreviations: {a1: 2}, abbreviated: [[1]]}\n", 8, "also a name"),
        ("identities: [{left: c1}]\n", 7, "without 'right'"),
        ("factorisation: {of: T, factors: []}\n", 7, "without factors"),
    ],
)
def test_what_cannot_be_read_is_refused_at_its_line(tail: str, line: int, message: str) -> None:
    with one_message(DeriveError, rf"notes.yaml:{line}:\d+", message):
        read(tail)


def test_a_formula_in_folded_text_is_placed_at_its_beginning_and_a_robot_file_alone_prints_nothing() -> None:
    with one_message(DeriveError, "notes.yaml:10:12", "ends too early"):
        read('expected:\n  - quantity: p\n    entries:\n      "1": >-\n        a1*c1\n        +\n')
    with pytest.raises(DeriveError, match="no block 'robot:'"):
        corpus_from_bytes(b"name: arm\nconvention: standard\njoints: [{type: revolute}]\n", "arm.yaml")
    assert read("expected: []\nsingularities: [{of: J}]\n").unread == ("singularities",)


FRAMES = """\
items:
  - id: turn
    factors: ["Trans(l1, 0, 0)", "Rot(z, alpha)"]
    matrix:
      - [cos(alpha), -sin(alpha), 0, l1]
      - [sin(alpha), cos(alpha), 0, 0]
      - [0, 0, 1, 0]
      - [0, 0, 0, 1]
  - id: end
    factors: ["Ref(turn)", "Vec(l2, 0, 0)"]
    matrix: [["l1 + l2*cos(alpha)"], ["l2*sin(alpha)"], [0], [1]]
"""
EQUATION = "newton_euler_base:\n  - {id: x, joint: %s, result: %s, printed: '%s', status: ok}\n"


def check(folder: Path, text: str) -> FileReport:
    path = folder / "file.yaml"
    path.write_text(text)
    return file_printout(path).report


def test_products_of_frames_are_compared_entry_by_entry_and_a_slip_is_repaired(tmp_path: Path) -> None:
    report = check(tmp_path, FRAMES)
    assert report.passed
    assert len(report.findings) == 20
    (wrong,) = check(tmp_path, FRAMES.replace('["l2*sin(alpha)"]', '["-l2*sin(alpha)"]')).wrong
    repair = judge(wrong).repair
    assert wrong.entry == "end[2,1]"
    assert repair.text == "sign: l2*sin(alpha) instead of -l2*sin(alpha)"


@pytest.mark.parametrize(
    ("found", "instead", "message"),
    [
        ("Trans(l1, 0, 0)", "Move(l1)", "factor 'Move"),
        ("Trans(l1, 0, 0)", "Trans(l1, 0)", "take 3"),
        ("Rot(z, alpha)", "Rot(w, alpha)", "axis 'w'"),
        ("Rot(z, alpha)", "Rot(z)", "Rot with 1"),
        ("Ref(turn)", "Ref(later)", "earlier item"),
        ("Rot(z, alpha)", "Rot(z, __import__)", "unexpected character"),
        ('["l2*sin(alpha)"], ', "", "another shape"),
    ],
)
def test_frames_that_cannot_be_read_are_refused(tmp_path: Path, found: str, instead: str, message: str) -> None:
    assert found in FRAMES
    with one_message(DeriveError, r".*file\.yaml:\d+:\d+", message):
        check(tmp_path, FRAMES.replace(found, instead))


@pytest.mark.parametrize(
    ("joint", "result", "printed", "right"),
    [
        ("revolute", "w", "w_prev + z_prev*qd", True),
        ("prismatic", "w", "w_prev + z_prev*qd", False),
        ("any", "F", "m*a", True),
        ("any", "N", "I @ wd + cross(w, I @ w)", True),
        ("any", "N", "I @ wd - cross(w, I @ w)", False),
        ("revolute", "tau", "n @ z_prev + b*qd", True),
        ("any", "F", "m @ a", False),
    ],
)
def test_equations_hold_for_every_link_or_are_wrong(
    tmp_path: Path, joint: str, result: str, printed: str, right: bool
) -> None:
    assert check(tmp_path, EQUATION % (joint, result, printed)).passed is right


@pytest.mark.parametrize(
    ("printed", "text"),
    [
        ("I @ wd - cross(w, I @ w)", "sign of -cross(w, I @ w)"),
        ("I @ wd + cross(wd, I @ w)", "index: w instead of wd"),
        ("I @ w + cross(wd, I @ w)", "2 changes: index: wd instead of w; index: w instead of wd"),
        ("I @ wd + cross(p, I @ w)", "symbol: w instead of p"),
        ("I @ wd + (w + I @ w)", "operation: cross(w, I @ w) instead of w + I @ w"),
    ],
)
def test_the_change_that_repairs_an_equation_is_named(tmp_path: Path, printed: str, text: str) -> None:
    (wrong,) = check(tmp_path, EQUATION % ("any", "N", printed)).wrong
    assert wrong.repair.text == text


@pytest.mark.parametrize(
    ("printed", "message"),
    [
        ("m*acc", "unknown name 'acc'"),
        ("m*", "vector equation"),
        ("__import__(w)", "vector equation"),
        ("(" * 300 + "w", "vector equation"),
        ("+".join(["w"] * 300), "too long"),
    ],
)
def test_equations_that_cannot_be_read_are_refused(tmp_path: Path, printed: str, message: str) -> None:
    with one_message(CheckError, r".*:2:\d+", message):
        check(tmp_path, EQUATION % ("any", "F", printed))


ALPHA, BETA, X, Y, Z = sympy.symbols("alpha beta x y z")


@pytest.mark.parametrize(("axis", "start", "end"), [("x", "y", "z"), ("y", "z", "x"), ("z", "x", "y")])
def test_a_quarter_turn_takes_one_axis_to_the_next(axis: str, start: str, end: str) -> None:
    unit = {name: point(*(int(other == name) for other in "xyz")) for name in "xyz"}
    quarter = rotation(axis, sympy.pi / 2)
    assert compose(quarter, unit[start]) == unit[end]
    assert compose(quarter, unit[axis]) == unit[axis]


@pytest.mark.parametrize("axis", "xyz")
def test_turns_about_one_axis_add_up_and_opposite_ones_cancel(axis: str) -> None:
    together = compose(rotation(axis, ALPHA), rotation(axis, BETA))
    assert together == sympy.expand_trig(rotation(axis, ALPHA + BETA))
    assert compose(rotation(axis, ALPHA), rotation(axis, -ALPHA)) == sympy.eye(4)
    assert compose(rotation(axis, 0.3), rotation(axis, Fraction(-3, 10))) == sympy.eye(4)


def test_the_product_is_that_of_matrices_and_translations_commute() -> None:
    rng = random.Random(5)
    frames = []
    for _ in range(5):
        frames.append(rotation(rng.choice("xyz"), sympy.Rational(rng.randint(-30, 30), 10)))
        frames.append(translation(*(rng.randint(-9, 9) for _ in range(3))))
    expected = sympy.eye(4)
    for frame in frames:
        expected = expected * frame
    assert sympy.Matrix(compose(*frames) - expected).evalf(30).norm() < 1e-25
    together = compose(translation(X, Y, Z), translation(1, 2, 3))
    assert together == translation(X + 1, Y + 2, Z + 3) == compose(translation(1, 2, 3), translation(X, Y, Z))


def test_a_row_of_a_table_is_four_elementary_frames_and_special_angles_are_exact() -> None:
    model = Model(Robot.load("dh-classical-deluca"))
    theta, d, a, alpha = sympy.symbols("q1 d1 a1 alpha1")
    row = compose(rotation("z", theta), translation(0, 0, d), translation(a, 0, 0), rotation("x", alpha))
    assert row == model.A(1)
    half = sympy.Rational(1, 2)
    assert rotation("z", sympy.pi / 6)[1, 0] == half
    assert compose(rotation("z", sympy.pi / 4), rotation("z", sympy.pi / 4)) == rotation("z", sympy.pi / 2)


def test_what_is_no_frame_is_refused() -> None:
    with pytest.raises(ExpressionError, match="axis 'w'"):
        rotation("w", 0)
    for value in ("alpha", object(), None, sympy.eye(2)):
        with pytest.raises(ExpressionError):
            rotation("z", value)
    for frames in ((), (sympy.eye(3),), (point(0, 0, 0), sympy.eye(4))):
        with pytest.raises(ExpressionError, match="frames of shapes"):
            compose(*frames)


@pytest.mark.parametrize("name", list(SETS))
def test_newton_and_euler_hold_at_every_link_of_every_arm_among_rotations_and_unit_axes(name: str) -> None:
    joints = "".join(joint[0] for joint, _ in cases(name))
    assert joints == "".join(types for types, _ in ARMS)
    for _, values in cases(name):
        for name_of_rotation in ("Rp", "Rn", "R0"):
            assert np.allclose(values[name_of_rotation] @ values[name_of_rotation].T, np.eye(3))
        assert np.linalg.norm(values["z_prev"]) == pytest.approx(1)
        w, inertia = values["w"], values["I"]
        assert np.allclose(values["F"], values["m"] * values["a"], rtol=0, atol=1e-12)
        assert np.allclose(values["N"], inertia @ values["wd"] + np.cross(w, inertia @ w), rtol=0, atol=1e-12)


SOLVED = """\
robot:
  name: polar
  convention: standard
  joints: [{type: revolute, alpha: -pi/2}, {type: prismatic, theta: pi, alpha: pi/2}]
inverse_kinematics:
  formulas:
"""
"""The tip stands at (-q2 sin(q1), q2 cos(q1), 0)."""


def findings(*formulas: str) -> tuple[Finding, ...]:
    text = SOLVED + "".join(f"    - {{{formula}}}\n" for formula in formulas)
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
    assert "sign" in repair.text


def test_a_printed_plus_minus_is_the_sign_of_the_unknown_and_a_name_that_is_no_entry_undecidable() -> None:
    (found,) = findings('unknown: q2, value: q2, printed: "sgn*sqrt(ox**2 + oy**2)"')
    assert found.verdict.equal
    (found,) = findings('unknown: q2, value: q2, printed: "oo + ox"')
    assert found.unknown is not None

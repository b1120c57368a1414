"""Tokens of lecture notes: what they stand for, and which are refused."""

import random
from contextlib import nullcontext

import pytest

from derive.errors import CheckError, Location
from derive.lecture.shorthand import read_formula, resolve_tokens
from derive.robot.expression import Call, Expression, Name, to_text
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from tests.refusals import one_message
from tests.rows import robot_of_rows


def revolute(*names: str, tail: str = "") -> Robot:
    return robot_of_rows("|".join(f"R q: {name}" for name in names), tail)


WRIST = revolute("q4", "q5", "q6")
SCARA = Robot.load("scara-perugia")


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("c1", "cos(q1)"), ("s12", "sin(q1 + q2)"), ("c124", "cos(q1 + q2 + q4)"), ("c42", "cos(q4 + q2)"),
        ("-2*a1*s1**2", "-2*a1*sin(q1)**2"), ("q3*qd1 + qdd2", "q3*qd1 + qdd2"),
        ("atan2(s1, c1)", "atan2(sin(q1), cos(q1))"), ("sin(q1/2)", "sin(q1/2)"), ("sign(qd1)", "sign(qd1)"),
        ("ml1*l1", "ml1*l1"),
    ],
)  # fmt: skip
def test_a_formula_of_the_scara_means(text: str, meaning: str) -> None:
    assert to_text(read_formula(text, SCARA)) == meaning


def test_labels_are_the_digits_of_the_variables_or_count_them_from_the_first() -> None:
    assert read_formula("c4", WRIST) == Call("cos", (Name("q4"),))
    with pytest.raises(CheckError, match="c1: its digits are no labels"):
        read_formula("c1", WRIST)
    arm = revolute("q1", "q2", "q12")
    assert to_text(read_formula("c12", arm)) == "cos(q12)"
    thumb = Robot.load("thumb")
    assert to_text(read_formula("c5051", thumb)) == "cos(q50 + q51)"
    leg = revolute("q_hip", "q_knee", "q_foot")
    assert to_text(read_formula("c1 + s23", leg)) == "cos(q_hip) + sin(q_knee + q_foot)"
    with pytest.raises(CheckError, match="c1: its digits are no labels"):
        read_formula("c1", revolute("q_hip", "q2"))


def test_two_ways_to_read_a_token_are_both_named() -> None:
    arm = revolute("q1", "q2", "q3", "q12", "q23")
    with pytest.raises(CheckError, match=r"c123 can be read in two ways, cos\(.*\) or cos\(.*\)"):
        read_formula("c123", arm)
    arm = revolute("a1", "b1")
    with pytest.raises(CheckError, match=r"cos\(a1\) or cos\(b1\)"):
        read_formula("c1", arm)
    with pytest.raises(CheckError, match="qd1 can be read in two ways, ad1 or bd1"):
        read_formula("qd1", arm)


def test_names_of_the_robot_win_over_tokens_which_slides_and_repeated_labels_have_not() -> None:
    arm = robot_of_rows("R a: c1 | R a: s12")
    assert read_formula("c1", arm) == Name("c1")
    assert read_formula("s12", arm) == Name("s12")
    assert to_text(read_formula("c12", arm)) == "cos(q1 + q2)"
    with pytest.raises(CheckError, match="c3: joint 3 is prismatic; its variable is q3"):
        read_formula("c3", SCARA)
    with pytest.raises(CheckError):
        read_formula("c11", SCARA)


def test_rates_of_any_joint_are_known_by_label_and_by_name() -> None:
    arm = revolute("theta1", "theta2")
    for text in ("qd1", "thetad1"):
        assert read_formula(text, arm) == Name("thetad1")
    for text in ("qdd2", "thetadd2"):
        assert read_formula(text, arm) == Name("thetadd2")


def test_abbreviations_stand_for_their_formulas_and_cannot_make_one_explode() -> None:
    h = read_formula("-ml2*a1*l2*s2", SCARA)
    assert to_text(read_formula("h*qd2", SCARA, abbreviations={"h": h})) == "-ml2*a1*l2*sin(q2)*qd2"
    with pytest.raises(CheckError, match="abbreviation 'a1' is also a name of the robot"):
        read_formula("a1", SCARA, abbreviations={"a1": h})
    short: dict[str, Expression] = {"h": read_formula("a1 + a2 + l1 + l2 + c1 + c2", SCARA)}
    for name in ("u", "v"):
        short[name] = read_formula("h**12", SCARA, abbreviations=short)
    with pytest.raises(CheckError, match="too many terms"):
        read_formula("u*v", SCARA, abbreviations=short)


@pytest.mark.parametrize(
    ("text", "column", "hint"),
    [
        ("a1*c1 + a2*c13", 12, "did you mean c1"),
        ("a1*cl", 4, "did you mean c1"),
        ("ml1 + m12", 7, "ml"),
        ("a1**", 5, "ends too early"),
        ("__import__", 1, "unexpected character"),
        ("foo(1)", 1, "foo"),
    ],
)
def test_what_cannot_be_read_is_refused_at_its_column(text: str, column: int, hint: str) -> None:
    with one_message(CheckError, f"notes.yaml:7:{10 + column}", hint):
        read_formula(text, SCARA, Location("notes.yaml", 7, 11))


def test_an_expression_tree_is_resolved_too() -> None:
    tree = parse_expression("a1*c1 + a2*c12", Location("cell"))
    assert to_text(resolve_tokens(tree, SCARA)) == "a1*cos(q1) + a2*cos(q1 + q2)"
    with pytest.raises(CheckError, match="unknown name 'zz'"):
        resolve_tokens(Name("zz"), SCARA)


def test_tokens_of_many_overlapping_labels_are_decided_quickly() -> None:
    arm = revolute(*(f"q{'1' * k}" for k in range(1, 11)))
    rng = random.Random(3)
    for length in range(1, 40):
        token = "c" + "1" * length + ("2" if length > 10 and rng.random() < 0.5 else "")
        with pytest.raises(CheckError) if length > 10 else nullcontext():
            read_formula(token, arm)

"""Printed solutions as text: lines, alternatives, plus-minus signs, the names of arc functions, places of errors."""

from __future__ import annotations

import pytest

from derive.api.robots import load
from derive.checking.inverse.text import text_equations
from derive.checking.latex.names import PlusMinus
from derive.errors import CheckError, Location
from derive.robot.expression import Expression, to_text


def sides(text: str) -> list[list[str]]:
    robot = load("planar-2r-perugia")
    equations, _ = text_equations(text, robot, Location("notes"), PlusMinus())
    return [[part.text for part in side.parts] for equation in equations for side in equation]


def formula(text: str) -> Expression:
    robot = load("planar-2r-perugia")
    ((_, side),), _ = text_equations(f"theta1 = {text}", robot, Location("notes"), PlusMinus())
    return side.parts[0].read({})


def test_lines_end_at_line_breaks_semicolons_and_commas_before_the_next_name() -> None:
    text = "where D = a1, q2 = atan2(D, a1) or -q2\nq1 = 1; c2 = 0\n\n"
    assert sides(text) == [["D"], ["a1"], ["q2"], ["atan2(D, a1)", "-q2"], ["q1"], ["1"], ["c2"], ["0"]]


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("+-sqrt(a1)", "±1*sqrt(a1)"),
        ("a1 ± a2*a1", "a1 + ±1*a2*a1"),
        ("a1 -+ a2", "a1 - ±1*a2"),
        ("a1 +/- a2", "a1 + ±1*a2"),
        ("arctan2(a1, a2)", "atan2(a1, a2)"),
        ("Atan2(a1, a2)", "Atan2(a1, a2)"),
        ("A tan(a1, a2)", "Atan2(a1, a2)"),
        ("atan(a1, a2)", "Atan2(a1, a2)"),
        ("arctan((a1 + a2)/a2)", "atan((a1 + a2)/a2)"),
        ("ArcCos(a1)", "acos(a1)"),
        ("asin(a1)", "asin(a1)"),
        ("a1 + 180°", "a1 + pi"),
    ],
)
def test_what_the_grammar_does_not_have_is_rewritten(text: str, read: str) -> None:
    assert to_text(formula(text)) == read


@pytest.mark.parametrize(
    ("text", "place"),
    [("+-sqrt(a1) + zz", "notes:1:23"), ("arctan2(a1, a2) $", "notes:1:26"), ("a1 +- (a2", "notes:1:16")],
)
def test_places_are_those_of_the_text_as_it_was_typed(text: str, place: str) -> None:
    with pytest.raises(CheckError) as caught:
        formula(text)
    assert str(caught.value).startswith(f"{place}: ")


def test_a_line_without_an_equals_sign_is_refused_at_its_place() -> None:
    with pytest.raises(CheckError, match="notes:2:3: line that is no equation"):
        sides("q1 = 1\n  atan2(a1, a2)")

"""Formulas with divisions: equality by cross-multiplication, and when a difference is a proof."""

from __future__ import annotations

import pytest

from derive.algebra.quotients import MAX_DENOMINATORS, QuotientRing
from derive.algebra.ring import TooManyTerms
from derive.errors import CheckError, Location
from derive.robot.expression import Expression
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.reading.size_limits import FORMULA_LIMITS
from derive.robot.robot import Robot

HERE = Location("<test>")
ARM = Robot.from_text("name: arm\nconvention: standard\njoints: [{type: revolute, a: a1}, {type: revolute, a: a2}]\n")


def tree(text: str) -> Expression:
    return parse_expression(text, HERE, functions=FORMULA_FUNCTIONS | {"sign"}, limits=FORMULA_LIMITS)


def equal(left: str, right: str) -> bool:
    formulas = tree(left), tree(right)
    return not QuotientRing(ARM, formulas).difference(*formulas)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("tan(q1)", "sin(q1)/cos(q1)"),
        ("tan(q1/2)", "sin(q1)/(1 + cos(q1))"),
        ("1/(1 + 1/a1)", "a1/(a1 + 1)"),
        ("1/a1 + 1/a2", "(a1 + a2)/(a1*a2)"),
        ("(1 - cos(q1)**2)/sin(q1)", "sin(q1)"),
        ("sqrt(a1)**2/a2", "a1/a2"),
        ("sign(a1)*atan2(a1, a2) + 1/a2", "atan2(a1, a2)*sign(a1) + a2**-1"),
    ],
)
def test_equal_formulas_differ_by_zero(left: str, right: str) -> None:
    assert equal(left, right)


@pytest.mark.parametrize(("left", "right"), [("tan(q1)", "tan(q2)"), ("1/a1", "a1"), ("sign(a1)", "sin(a1)")])
def test_other_formulas_do_not(left: str, right: str) -> None:
    assert not equal(left, right)


def test_a_division_by_what_is_zero_everywhere_is_refused() -> None:
    with pytest.raises(CheckError, match="zero everywhere"):
        equal("1/(sin(q1)**2 + cos(q1)**2 - 1)", "0")


@pytest.mark.parametrize(("text", "faithful"), [("a1*sin(q1)/a2", True), ("sqrt(a1)", False), ("sign(a1)", False)])
def test_only_plain_formulas_are_told_apart_for_certain(text: str, faithful: bool) -> None:
    assert QuotientRing(ARM, [tree(text)]).faithful is faithful


def test_many_denominators_are_too_many() -> None:
    with pytest.raises(TooManyTerms):
        QuotientRing(ARM, [tree(" + ".join(f"1/b{i}" for i in range(MAX_DENOMINATORS + 1)))])

"""Places in a formula: what the whole is worth, and what it says, with something else at one of them."""

from __future__ import annotations

import pytest

from derive.checking.formulas.edits import float_value, is_token, spots
from derive.errors import Location
from derive.robot.expression import Expression, Name, number
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.reading.size_limits import FORMULA_LIMITS

NUMBERS = {"a": 0.7, "b": -1.3, "c": 0.4, "q1": 0.2, "q2": 0.9, "x": 1.9}
FORMULAS = ["a*(b + c*cos(q1 + q2))**2 - 3*a", "atan2(a, b + c)/b", "sign(a - b)*sqrt(x + c)", "a", "-sin(2*q1)"]


def tree(text: str) -> Expression:
    return parse_expression(text, Location("<test>"), FORMULA_FUNCTIONS | {"sign"}, FORMULA_LIMITS)


@pytest.mark.parametrize("text", FORMULAS)
def test_what_stands_there_gives_the_formula_itself(text: str) -> None:
    whole = tree(text)
    for spot in spots(whole, NUMBERS):
        assert spot.formula(spot.node) == whole
        assert spot.value(float_value(spot.node, NUMBERS)) == float_value(whole, NUMBERS)


@pytest.mark.parametrize("text", FORMULAS)
@pytest.mark.parametrize("new", [Name("x"), number(2)])
def test_value_and_formula_of_a_change_agree(text: str, new: Expression) -> None:
    for spot in spots(tree(text), NUMBERS):
        changed = float_value(spot.formula(new), NUMBERS)
        assert spot.value(float_value(new, NUMBERS)) == pytest.approx(changed, rel=1e-14)


def test_angles_of_plain_sines_and_cosines_are_no_places() -> None:
    found = [spot.node for spot in spots(tree("a*cos(q1 + q2)"))]
    assert found == [tree("a*cos(q1 + q2)"), Name("a"), tree("cos(q1 + q2)")]
    assert is_token(tree("cos(q1 + q2)"))
    assert not is_token(tree("cos(q1 + 1)"))
    assert not is_token(tree("tan(q1)"))

"""Whatever stands in a formula, it is compared or refused in words; nothing else happens, and it does not take long."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from derive.errors import CheckError, DeriveError
from derive.lecture.shorthand import read_formula
from derive.model.equality import verdict
from derive.model.model import Model
from derive.robot.robot import Robot

SCARA = Model(Robot.load("scara-perugia"))
ATOMS = ("a1", "c1", "s12", "q1", "q3", "qd2", "pi", "2", "0", "1/3", "0.1", "c4", "foo", "c3", "d4")
FUNCTIONS = ("sin", "cos", "tan", "sqrt", "sign")


def outcome(action: Callable[[], Any]) -> Any:
    """What an action returns, or the error of ours that it raises; any other error is a failure."""
    try:
        return action()
    except DeriveError as error:
        return error


def formulas() -> st.SearchStrategy[str]:
    """Formulas of the grammar, most of them without sense."""

    def bigger(part: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
        pair = st.tuples(part, st.sampled_from("+-*/"), part).map(lambda t: f"({t[0]} {t[1]} {t[2]})")
        call = st.tuples(st.sampled_from(FUNCTIONS), part).map(lambda t: f"{t[0]}({t[1]})")
        power = st.tuples(part, st.integers(-3, 5)).map(lambda t: f"({t[0]})**({t[1]})")
        turn = st.tuples(part, part).map(lambda t: f"atan2({t[0]}, {t[1]})")
        return st.one_of(pair, call, power, turn)

    return st.recursive(st.sampled_from(ATOMS), bigger, max_leaves=8)


@settings(max_examples=120, deadline=20_000, derandomize=True)
@given(formula=formulas())
def test_any_formula_is_compared_or_refused(formula: str) -> None:
    found = outcome(lambda: verdict(SCARA, "T[1,4]", formula))
    if isinstance(found, DeriveError):
        assert "\n" not in str(found)
    else:
        assert found.equal is (found.counter_example is None) or found.exact


@settings(max_examples=150, deadline=20_000, derandomize=True)
@given(formula=formulas())
def test_any_formula_equals_itself(formula: str) -> None:
    found = outcome(lambda: verdict(SCARA, "T[1,4]", f"a1*c1 + a2*c12 + ({formula}) - ({formula})"))
    assert isinstance(found, CheckError) or found.equal


@settings(max_examples=150, deadline=10_000, derandomize=True)
@given(text=st.text(max_size=60))
def test_any_text_is_read_or_refused_with_its_place(text: str) -> None:
    found = outcome(lambda: read_formula(text, SCARA.robot))
    assert not isinstance(found, DeriveError) or found.location is not None


LONG = {
    "many denominators": " + ".join(f"1/(a1 + {k})" for k in range(1, 3000)),
    "powers of sums": "(a1 + a2 + c1 + s1 + q3 + d4)**8*(a1 - s12 + q3)**3",
    "large multiples of angles": "cos(" + " + ".join(f"{k}*q1 + {k}*q2" for k in range(1, 7)) + ")**8",
    "nested roots": "sqrt(" * 30 + "a1" + ")" * 30,
    "nested sines": "sin(" * 30 + "q1" + ")" * 30,
    "a fine fraction of an angle": "cos(q1/1000003)",
    "a huge multiple of an angle": "cos(1000003*q1)",
    "many terms": " - ".join(["a1*c1"] * 5_000),
}
TOO_LONG = {
    "a long token": "c" + "1" * 60,
    "many brackets": "(" * 500 + "a1" + ")" * 500,
    "a tower of powers": "2**32**32",
    "too many terms": "*".join(["(a1 + a2 + c1 + s1 + q3 + d4)**8"] * 3),
}


@pytest.mark.parametrize("name", LONG)
def test_a_formula_made_to_take_long_is_compared_in_time(name: str) -> None:
    start = time.process_time()
    assert not verdict(SCARA, "T[1,4]", LONG[name]).equal
    assert time.process_time() - start < 10


@pytest.mark.parametrize("name", TOO_LONG)
def test_a_formula_beyond_the_limits_is_refused_in_time(name: str) -> None:
    start = time.process_time()
    with pytest.raises(CheckError):
        verdict(SCARA, "T[1,4]", TOO_LONG[name])
    assert time.process_time() - start < 10

"""Plain text says what the expression says, in the shorthand where it can be read one way."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sympy import Integer, Rational, cos, pi, sin, sqrt, symbols

from derive.handouts.notation.notation import Notation
from derive.handouts.notation.text import TextPrinter, loses_digits
from derive.robot.robot import Robot

ROBOT = Robot.load("scara-perugia")
Q = symbols("q1 q2 q4")
A = symbols("a1 a2 ml1")
VALUES = {str(symbol): 0.3 + 0.37 * index for index, symbol in enumerate((*Q, *A, *symbols("q3 g")))}


def tokens() -> dict[str, float]:
    found = {}
    for chosen in ("1", "2", "4", "12", "14", "24", "124"):
        angle = sum(VALUES[f"q{label}"] for label in chosen)
        found |= {f"c{chosen}": math.cos(angle), f"s{chosen}": math.sin(angle)}
    return found


NAMES = {**VALUES, **tokens(), "cos": math.cos, "sin": math.sin, "sqrt": math.sqrt, "pi": math.pi}


def angles() -> st.SearchStrategy[Any]:
    signs = st.sampled_from([1, 1, 1, -1])
    return st.lists(st.tuples(signs, st.sampled_from(Q)), min_size=1, max_size=3, unique_by=lambda pair: pair[1]).map(
        lambda terms: sum(sign * symbol for sign, symbol in terms)
    )


def expressions() -> st.SearchStrategy[Any]:
    leaves = st.one_of(
        st.sampled_from(A),
        st.fractions(min_value=-3, max_value=3, max_denominator=7).map(lambda f: Rational(f.numerator, f.denominator)),
        angles().map(cos),
        angles().map(sin),
        st.sampled_from(A).map(sqrt),
        st.sampled_from(A).map(lambda symbol: 1 / symbol),
    )
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.tuples(inner, inner).map(lambda pair: pair[0] + pair[1]),
            st.tuples(inner, inner).map(lambda pair: pair[0] * pair[1]),
            inner.map(lambda e: -e),
            inner.map(lambda e: e**2),
        ),
        max_leaves=12,
    )


@given(expressions())
def test_printed_text_has_the_value_of_the_expression(expression: Any) -> None:
    printed = TextPrinter(ROBOT).doprint(expression)
    expected = float(expression.subs({symbol: VALUES[str(symbol)] for symbol in (*Q, *A)}))
    assert eval(printed, {"__builtins__": {}}, NAMES) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("expression", "printed"),
    [
        (A[0] * cos(Q[0]) + A[1] * cos(Q[0] + Q[1]), "a1*c1 + a2*c12"),
        (sin(Q[0] + Q[1]) * cos(Q[2]) - cos(Q[0] + Q[1]) * sin(Q[2]), "-c12*s4 + s12*c4"),
        (cos(Q[0] - Q[1]), "cos(q1 - q2)"),
        (-A[0] / 2, "-a1/2"),
        (1 / A[0], "1/a1"),
    ],
)
def test_order_and_shorthand_are_those_of_the_notes(expression: Any, printed: str) -> None:
    assert TextPrinter(ROBOT).doprint(expression) == printed


def robot_with(row: str, count: int) -> Robot:
    rows = "".join(f"  - {row.format(i=i)}\n" for i in range(1, count + 1))
    return Robot.from_text(f"name: arm\nconvention: standard\njoints:\n{rows}")


@pytest.mark.parametrize(
    "robot",
    [
        robot_with("{{type: revolute, a: c1}}", 2),
        robot_with("{{type: revolute, a: a{i}}}", 12),
        robot_with("{{type: revolute, q: theta{i}_1, a: a{i}}}", 2),
    ],
    ids=["a parameter looks like a token", "labels of two digits", "labels that occur twice"],
)
def test_ambiguous_shorthand_is_spelled_out(robot: Robot) -> None:
    variable = symbols(robot.joints[0].variable)
    assert TextPrinter(robot).doprint(cos(variable)) == f"cos({variable})"


PUMA = Robot.load("puma560-corke")


@pytest.mark.parametrize(
    ("expression", "printed"),
    [
        (Rational(1129213793321, 500000000000) + Rational(243, 12500) * A[0], "2.25843 + 0.01944*a1"),
        (-A[0] * cos(Q[0]) / 2 + Rational(7, 3) * A[1], "7*a2/3 - a1*c1/2"),
        (cos(Q[0] + Rational(3, 20) * pi) * Rational(5, 4) / A[0], "1.25*cos(q1 + 3*pi/20)/a1"),
        (Rational(1, 3 * 10**9) * A[0] ** 2, "3.33333e-10*a1**2"),
        (A[0] + Integer(10) ** 7, "1e7 + a1"),
    ],
)
def test_digits_round_what_is_long_and_leave_what_is_short(expression: Any, printed: str) -> None:
    assert TextPrinter(PUMA, Notation.of(PUMA)).doprint(expression) == printed
    values = {symbol: VALUES[str(symbol)] for symbol in (*Q, *A)}
    names = {**NAMES, "c1": math.cos(VALUES["q1"])}
    value = eval(TextPrinter(PUMA, Notation.of(PUMA)).doprint(expression), {"__builtins__": {}}, names)
    assert value == pytest.approx(float(expression.subs(values)), rel=1e-5)


def test_loss_of_digits_is_noticed() -> None:
    short, long = Rational(4318, 10000) * A[0], Rational(1234567, 10**6) * A[0]
    assert not loses_digits([short], decimals=True, digits=6)
    assert loses_digits([short, A[1] + cos(long)], decimals=True, digits=6)
    assert loses_digits([short], decimals=True, digits=3)

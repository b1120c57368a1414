"""Equality of printed and derived formulas: exact where algebra decides, honest where it does not, always in time."""

import random
import time
from collections.abc import Callable
from typing import Any

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from derive.algebra.quotients import QuotientRing
from derive.errors import CheckError, DeriveError, QuantityError
from derive.lecture.shorthand import read_formula
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import Verdict, compare, scalar_quantity, verdict
from derive.model.model import Model
from derive.robot.expression import Call, Power
from derive.robot.robot import Robot
from tests.rows import robot_of_rows

SCARA = Model(Robot.load("scara-perugia"))
PLANAR = Model(Robot.load("planar-2r-perugia"))
ELBOW = Model(Robot.load("anthropomorphic-arm"))
X = "a1*c1 + a2*c12"


SAME = [
    X,
    "a2*(c1*c2 - s1*s2) + a1*c1",
    "(a1*c1**2 + a2*c12*c1)/c1",
    "a1*c1 + a2*c1*c2 - a2*tan(q1)*c1*s2",
    "a1*(1 - 2*sin(q1/2)**2) + a2*c12",
    "a1*(cos(q1/3)**3*4 - 3*cos(q1/3)) + a2*c12",
    "(a1**2*c1**2 - a2**2*c12**2)/(a1*c1 - a2*c12)",
    "a1*cos(q1 + 2*pi) - a2*cos(q1 + q2 + pi)",
    "sqrt(2)*a1*sin(q1 + pi/4) - a1*s1 + a2*c12",
    "a1*c1 + a2*c12*sqrt(a1**2)**2/a1**2",
    "1/(1/(a1*c1 + a2*c12))",
]
OTHER = [
    "a1*c1 + a2*c2",
    "a1*c1 - a2*c12",
    "a1*c1 + a2*c12 + 1/10**20",
    "a1*c1 + a2*c12/(1 + l1 - l1*c1**2 - l1*s1**2 + 1/10**9)",
    "a1*cos(q1/2) + a2*c12",
]


@pytest.mark.parametrize("text", SAME + OTHER)
def test_formulas_are_equal_or_not_identically(text: str) -> None:
    found = verdict(SCARA, "T[1,4]", text)
    assert (found.equal, found.exact) == (text in SAME, True)
    assert (found.counter_example is None) == found.equal


def test_a_counter_example_shows_both_values() -> None:
    found = verdict(SCARA, "T[1,4]", "a1*c1 + a2*c2").counter_example
    values = {sympy.Symbol(name): sympy.Rational(value) for name, value in found.values}
    right = SCARA.T[0, 3].subs(values)
    printed = sympy.sympify("a1*cos(q1) + a2*cos(q2)").subs(values)
    assert abs(float(right) - found.right) < 1e-12
    assert abs(float(printed) - found.printed) < 1e-12
    assert abs(found.right - found.printed) > 1e-3


def test_a_difference_that_a_point_shows_needs_no_algebra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(QuotientRing, "difference", lambda *_: pytest.fail("expanded"))
    robot = robot_of_rows("R a: a1 | R a: a2")
    found = compare(robot, read_formula("a1*c1 + a2*c12", robot), read_formula("a1*c1 - a2*c12", robot))
    assert (found.equal, found.exact, found.counter_example is None) == (False, True, False)


def test_a_root_of_a_square_is_an_absolute_value() -> None:
    assert not verdict(SCARA, "T[1,4]", "a1*c1 + sqrt(a2**2*c12**2)").equal
    root = Call("sqrt", (read_formula("1 - c2**2", SCARA.robot),))
    sine = read_formula("s2", SCARA.robot)
    assert not compare(SCARA.robot, sine, root).equal
    assert compare(SCARA.robot, Power(sine, 2), Power(root, 2)).exact


REACH = "sqrt((a1*c1 + a2*c12)**2 + (a1*s1 + a2*s12)**2)"


@pytest.mark.parametrize(
    ("left", "right", "equal", "exact"),
    [
        (REACH, "sqrt(a1**2 + a2**2 + 2*a1*a2*c2)*sqrt(2)/sqrt(2)", True, False),
        (REACH, "sqrt(a1**2 + a2**2 - 2*a1*a2*c2)", False, False),
        ("atan2(s1, c1)", "atan2(2*s1, 2*c1)", True, False),
        ("atan2(s1, c1)", "atan2(sin(q1), cos(q1))", True, True),
        ("atan2(s1, c1)", "atan2(c1, s1)", False, False),
    ],
)
def test_what_algebra_cannot_compare_is_compared_at_points(left: str, right: str, equal: bool, exact: bool) -> None:
    found = compare(SCARA.robot, *(read_formula(text, SCARA.robot) for text in (left, right)))
    assert (found.equal, found.exact, found.counter_example is None) == (equal, exact, equal)


def test_friction_with_a_sign_is_compared_exactly() -> None:
    link = "{mass: m, friction: {viscous: b, coulomb: f}}"
    robot = robot_of_rows("R", f"links: [{link}]\ngravity: [0, 0, -g]")
    assert verdict(Model(robot), "tau[1]", "f*sign(qd1) + b*qd1").exact
    assert not verdict(Model(robot), "tau[1]", "b*qd1 - f*sign(qd1)").equal


@pytest.mark.parametrize("text", ["a1/(c1**2 + s1**2 - 1)", "a1/(a2 - a2)", "sqrt(a1/(s1 - s1))", "tan(pi/2)*a1"])
def test_division_by_zero_is_refused(text: str) -> None:
    with pytest.raises(CheckError, match="division by zero"):
        verdict(SCARA, "T[1,4]", text)


def test_a_formula_without_a_real_value_is_refused() -> None:
    with pytest.raises(CheckError, match="without a real value"):
        verdict(SCARA, "T[1,4]", "sqrt(-1 - a1**2)")


def test_sums_of_many_angles_do_not_fill_the_memory() -> None:
    body = Robot.load("human-body")
    whole = read_formula("cos(" + " + ".join(f"q{i}" for i in range(1, 22)) + ")", body)
    assert compare(body, whole, whole).equal
    assert not compare(body, whole, read_formula("c1", body)).equal


def test_an_entry_is_meant_where_a_scalar_is_compared_and_sympy_is_taken_as_it_is() -> None:
    assert SCARA.equal("T[1,4]", X)
    assert SCARA.equal("T[][1,4]", X)
    assert SCARA.equal("T[2][1,4]", X)
    assert SCARA.equal("p[1]", X)
    assert PLANAR.equal("christoffel[1,1,2]", "-ml2*a1*l2*s2")
    assert scalar_quantity(SCARA, "A[2][2,4]") == SCARA.A(2)[1, 3]
    a1, a2, q1, q2 = sympy.symbols("a1 a2 q1 q2")
    assert SCARA.equal("T[1,4]", a1 * sympy.cos(q1) + a2 * sympy.cos(q1 + q2))
    assert not SCARA.equal("T[1,4]", a1 * sympy.cos(q1) + a2 * sympy.cos(q1) / 2)
    assert SCARA.equal("T[1,4]", SCARA.T[0, 3])
    assert SCARA.equal("T[4,4]", 1)


@pytest.mark.parametrize("quantity", ["T", "B[1]", "T[9,9]", "X", "A", "J[7,1]", "christoffel[1,1]"])
def test_what_is_no_scalar_is_refused(quantity: str) -> None:
    with pytest.raises(QuantityError):
        SCARA.equal(quantity, "0")


@pytest.mark.parametrize("value", [sympy.exp(sympy.Symbol("a")), sympy.eye(2), "__import__('os')", object()])
def test_what_is_no_formula_of_notes_is_refused(value: object) -> None:
    with pytest.raises(CheckError):
        SCARA.equal("T[1,4]", value)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_formula_equals_itself_rewritten_and_not_itself_changed(seed: int) -> None:
    """Random entries of random quantities, expanded by SymPy, and with one coefficient changed."""
    rng = random.Random(seed)
    model = rng.choice([SCARA, PLANAR, ELBOW])
    quantities = ["T", "J", "B", "C", "g", "tau"] if model.robot.has_dynamics else ["T", "J"]
    value = model.quantity(rng.choice(quantities))
    entry = value[rng.randrange(value.shape[0]), rng.randrange(value.shape[1])]
    ours, robot = expression_from_sympy(entry), model.robot
    rewritten = expression_from_sympy(sympy.expand(sympy.expand_trig(entry)))
    assert compare(robot, ours, rewritten) == compare(robot, ours, ours)
    changed = compare(robot, ours, expression_from_sympy(sympy.expand(entry) + rng.choice([1, -1]) * model.q[0]))
    assert not changed.equal
    assert changed.exact
    assert changed.counter_example is not None


@pytest.mark.parametrize(("one", "other"), [("cos(26*a1)", "2*cos(13*a1)**2 - 1"), ("cos(pi/5)", "(1 + sqrt(5))/4")])
def test_angles_that_the_ring_takes_for_unrelated_are_compared_at_points(one: str, other: str) -> None:
    formulas = (read_formula(text, SCARA.robot) for text in (one, other))
    assert compare(SCARA.robot, *formulas) == Verdict(equal=True, exact=False)


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


@settings(max_examples=80, deadline=20_000, derandomize=True)
@given(formula=formulas())
def test_any_formula_is_compared_or_refused(formula: str) -> None:
    found = outcome(lambda: verdict(SCARA, "T[1,4]", formula))
    if isinstance(found, DeriveError):
        assert "\n" not in str(found)
    else:
        assert found.equal is (found.counter_example is None) or found.exact


@settings(max_examples=80, deadline=20_000, derandomize=True)
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
    "many terms": " - ".join(["a1*c1"] * 2_000),
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

"""The cell grammar: what it means, what it refuses, and where it says so."""

import ast
import math
import operator
import re
import time
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from derive.errors import DeriveError, ExpressionError, Location
from derive.robot.evaluate import evaluate
from derive.robot.expression import (
    Call,
    Expression,
    Name,
    Number,
    Pi,
    Power,
    Product,
    Sum,
    add,
    multiply,
    negate,
    power,
    to_text,
)
from derive.robot.parser import parse_expression
from tests.refusals import one_message

START = Location("cell", 7, 11)
X, Y = Name("x"), Name("y")

_BINARY: dict[type[ast.operator], Any] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}

NAMES = ("q1", "a2", "alpha1", "I", "E", "S", "N", "Q", "lambda", "beta", "gamma", "x_1", "no", "def", "e1")


def numbers() -> st.SearchStrategy[Expression]:
    return st.builds(lambda p, q: Number(Fraction(p, q)), st.integers(-99, 99), st.integers(1, 40))


def leaves() -> st.SearchStrategy[Expression]:
    return st.one_of(numbers(), st.sampled_from(NAMES).map(Name), st.just(Pi()))


def _grown(children: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    parts = st.lists(children, min_size=2, max_size=4)
    bases = children.filter(lambda base: base != Number(Fraction(0)))
    return st.one_of(
        parts.map(lambda terms: add(*terms)),
        parts.map(lambda factors: multiply(*factors)),
        st.builds(power, bases, st.integers(-2, 3)),
        st.builds(lambda f, x: Call(f, (x,)), st.sampled_from(["sin", "cos", "tan", "sqrt"]), children),
    )


def trees() -> st.SearchStrategy[Expression]:
    return st.recursive(leaves(), _grown, max_leaves=12)


def parse(text: str) -> Expression:
    return parse_expression(text, START)


def rational(numerator: int, denominator: int = 1) -> Number:
    return Number(Fraction(numerator, denominator))


@settings(deadline=None, max_examples=200)
@given(trees())
def test_a_printed_tree_parses_back_to_itself(tree: Expression) -> None:
    assert parse(to_text(tree)) == tree


@settings(deadline=None, max_examples=200)
@given(trees(), st.lists(st.floats(0.1, 2.0), min_size=len(NAMES), max_size=len(NAMES)))
def test_the_printed_text_means_what_the_tree_means_to_python(tree: Expression, values: list[float]) -> None:
    numbers = dict(zip(NAMES, values, strict=True))
    try:
        expected = evaluate(tree, numbers)
    except ArithmeticError:
        return
    # Python's own parser is the oracle of precedence; names that are keywords there get a prefix.
    text = to_text(tree)
    for name in sorted(NAMES, key=len, reverse=True):
        text = re.sub(rf"\b{name}\b", f"n_{name}", text)
    module = ast.parse(text, mode="eval")
    scope = {f"n_{name}": value for name, value in numbers.items()} | {
        key: getattr(math, key) for key in ("sin", "cos", "tan", "sqrt", "pi")
    }
    found = _python_value(module.body, scope)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-6)


def _python_value(node: ast.expr, scope: dict[str, Any]) -> float:
    match node:
        case ast.Constant(value):
            return float(value)
        case ast.Name(name):
            return float(scope[name])
        case ast.UnaryOp(ast.USub(), operand):
            return -_python_value(operand, scope)
        case ast.BinOp(left, kind, right):
            return float(_BINARY[type(kind)](_python_value(left, scope), _python_value(right, scope)))
        case ast.Call(ast.Name(name), [argument]):
            return float(scope[name](_python_value(argument, scope)))
    raise AssertionError(node)


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("0.4318", rational(4318, 10000)), ("0.10", rational(1, 10)), (".5", rational(1, 2)), ("5.", rational(5)),
        ("1e-3", rational(1, 1000)), ("2E3", rational(2000)), ("33e-6", rational(33, 10**6)), ("1/3", rational(1, 3)),
        ("-x**2", negate(power(X, 2))), ("(-x)**2", power(negate(X), 2)), ("2**-1", rational(1, 2)),
        ("2**3**2", rational(512)), ("x**-2", Power(X, -2)), ("x**(1 + 1)", Power(X, 2)), ("x**+2", Power(X, 2)),
        ("x/y/2", Product((rational(1, 2), X, Power(Y, -1)))), ("x - y - 1", Sum((X, negate(Y), rational(-1)))),
        ("x - (y - 1)", Sum((X, negate(Sum((Y, rational(-1))))))), ("2*-x", multiply(rational(-2), X)), ("--x", X),
        ("pi/2", Product((rational(1, 2), Pi()))),
        ("sqrt(2)/2", Product((rational(1, 2), Call("sqrt", (rational(2),))))),
        ("sin(x + y)", Call("sin", (Sum((X, Y)),))), ("x +\n y", add(X, Y)), ("2*(3 + 4)", rational(14)),
        ("0*x + y", Y),
        ("I*E + S - N*Q", Sum((multiply(Name("I"), Name("E")), Name("S"), negate(multiply(Name("N"), Name("Q")))))),
        ("lambda + beta*gamma", add(Name("lambda"), multiply(Name("beta"), Name("gamma")))),
    ],
)  # fmt: skip
def test_meaning(text: str, tree: Expression) -> None:
    assert parse(text) == tree


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        ("", 1, "empty"), ("   ", 4, "empty"), ("2x", 2, "2*x"), ("a b", 3, "a*b"), ("2(x)", 2, "product"),
        ("(a)(b)", 4, "product"), ("x(2)", 1, "x*(...)"), ("a^b", 2, "**"), ("x**(1/2)", 4, "sqrt"),
        ("x**y", 4, "integer"), ("x**2**y", 7, "integer"), ("x**1000", 4, "at most"), ("1/0", 2, "zero"),
        ("x/(2 - 2)", 2, "zero"), ("(x", 1, "never closed"), ("x)", 2, "unexpected"), ("x +", 4, "too early"),
        ("* x", 1, "unexpected"), ("x ** ", 6, "too early"), ("sin", 1, "sin(...)"), ("sin x", 1, "sin(...)"),
        ("sin()", 5, "unexpected"), ("sin(x, y)", 1, "arguments"), ("sinus(x)", 1, "did you mean 'sin'"),
        ("atan2(y, x)", 1, "not available"), ("exp(x)", 1, "unknown function"), ("pi(2)", 1, "pi*"),
        ("x, y", 2, "unexpected"), ("1_000", 2, "numbers without _"), ("0x10", 2, "product"),
        ("nan", 1, "not a number"), ("null", 1, "not a number"), (".inf", 1, "unexpected"), ("1e999", 1, "exponent"),
        ("9" * 61, 1, "digits"), ("a" * 65, 1, "at most 64"), ("_x", 1, "begins with a letter"),
        ("__import__('os').system('true')", 1, "begins with a letter"), ("x.__class__", 2, "unexpected"),
        ("lambda: 0", 7, "unexpected"), ("[x for x in y]", 1, "parentheses"), ("x if y else z", 3, "operator"),
        ("x == y", 3, "right-hand side"), ("'x'", 1, "quotation"), ("\u0430lpha", 1, "U+0430"),
        ("\u22121", 1, "minus"), ("\uff11", 1, "U+FF11"), ("\u03c0/2", 1, "pi"),
        ("9**32**1*9**32*9**32*9**32*9**32*9**32*9**32*9**32*9**32*9**32", 1, "too large"),
        ("(a+b+c+d+e+f+g+h)**32", 1, "terms"), ("sin((a+b+c+d+e+f+g+h)**32)", 1, "terms"),
    ],
)  # fmt: skip
def test_refusals_name_the_place_and_what_to_do(text: str, column: int, words: str) -> None:
    with one_message(ExpressionError, f"cell:7:{10 + column}", words):
        parse(text)


def test_the_place_of_an_error_follows_line_breaks() -> None:
    with one_message(ExpressionError, "cell:8:5", "unexpected"):
        parse("x +\n  y $")


@pytest.mark.parametrize(
    "text",
    [
        "(" * 50 + "x" + ")" * 50, "-" * 5000 + "x", "-" * 900 + "x", "x**" * 300 + "1", "(" * 3000,
        "sin(" * 100 + "x" + ")" * 100, "x+" * 1500 + "x", "1" * 100_000, "(((((9**32)**32)**32)**32)**32)",
        "*".join(["(a+b)"] * 200),
    ],
)  # fmt: skip
def test_large_and_deep_texts_are_refused_at_once(text: str) -> None:
    begin = time.process_time()
    with pytest.raises(ExpressionError):
        parse(text)
    assert time.process_time() - begin < 3.0


@settings(deadline=None, max_examples=500)
@given(st.text(alphabet="x1.e+-*/()^, pisnqrt_'\"$\n\u0430", max_size=30))
def test_any_text_is_parsed_or_refused_with_a_place(text: str) -> None:
    try:
        tree = parse(text)
    except DeriveError as refusal:
        place = refusal.location
    else:
        place = START
        assert parse(to_text(tree)) == tree
    assert place.line >= START.line

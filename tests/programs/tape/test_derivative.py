"""Derivatives of graphs are exact."""

from __future__ import annotations

import cmath
import math
from fractions import Fraction
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from derive.programs.optimise.improve import improved_values
from derive.programs.tape.build import cut
from derive.programs.tape.derivative import derivative, gradient_columns
from derive.programs.tape.graph import Graph
from derive.programs.tape.tape import PARAMETER, evaluate
from derive.programs.tape.value import Value
from tests.programs.tape_programs import INPUTS, PARAMETERS, RATIONAL, RandomProgram, fractions, programs

STEP = 1e-40
FLOATS: dict[str, Any] = {"number": float, "sin": cmath.sin, "cos": cmath.cos, "sqrt": cmath.sqrt}


def run(values: list[Value], arithmetic: dict[str, Any], q: list[Any], parameters: list[Any]) -> list[Any]:
    tape = cut(values[0].graph, [value.ref for value in values])
    return evaluate(tape, {"q": q, "qd": [1] * len(q), PARAMETER: parameters}, arithmetic)


@given(programs(), st.lists(fractions(), min_size=INPUTS + PARAMETERS, max_size=INPUTS + PARAMETERS))
@settings(max_examples=60, deadline=None)
def test_derivatives_of_polynomials_are_exact(program: RandomProgram, numbers: list[Fraction]) -> None:
    program = RandomProgram(program.numbers, tuple(s for s in program.steps if s.name in POLYNOMIAL), program.results)
    graph = Graph()
    values = [Value(graph, ref) for ref in program.trace(graph)]
    rates = {Value(graph, graph.input("q", i)): Value(graph, graph.number(Fraction(i + 1))) for i in range(INPUTS)}
    q, parameters = numbers[:INPUTS], numbers[INPUTS:]
    found = run(derivative(values, rates), RATIONAL, q, parameters)
    duals = program.evaluate([Dual(x, Fraction(i + 1)) for i, x in enumerate(q)], parameters)  # type: ignore[misc]
    assert found == [value.rate if isinstance(value, Dual) else 0 for value in duals]
    assert run(improved_values(values), RATIONAL, q, parameters) == run(values, RATIONAL, q, parameters)


POLYNOMIAL = ("add", "subtract", "multiply", "negate")


class Dual:
    def __init__(self, value: Fraction, rate: Fraction) -> None:
        self.value, self.rate = value, rate

    def __add__(self, other: Any) -> Dual:
        b = dual(other)
        return Dual(self.value + b.value, self.rate + b.rate)

    def __sub__(self, other: Any) -> Dual:
        return self + -other

    def __rsub__(self, other: Any) -> Dual:
        return -self + other

    def __mul__(self, other: Any) -> Dual:
        b = dual(other)
        return Dual(self.value * b.value, self.rate * b.value + self.value * b.rate)

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.rate)

    __radd__, __rmul__ = __add__, __mul__


def dual(value: Any) -> Dual:
    return value if isinstance(value, Dual) else Dual(Fraction(value), Fraction(0))


def test_quotients_roots_sines_and_signs_have_their_derivatives() -> None:
    graph = Graph()
    x, y, p = (Value(graph, graph.input(*source)) for source in (("q", 0), ("q", 1), (PARAMETER, 0)))
    root = (x * x + y * y).sqrt()
    values = [x / root, p / y, (x * y).sin(), -(x - y).cos() * p, root, x * y.sign(), y * p]
    at, parameters = [0.7, -1.3], [0.4]
    signs = {**FLOATS, "sign": lambda v: math.copysign(1.0, v.real)}
    rows = [run([entry], signs, at, parameters)[0] for row in gradient_columns(values, [x, y]) for entry in row]
    for j in range(2):
        moved = [v + 1j * STEP * (k == j) for k, v in enumerate(at)]
        wanted = [value.imag / STEP for value in run(values, signs, moved, parameters)]
        assert all(math.isclose(a.real, b, rel_tol=1e-14) for a, b in zip(rows[j::2], wanted, strict=True))


def test_what_does_not_depend_on_an_input_costs_nothing() -> None:
    graph = Graph()
    x, p = Value(graph, graph.input("q", 0)), Value(graph, graph.input(PARAMETER, 0))
    before = len(graph)
    zero, one = gradient_columns([p * p, p + x], [x])
    assert (zero[0].ref, one[0].ref) == (graph.number(Fraction(0)), graph.number(Fraction(1)))
    assert len(graph) == before + 2


def test_cases_and_arctangents_have_their_derivatives() -> None:
    graph = Graph()
    x, y = (Value(graph, graph.input("q", i)) for i in range(2))
    case = x.less(y)
    values = [
        (x * y).arctangent(x - y),
        case.select(x * x, y * y),
        (x * x).maximum(y) + x.minimum(x * y),
        abs(x * y) + case,
    ]
    functions = {
        "number": float,
        "atan2": math.atan2,
        "less": lambda a, b: float(a < b),
        "select": lambda case, a, b: a if case else b,
        "maximum": max,
        "minimum": min,
        "absolute": abs,
        "sign": lambda v: math.copysign(1.0, v),
    }
    for at in ([0.7, -1.3], [0.4, 0.9], [-2.0, 0.3]):
        rows = run([entry for row in gradient_columns(values, [x, y]) for entry in row], functions, at, [])
        for j in range(2):
            ends = [run(values, functions, [v + h * (k == j) for k, v in enumerate(at)], []) for h in (-1e-6, 1e-6)]
            wanted = [(b - a) / 2e-6 for a, b in zip(*ends, strict=True)]
            assert all(math.isclose(a, b, rel_tol=1e-7) for a, b in zip(rows[j::2], wanted, strict=True))

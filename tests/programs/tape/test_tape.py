"""Tapes: the scalars recorded, operations and their order, values and derivatives."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any
from unittest.mock import patch

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from derive.algebra import constants
from derive.algebra.constants import to_float
from derive.errors import QuantityError
from derive.programs.build import build_program
from derive.programs.formulations.choice import FormulationChoice
from derive.programs.optimise.improve import improve, improved_values
from derive.programs.tape.build import bake, cut, program_cost, reachable
from derive.programs.tape.derivative import derivative, gradient_columns
from derive.programs.tape.graph import ONE, ZERO, Graph, ref_to
from derive.programs.tape.tape import LEAVES, PARAMETER, Layer, Op, Operations, evaluate
from derive.programs.tape.value import TapeDomain, Value
from derive.robot.robot import Robot
from tests.programs.tape_programs import INPUTS, PARAMETERS, RATIONAL, RandomProgram, fractions, programs, variables
from tests.rows import robot_of_rows

CHOICES: dict[str, Any] = {
    "less": lambda a, b: Fraction(a < b),
    "select": lambda case, a, b: a if case else b,
    "maximum": max,
    "minimum": min,
    "absolute": abs,
}
points = st.lists(fractions(), min_size=INPUTS + PARAMETERS, max_size=INPUTS + PARAMETERS)


@contextmanager
def rational_functions() -> Iterator[None]:
    """Fold numbers by the same stand-ins by which values are evaluated."""
    with patch.object(constants, "sine", RATIONAL["sin"]), patch.object(constants, "cosine", RATIONAL["cos"]):
        yield


def operations(*values: Value) -> Operations:
    return cut(values[0].graph, [value.ref for value in values]).operations


@given(program=programs(), point=points)
@settings(max_examples=300, deadline=None)
def test_every_pass_keeps_the_values(program: RandomProgram, point: list[Fraction]) -> None:
    inputs, parameters = point[:INPUTS], point[INPUTS:]
    wanted = program.evaluate(inputs, parameters)
    graph = Graph()
    with rational_functions():
        results = program.trace(graph)
        stages = ((graph, results), improve(graph, results))
    for stage in stages:
        found = evaluate(cut(*stage), {"q": inputs, PARAMETER: parameters}, RATIONAL)
        assert found == wanted


@given(program=programs(), point=points)
@settings(max_examples=150, deadline=None)
def test_numbers_put_in_later_give_the_same_as_symbols(program: RandomProgram, point: list[Fraction]) -> None:
    inputs, parameters = point[:INPUTS], point[INPUTS:]
    graph = Graph()
    with rational_functions():
        baked = cut(*bake(graph, program.trace(graph), dict(enumerate(parameters))))
    assert evaluate(baked, {"q": inputs}, RATIONAL) == program.evaluate(inputs, parameters)
    assert all(node.layer is not Layer.HOISTED for node in baked.nodes)


@given(program=programs())
@settings(max_examples=150, deadline=None)
def test_improving_costs_nothing_and_a_tape_is_in_order_complete_and_without_waste(program: RandomProgram) -> None:
    graph = Graph()
    results = program.trace(graph)
    better = improve(graph, results)
    assert program_cost(*better) <= program_cost(graph, results)
    tape = cut(*better)
    assert all(k < i for i, node in enumerate(tape.nodes) for k in node.operands)
    assert all(tape.use_counts)
    keys = [(n.op, n.operands, n.source, n.value) for n in tape.nodes]
    assert len(set(keys)) == len(keys)


SAME: list[Callable[[Value, Value, Value], tuple[Value, ...]]] = [
    lambda x, y, z: (Value(x.graph, ZERO), x * 0, x - x, 0 * y, x.less(x)),
    lambda x, y, z: (Value(x.graph, ONE), x / x, x**0),
    lambda x, y, z: (x, x + 0, x * 1, x - 0),
    lambda x, y, z: (x * y, y * x, -x * -y),
    lambda x, y, z: (x + y, y + x, -(-y - x)),
    lambda x, y, z: (x - y, -(y - x)),
    lambda x, y, z: ((-x).sin(), -(x.sin())),
    lambda x, y, z: (x.cos(), (-x).cos()),
    lambda x, y, z: ((x - y).cos(), (y - x).cos()),
    lambda x, y, z: ((-y).arctangent(x), -(y.arctangent(x))),
    lambda x, y, z: ((-y).arctangent(-x), -(y.arctangent(-x))),
    lambda x, y, z: (x, (x / x).select(x, y), (x - x).select(y, x), z.select(x, x)),
    lambda x, y, z: ((x * x).sqrt(), abs((x * x).sqrt())),
    lambda x, y, z: ((-x).maximum(-y), -(x.minimum(y))),
    lambda x, y, z: ((1 - z).select(x, y), z.select(y, x)),
]


@pytest.mark.parametrize("values", SAME)
def test_equal_values_are_one_whatever_their_order_and_sign(
    values: Callable[[Value, Value, Value], tuple[Value, ...]],
) -> None:
    first, *others = (value.ref for value in values(*variables()))
    assert others == [first] * len(others)


def test_signs_and_values_that_are_there_cost_nothing_and_powers_square_repeatedly() -> None:
    x, y, z = variables()
    assert operations(x * y + z, y * -x, (x - y) * z, (y - x) * z) == Operations(mul=2, add=2)
    assert operations(-(x * y), x.sin(), (-x).sin(), x.cos()) == Operations(mul=1, sin=1, cos=1)
    assert operations(*((e * y).arctangent(f * x) for e in (1, -1) for f in (1, -1))).atan2 == 2
    assert (operations(x**8), operations(x**-2)) == (Operations(mul=3), Operations(mul=1, div=1))


def test_like_terms_merge_common_factors_come_out_and_constants_go_into_sums() -> None:
    x, y, z = variables()
    sums = [(x + y) + (z - x) - y, x * y + x * z, 2 * x + 3 * x - 5 * x + z, x * y - y * x + x]
    improved = cut(*improve(x.graph, [value.ref for value in sums]))
    assert improved.operations == Operations(mul=1, add=1)
    x, y, _ = variables()
    value = (x * 3 - y * 7) * Fraction(1, 2)
    assert cut(*improve(x.graph, [value.ref])).operations == Operations(mul=2, add=1)


def test_work_on_parameters_alone_is_gathered_and_hoisted() -> None:
    x, y, _ = variables()
    m, r = (Value(x.graph, x.graph.input(PARAMETER, i)) for i in range(2))
    tape = cut(*improve(x.graph, [(m * (x * r) + (r * m) * y).ref]))
    assert tape.operations == Operations(mul=1, add=1)
    assert tape.hoisted_operations == Operations(mul=1)
    assert len(tape.hoisted_results) == 1
    assert tape.parameters == (0, 1)


def test_a_negative_difference_is_turned_round_and_dead_values_are_dropped() -> None:
    x, y, z = variables()
    tape = cut(x.graph, [(-(x - y)).ref, (-((x - z) * 3)).ref])
    assert not any(output.negative for output in tape.outputs)
    values = evaluate(tape, {"q": [5, 2, 1]}, RATIONAL)
    assert values == [-3, -12]
    x, y, z = variables()
    kept = x * y
    assert (kept + z).sin().ref not in [ref_to(i) for i in reachable(x.graph, [kept.ref])]
    assert [node.op for node in cut(x.graph, [kept.ref]).nodes if node.op not in LEAVES] == [Op.MULTIPLY]


def test_division_by_the_constant_zero_is_refused_where_no_argument_enters() -> None:
    graph = Graph()
    parameter = Value(graph, graph.input(PARAMETER, 0))
    for value in (parameter, parameter - parameter, parameter**0):
        with pytest.raises(QuantityError, match="division by zero"):
            _ = value / 0
    x, y, _ = variables()
    tape = cut(*improve(x.graph, [(x * y / 0).ref]))
    assert tape.operations == Operations(mul=1, div=1)


def test_deep_programs_need_no_recursion() -> None:
    x, y, z = variables()
    value = x
    for k in range(2000):
        value = (value * y + z) if k % 2 else (value + x * k)
    total = x
    for k in range(1500):
        total = total + (x * (k + 2)).sin()
    tape = cut(*improve(x.graph, [value.ref, total.ref]))
    assert tape.operations.sin == 1500


def test_choices_between_opposites_are_opposite() -> None:
    x, y, z = variables()
    case = x.less(y)
    for a, b in ((x, z), (1, z), (0, z), (x, 1), (x, 0), (-x, z), (1, -1)):
        value, opposite = case.select(a, b), case.select(-a, -b)
        assert value.ref == (-opposite).ref


def test_constants_of_every_kind_are_compared() -> None:
    graph = Graph()
    half, root = Value(graph, graph.number(Fraction(1, 2))), Value(graph, graph.number(Fraction(2))).sqrt()
    assert (half.less(root).ref, root.less(half).ref, half.less(-root).ref) == (ONE, ZERO, ZERO)
    assert (half.maximum(root).ref, half.minimum(-root).ref) == (root.ref, (-root).ref)


def test_cases_and_what_is_nowhere_negative_are_known_by_how_they_are_written() -> None:
    x, y, z = variables()
    case, other = x.less(y), y.less(z)
    for known in (case, case * other, case.maximum(other), case.opposite(), (case * other).opposite()):
        assert x.graph.is_case(known.ref)
    for unknown in (x, -case, case + other, case * z, x.opposite()):
        assert not x.graph.is_case(unknown.ref)
    assert case.opposite().opposite().ref == case.ref
    x, y, _ = variables()
    for known in (x * x, x.sqrt() * abs(y), x * x + abs(y) + 2, x.less(y)):
        assert x.graph.is_nowhere_negative(known.ref)
        assert known.maximum(0).ref == known.ref
    for unknown in (x, x * y, -(x * x), x * x - 1, x * x + y):
        assert not x.graph.is_nowhere_negative(unknown.ref)


@given(point=st.lists(fractions(), min_size=3, max_size=3))
@settings(max_examples=100, deadline=None)
def test_improving_keeps_what_cases_choose(point: list[Fraction]) -> None:
    x, y, z = variables()
    case = (x * y + x * z).less(y * z)
    values = [case.select(x * y + x * z, -x) + z, (x - y).maximum(-z) * abs(z - x), (1 - case).minimum(x * -y)]
    functions = RATIONAL | CHOICES
    refs = [value.ref for value in values]
    plain, improved = (
        evaluate(cut(*stage), {"q": point}, functions) for stage in ((x.graph, refs), improve(x.graph, refs))
    )
    assert plain == improved


STEP = 1e-40
FLOATS: dict[str, Any] = {"number": float, "sin": cmath.sin, "cos": cmath.cos, "sqrt": cmath.sqrt}


def run(values: list[Value], arithmetic: dict[str, Any], q: list[Any], parameters: list[Any]) -> list[Any]:
    tape = cut(values[0].graph, [value.ref for value in values])
    return evaluate(tape, {"q": q, "qd": [1] * len(q), PARAMETER: parameters}, arithmetic)


@given(programs(), points)
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
    x, y, _ = variables()
    case = x.less(y)
    values = [
        (x * y).arctangent(x - y),
        case.select(x * x, y * y),
        (x * x).maximum(y) + x.minimum(x * y),
        abs(x * y) + case,
    ]
    functions = CHOICES | {"number": float, "atan2": math.atan2, "sign": lambda v: math.copysign(1.0, v)}
    for at in ([0.7, -1.3], [0.4, 0.9], [-2.0, 0.3]):
        rows = run([entry for row in gradient_columns(values, [x, y]) for entry in row], functions, at, [])
        for j in range(2):
            ends = [run(values, functions, [v + h * (k == j) for k, v in enumerate(at)], []) for h in (-1e-6, 1e-6)]
            wanted = [(b - a) / 2e-6 for a, b in zip(*ends, strict=True)]
            assert all(math.isclose(a, b, rel_tol=1e-7) for a, b in zip(rows[j::2], wanted, strict=True))


def robot(theta: str, alpha: str = "0", a: str = "0", **extra: str) -> Robot:
    more = "\n".join(f"{key}: {value}" for key, value in extra.items())
    return robot_of_rows(f"R theta: '{theta}', alpha: '{alpha}', a: '{a}'", more)


@pytest.mark.parametrize(
    ("theta", "cosine_is", "negative"),
    [("q1", "cos", False), ("q1 + pi/2", "sin", True), ("q1 - pi/2", "sin", False), ("q1 + pi", "cos", True)],
)
def test_quarter_turns_exchange_sine_and_cosine(theta: str, cosine_is: str, negative: bool) -> None:
    graph = Graph()
    domain = TapeDomain(robot(theta), graph)
    cosine, sine = domain.joint_cosine_sine(0, robot(theta).joints[0])
    q = domain.argument("q", 0)
    wanted = q.cos() if cosine_is == "cos" else q.sin()
    assert cosine.ref == (-wanted if negative else wanted).ref
    assert cut(graph, [cosine.ref, sine.ref]).operations == Operations(sin=1, cos=1)


@pytest.mark.parametrize(
    ("theta", "alpha", "beta", "additions"),
    [
        ("q1 + beta + pi/2", "0", "0.3", 1),
        ("q1 + beta", "0", "pi/2", 0),
        ("q1", "beta", "-pi/2", 0),
        *(("q1", alpha, "", 0) for alpha in ("pi/2", "-pi/2", "pi", "3*pi/2", "2*pi")),
    ],
)
def test_quarter_turns_cost_nothing_and_other_offsets_go_into_the_angle(
    theta: str, alpha: str, beta: str, additions: int
) -> None:
    extra = {"parameters": f"{{beta: {beta}}}"} if beta else {}
    program = build_program(robot(theta, alpha, **extra))
    assert program["forward_kinematics"].operations == Operations(add=additions, sin=1, cos=1)


def test_special_angles_are_algebraic_numbers() -> None:
    graph = Graph()
    one = robot("q1", "pi/3")
    cosine, sine = TapeDomain(one, graph).cosine_sine(one.joints[0].alpha)
    assert graph.constant_of(cosine.ref) == Fraction(1, 2)
    assert (cosine * cosine + sine * sine).ref == ONE
    assert (sine * sine - Fraction(3, 4)).ref == ZERO


def test_symbols_stay_symbols_until_the_graph_is_built() -> None:
    one = robot("q1", a="2*(x + y)", parameters="{x: 0.1}")
    graph = Graph()
    domain = TapeDomain(one, graph)
    value = domain.constant(one.joints[0].a)
    assert cut(graph, [value.ref]).hoisted_operations == Operations(mul=1, add=1)
    tape = cut(*bake(graph, [value.ref], FormulationChoice(one, graph).numbers))
    assert [node.source.index for node in tape.nodes if node.source] == [0]
    assert evaluate(tape, {PARAMETER: [0.25]}, {"number": to_float}) == [pytest.approx(0.7)]


def test_runtime_names_stay_free_and_constants_are_rounded_once() -> None:
    program = build_program(robot("q1", a="x + y", parameters="{x: 0.1, y: 2}", runtime="[y]"))
    assert program.parameters == ("y",)
    assert program["forward_kinematics"].tape.hoisted_operations == Operations(add=1)
    program = build_program(robot("q1", a="0.1 + 0.2 - 0.3 + sqrt(2)*sqrt(2) - 1"))
    values = [to_float(n.value) for n in program["forward_kinematics"].tape.nodes if n.value is not None]
    assert set(values) == {0.0, 1.0}


@pytest.mark.parametrize("cell", ["1/x", "sqrt(x - 1)", "tan(x + pi/2)"])
def test_cells_without_a_value_are_refused(cell: str) -> None:
    with pytest.raises((QuantityError, Exception), match=r"zero|negative|pole|value"):
        build_program(robot("q1", a=cell, parameters="{x: 0}"))


def test_division_in_cells_is_one_operation() -> None:
    program = build_program(robot("q1", a="x/y + y**-2"))
    hoisted = program["forward_kinematics"].tape.hoisted_operations
    assert hoisted == Operations(mul=1, add=1, div=2)
    nodes = [node for function in program for node in function.tape.nodes]
    sources = [node.source for node in nodes if node.layer is Layer.BODY and node.source]
    assert {source.kind for source in sources} == {"q", "qd", "h"}

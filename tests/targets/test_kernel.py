"""Every printer gets every operation right, in every language, on one list of expressions."""

import math
import re
from collections.abc import Callable
from fractions import Fraction
from functools import cache

import array_api_strict as strict
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from derive.algebra import constants
from derive.programs.program import Program
from derive.programs.tape.graph import Graph
from derive.programs.tape.tape import Op
from derive.programs.tape.value import Value
from derive.targets.kernel import JAVASCRIPT, PYTHON, C, CodePiece, Language, wrapped, write_kernel
from tests.rows import robot_of_rows
from tests.targets.generated_models import c_model, needs_compiler, numpy_model, planar, small_program, source_of
from tests.targets.languages import languages, running

Build = Callable[[Value, Value], Value]
Check = Callable[[float, float], float]

EXPRESSIONS: dict[str, tuple[Build, Check]] = {
    "sum": (lambda x, y: x + y + 2, lambda x, y: x + y + 2),
    "difference of sums": (lambda x, y: (x - y) - (x + 3), lambda x, y: (x - y) - (x + 3)),
    "nested difference": (lambda x, y: x - (y - (x * y - 1)), lambda x, y: x - (y - (x * y - 1))),
    "product of sums": (lambda x, y: (x + 1) * (y - 2) * x, lambda x, y: (x + 1) * (y - 2) * x),
    "product of products": (lambda x, y: x * (y * (x + 4)), lambda x, y: x * (y * (x + 4))),
    "quotient": (lambda x, y: x / (y * x + 9), lambda x, y: x / (y * x + 9)),
    "quotient of quotients": (lambda x, y: (x / y) / (y / (x + 3)), lambda x, y: (x / y) / (y / (x + 3))),
    "divided product": (lambda x, y: (x * y) / (y + 5), lambda x, y: (x * y) / (y + 5)),
    "product with quotient": (lambda x, y: y * (x / (y + 5)), lambda x, y: y * (x / (y + 5))),
    "negative output": (lambda x, y: -(x * y), lambda x, y: -(x * y)),
    "negative sum": (lambda x, y: -(x + y), lambda x, y: -(x + y)),
    "negative quotient": (lambda x, y: -(x / (y + 7)), lambda x, y: -(x / (y + 7))),
    "third": (lambda x, y: x * Fraction(1, 3), lambda x, y: x / 3),
    "large number": (lambda x, y: x * 10**20 + y, lambda x, y: x * 1e20 + y),
    "small number": (lambda x, y: x * Fraction(1, 10**30), lambda x, y: x * 1e-30),
    "number": (lambda x, y: x - x - Fraction(5, 2), lambda x, y: -2.5),
    "zero": (lambda x, y: x - x, lambda x, y: 0.0),
    "pi": (lambda x, y: x * Value(x.graph, x.graph.number(constants.pi())), lambda x, y: x * math.pi),
    "power": (lambda x, y: x**5 + y**-2, lambda x, y: x**5 + y**-2),
    "sine": (lambda x, y: x.sin() * (x + y).sin(), lambda x, y: math.sin(x) * math.sin(x + y)),
    "cosine": (lambda x, y: y.cos() + (x * 2).cos(), lambda x, y: math.cos(y) + math.cos(2 * x)),
    "root": (lambda x, y: (x * x + 1).sqrt(), lambda x, y: math.sqrt(x * x + 1)),
    "root of a negative": (lambda x, y: (-(x * x) + 90).sqrt(), lambda x, y: math.sqrt(90 - x * x)),
    "root under minus": (lambda x, y: (-(-(x * x) - 1)).sqrt(), lambda x, y: math.sqrt(x * x + 1)),
    "sign": (lambda x, y: x.sign() * y + (x - x).sign(), lambda x, y: math.copysign(y, x) * math.copysign(1, y)),
    "arctangent": (lambda x, y: y.arctangent(x), lambda x, y: math.atan2(y, x)),
    "opposite arctangents": (
        lambda x, y: (-y).arctangent(x) + 10 * y.arctangent(-x) + 100 * (-y).arctangent(-x),
        lambda x, y: math.atan2(-y, x) + 10 * math.atan2(y, -x) + 100 * math.atan2(-y, -x),
    ),
    "arctangents on the axes": (
        lambda x, y: (x - x).arctangent(x) + 10 * y.arctangent(0) + (x + y).arctangent(x + y),
        lambda x, y: math.atan2(0, x) + 10 * math.atan2(y, 0) + math.atan2(x + y, x + y),
    ),
    "comparison": (
        lambda x, y: x.less(y) + 2 * (-x).less(-y) + 4 * x.less(-1) + 8 * (-y).less(x),
        lambda x, y: (x < y) + 2 * (-x < -y) + 4 * (x < -1) + 8 * (-y < x),
    ),
    "comparison with itself": (lambda x, y: (x * y).less(y * x), lambda x, y: 0.0),
    "choice": (lambda x, y: x.less(y).select(x * y, -x) * 3, lambda x, y: (x * y if x < y else -x) * 3),
    "choice of opposites": (lambda x, y: x.less(0).select(-y, 0), lambda x, y: -y if x < 0 else 0.0),
    "the opposite case": (lambda x, y: (1 - x.less(y)).select(x, 2), lambda x, y: 2 if x < y else x),
    "a choice that spares a root": (
        lambda x, y: x.less(0).select(-1, x.sqrt()),
        lambda x, y: -1.0 if x < 0 else math.sqrt(x),
    ),
    "larger and smaller": (
        lambda x, y: x.maximum(y) - 3 * x.minimum(-y) + (-x).maximum(-y) * 7,
        lambda x, y: max(x, y) - 3 * min(x, -y) + max(-x, -y) * 7,
    ),
    "clamped": (lambda x, y: (x * y).maximum(0).sqrt(), lambda x, y: math.sqrt(max(x * y, 0))),
    "absolute": (lambda x, y: abs(-x) + abs(y) * abs(abs(x)), lambda x, y: abs(x) + abs(y * x)),
    "shared value": (lambda x, y: (x + y).sin() * (x + y) + (x + y), lambda x, y: (math.sin(x + y) + 1) * (x + y)),
}
TWO = robot_of_rows("R | R", name="two")
POINTS = [(0.3, 0.7), (-1.2, 0.4), (2.5, -0.6), (-0.1, -3.0)]


@cache
def program() -> Program:
    graph = Graph()
    x, y = (Value(graph, graph.input("q", i)) for i in range(2))
    return small_program(graph, [build(x, y) for build, _ in EXPRESSIONS.values()])


@pytest.mark.parametrize("language", languages())
def test_printed_expressions_evaluate_right(language: str) -> None:
    """One point at a time and, where there are batches, all at once; sines of batches may round otherwise."""
    wanted = np.array([[check(*point) for _, check in EXPRESSIONS.values()] for point in POINTS])
    with running(language, TWO, program()) as model, np.errstate(invalid="ignore"):
        ones = np.array([model.call("gravity_vector", [np.array(point)], {}) for point in POINTS])
        ways = [ones, *([model.call("gravity_vector", [np.array(POINTS)], {})] if "batch" in model.ways else [])]
    for way in ways:
        errors = np.abs(way - wanted) / np.maximum(np.abs(wanted), 0.1)
        assert [name for name, worst in zip(EXPRESSIONS, errors.max(axis=0), strict=True) if worst > 1e-14] == []
    exact = [i for i, name in enumerate(EXPRESSIONS) if not any(f in name for f in ("sine", "shared"))]
    if language == "numpy":
        assert np.array_equal(ways[0][:, exact], ways[1][:, exact])


@pytest.mark.parametrize("library", [strict, jnp])
def test_printed_expressions_on_arrays_of_other_libraries(library: object) -> None:
    model = numpy_model(TWO, program())
    with jax.enable_x64(True), np.errstate(invalid="ignore"):
        found = np.asarray(model.gravity_vector(library.asarray(np.array(POINTS))))
        wanted = model.gravity_vector(np.array(POINTS))
    np.testing.assert_allclose(found, wanted, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("language", [PYTHON, JAVASCRIPT], ids=["python", "javascript"])
def test_names_are_given_once_and_used_afterwards(language: Language) -> None:
    """In the order of the tape; those of the body go on where those of the hoisted part end."""
    program = source_of(planar()).program
    for function in program:
        kernel = write_kernel(function.tape, language, program.parameters)
        known = {*kernel.constants, *(f"p_{name}" for name in program.parameters), "const"}
        known |= {"sin", "cos", "sqrt", "sign", "less"}
        known |= {f"{kind}{i}" for kind in ("q", "qd", "qdd", "tau") for i in (1, 2)} | {f"h{i}" for i in range(1, 7)}
        for line in (*kernel.hoisted, *kernel.body):
            name, value = line.removeprefix("const ").rstrip(";").split(" = ")
            assert name not in known, function.name
            assert set(re.findall(r"\b[A-Za-z_]\w*", value)) <= known
            known.add(name)


def test_a_negative_number_is_no_atom_where_two_minus_signs_are_a_mistake() -> None:
    """``--2`` decrements nothing in C and is refused by JavaScript."""
    written = [to.operation(Op.NEGATE, [to.number(Fraction(-2))]).text for to in (PYTHON, JAVASCRIPT, C)]
    assert written == ["--2.0", "-(-2.0)", "-(-2.0)"]
    assert CodePiece("a + b", 1).inside(2) == "(a + b)"


def test_lists_break_between_values() -> None:
    lines = wrapped([f"value_{k}" for k in range(40)])
    assert max(map(len, lines)) <= 104
    assert " ".join(lines) == ", ".join(f"value_{k}" for k in range(40)) + ","
    assert wrapped([]) == ()


@needs_compiler
def test_the_arctangent_of_c_is_within_two_units_in_the_last_place() -> None:
    graph = Graph()
    x, y = (Value(graph, graph.input("q", i)) for i in range(2))
    model = c_model(TWO, small_program(graph, [y.arctangent(x)]))
    turns = np.random.default_rng(3).uniform(-np.pi, np.pi, 20000)
    sizes = 10.0 ** np.random.default_rng(4).uniform(-150, 150, turns.size)
    points = np.stack([sizes * np.cos(turns), sizes * np.sin(turns)], axis=-1)
    near = 10.0 ** np.arange(-20.0, 21.0)
    axes = np.array([(a * s, b * t) for a, b in zip(near, near[::-1], strict=True) for s in (1, -1) for t in (1, -1)])
    corners = np.array([(a, b) for a in (0.0, 1.0, -1.0) for b in (0.0, 1.0, -1.0)])
    for rows in (points, axes, corners):
        wanted = np.arctan2(rows[:, 1], rows[:, 0])
        found = model.call("gravity_vector", [rows], {})[:, 0]
        assert (abs(found - wanted) <= 2 * np.spacing(abs(wanted))).all()

"""Cells as tape values: which angles are exact, which numbers are baked, what stays free."""

from fractions import Fraction

import pytest

from derive.algebra.constants import to_float
from derive.errors import QuantityError
from derive.programs.build import build_program
from derive.programs.formulations.choice import FormulationChoice
from derive.programs.tape.build import bake, cut
from derive.programs.tape.graph import ONE, ZERO, Graph
from derive.programs.tape.scalars import TapeDomain
from derive.programs.tape.tape import PARAMETER, Layer, Operations, evaluate
from derive.robot.robot import Robot


def robot(theta: str, alpha: str = "0", a: str = "0", **extra: str) -> Robot:
    lines = [
        "name: one",
        "convention: standard",
        f"joints: [{{type: revolute, q: q1, theta: '{theta}', alpha: '{alpha}', a: '{a}'}}]",
        *(f"{key}: {value}" for key, value in extra.items()),
    ]
    return Robot.from_text("\n".join(lines))


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


def test_other_offsets_go_into_the_angle() -> None:
    program = build_program(robot("q1 + beta + pi/2", parameters="{beta: 0.3}"))
    assert program["forward_kinematics"].operations == Operations(add=1, sin=1, cos=1)


def test_a_parameter_that_is_a_quarter_turn_is_one() -> None:
    program = build_program(robot("q1 + beta", parameters="{beta: pi/2}"))
    assert program["forward_kinematics"].operations == Operations(sin=1, cos=1)


@pytest.mark.parametrize("alpha", ["pi/2", "-pi/2", "pi", "3*pi/2", "2*pi", "beta"])
def test_twists_by_quarter_turns_cost_nothing(alpha: str) -> None:
    extra = {"parameters": "{beta: -pi/2}"} if alpha == "beta" else {}
    program = build_program(robot("q1", alpha, **extra))
    assert program["forward_kinematics"].operations == Operations(sin=1, cos=1)


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


def test_runtime_names_stay_free_though_they_have_a_number() -> None:
    program = build_program(robot("q1", a="x + y", parameters="{x: 0.1, y: 2}", runtime="[y]"))
    assert program.parameters == ("y",)
    assert program["forward_kinematics"].hoisted_operations == Operations(add=1)


def test_constants_are_rounded_once() -> None:
    program = build_program(robot("q1", a="0.1 + 0.2 - 0.3 + sqrt(2)*sqrt(2) - 1"))
    values = [to_float(n.value) for n in program["forward_kinematics"].tape.nodes if n.value is not None]
    assert set(values) == {0.0, 1.0}


@pytest.mark.parametrize("cell", ["1/x", "sqrt(x - 1)", "tan(x + pi/2)"])
def test_cells_without_a_value_are_refused(cell: str) -> None:
    with pytest.raises((QuantityError, Exception), match=r"zero|negative|pole|value"):
        build_program(robot("q1", a=cell, parameters="{x: 0}"))


def test_division_in_cells_is_one_operation() -> None:
    program = build_program(robot("q1", a="x/y + y**-2"))
    hoisted = program["forward_kinematics"].hoisted_operations
    assert hoisted == Operations(mul=1, add=1, div=2)
    sources = [node.source for node in _nodes(program) if node.layer is Layer.BODY and node.source]
    assert {source.kind for source in sources} == {"q", "qd"}


def _nodes(program: object) -> list[object]:
    return [node for function in program for node in function.tape.nodes]  # type: ignore[attr-defined]

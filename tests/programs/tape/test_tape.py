"""Tapes: the same values after every pass, every operation once, nothing without use."""

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from unittest.mock import patch

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from derive.algebra import constants
from derive.errors import QuantityError
from derive.programs.optimise.improve import improve
from derive.programs.tape.build import bake, cut, reachable
from derive.programs.tape.cost import program_cost
from derive.programs.tape.graph import ONE, ZERO, Graph, ref_to
from derive.programs.tape.tape import LEAVES, PARAMETER, Layer, Op, Operations, evaluate
from derive.programs.tape.value import Value
from tests.programs.tape_programs import INPUTS, PARAMETERS, RATIONAL, RandomProgram, fractions, programs, variables

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
        results = program.trace(graph)
    numbers = dict(enumerate(parameters))
    with rational_functions():
        baked = cut(*bake(graph, results, numbers))
    assert evaluate(baked, {"q": inputs}, RATIONAL) == program.evaluate(inputs, parameters)
    assert all(node.layer is not Layer.HOISTED for node in baked.nodes)


@given(program=programs())
@settings(max_examples=150, deadline=None)
def test_a_tape_is_in_order_complete_and_without_waste(program: RandomProgram) -> None:
    graph = Graph()
    tape = cut(*improve(graph, program.trace(graph)))
    assert all(k < i for i, node in enumerate(tape.nodes) for k in node.operands)
    assert all(tape.use_counts)
    keys = [(n.op, n.operands, n.source, n.value) for n in tape.nodes]
    assert len(set(keys)) == len(keys)


@given(program=programs())
@settings(max_examples=150, deadline=None)
def test_improving_never_costs_operations(program: RandomProgram) -> None:
    graph = Graph()
    results = program.trace(graph)
    assert program_cost(*improve(graph, results)) <= program_cost(graph, results)


def test_zero_and_one_leave_no_trace() -> None:
    graph = Graph()
    x, y, _ = variables(graph)
    assert (x * 0).ref == (x - x).ref == (0 * y).ref == ZERO
    assert (x + 0).ref == (x * 1).ref == (x - 0).ref == x.ref
    assert (x / x).ref == ONE


def test_equal_values_are_one_whatever_their_order_and_sign() -> None:
    graph = Graph()
    x, y, z = variables(graph)
    assert (x * y).ref == (y * x).ref == (-x * -y).ref
    assert (x + y).ref == (y + x).ref == (-(-y - x)).ref
    assert (x - y).ref == (-(y - x)).ref
    assert operations(x * y + z, y * -x, (x - y) * z, (y - x) * z) == Operations(mul=2, add=2)


def test_signs_are_free_and_functions_know_their_symmetry() -> None:
    graph = Graph()
    x, y, _ = variables(graph)
    assert (-x).sin().ref == (-(x.sin())).ref
    assert (-x).cos().ref == x.cos().ref
    assert (x - y).cos().ref == (y - x).cos().ref
    assert operations(-(x * y), x.sin(), (-x).sin(), x.cos()) == Operations(mul=1, sin=1, cos=1)


def test_like_terms_merge_and_common_factors_come_out() -> None:
    graph = Graph()
    x, y, z = variables(graph)
    sums = [(x + y) + (z - x) - y, x * y + x * z, 2 * x + 3 * x - 5 * x + z, x * y - y * x + x]
    improved = cut(*improve(graph, [value.ref for value in sums]))
    assert improved.operations == Operations(mul=1, add=1)


def test_work_on_parameters_alone_is_gathered_and_hoisted() -> None:
    graph = Graph()
    x, y, _ = variables(graph)
    m, r = (Value(graph, graph.input(PARAMETER, i)) for i in range(2))
    tape = cut(*improve(graph, [(m * (x * r) + (r * m) * y).ref]))
    assert tape.operations == Operations(mul=1, add=1)
    assert tape.hoisted_operations == Operations(mul=1)
    assert len(tape.hoisted_results) == 1
    assert tape.parameters == (0, 1)


def test_a_negative_difference_is_turned_round() -> None:
    graph = Graph()
    x, y, z = variables(graph)
    tape = cut(graph, [(-(x - y)).ref, (-((x - z) * 3)).ref])
    assert not any(output.negative for output in tape.outputs)
    values = evaluate(tape, {"q": [5, 2, 1]}, RATIONAL)
    assert values == [-3, -12]


def test_dead_values_are_dropped() -> None:
    graph = Graph()
    x, y, z = variables(graph)
    kept = x * y
    assert (kept + z).sin().ref not in [ref_to(i) for i in reachable(graph, [kept.ref])]
    assert [node.op for node in cut(graph, [kept.ref]).nodes if node.op not in LEAVES] == [Op.MULTIPLY]


def test_constant_factors_go_into_sums_that_have_some() -> None:
    graph = Graph()
    x, y, _ = variables(graph)
    value = (x * 3 - y * 7) * Fraction(1, 2)
    assert cut(*improve(graph, [value.ref])).operations == Operations(mul=2, add=1)


def test_powers_square_repeatedly() -> None:
    graph = Graph()
    x, _, _ = variables(graph)
    assert operations(x**8) == Operations(mul=3)
    assert (x**0).ref == ONE
    assert operations(x**-2) == Operations(mul=1, div=1)


def test_division_by_the_constant_zero_is_refused_where_no_argument_enters() -> None:
    graph = Graph()
    parameter = Value(graph, graph.input(PARAMETER, 0))
    for value in (parameter, parameter - parameter, parameter**0):
        with pytest.raises(QuantityError, match="division by zero"):
            _ = value / 0


def test_arguments_may_be_divided_by_zero_as_floats_may() -> None:
    graph = Graph()
    x, y, _ = variables(graph)
    tape = cut(*improve(graph, [(x * y / 0).ref]))
    assert tape.operations == Operations(mul=1, div=1)


def test_deep_programs_need_no_recursion() -> None:
    graph = Graph()
    x, y, z = variables(graph)
    value = x
    for k in range(5000):
        value = (value * y + z) if k % 2 else (value + x * k)
    total = x
    for k in range(3000):
        total = total + (x * (k + 2)).sin()
    tape = cut(*improve(graph, [value.ref, total.ref]))
    assert tape.operations.sin == 3000


def test_arctangents_are_odd() -> None:
    graph = Graph()
    x, y, _ = variables(graph)
    angles = [y.arctangent(x), (-y).arctangent(x), y.arctangent(-x), (-y).arctangent(-x)]
    assert operations(*angles).atan2 == 2
    assert (angles[1].ref, angles[3].ref) == ((-angles[0]).ref, (-angles[2]).ref)

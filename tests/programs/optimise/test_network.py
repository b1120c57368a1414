"""Networks of polynomials keep their value however they are written; every threshold of the search counts."""

import inspect
import re
from dataclasses import fields, replace
from fractions import Fraction

import pytest
from hypothesis import given, settings

from derive.errors import DeriveError
from derive.programs.build import build_program
from derive.programs.optimise.coefficients import PRIME, Coefficients, residue_of, scatter
from derive.programs.optimise.improve import graph_of, improve, network_of
from derive.programs.optimise.network import Network, Opaque, polynomial_cost
from derive.programs.optimise.search import Resubstitution, Search
from derive.programs.optimise.search_policy import POLICY, Effort, Policy, effort_named
from derive.programs.optimise.sharing import Extractor
from derive.programs.tape.build import cut, schedule
from derive.programs.tape.graph import ZERO, Graph, negated
from derive.programs.tape.tape import LEAVES, OPERATION_COST, PARAMETER, Op, Operations, evaluate
from derive.programs.tape.value import Value
from derive.robot.robot import Robot
from tests.programs.tape.test_tape import points, rational_functions
from tests.programs.tape_programs import INPUTS, RATIONAL, RandomProgram, programs
from tests.programs.thresholds import measured, values_tried


def names(count: int = 6) -> tuple[Graph, list[Value], list[Value]]:
    graph = Graph()
    arguments = [Value(graph, graph.input("q", i)) for i in range(count)]
    return graph, arguments, [Value(graph, graph.input(PARAMETER, i)) for i in range(count)]


def improved(*values: Value) -> Operations:
    return cut(*improve(values[0].graph, [value.ref for value in values])).operations


def counted(network: Network) -> int:
    definitions = network.definition.values()
    polynomials = sum(polynomial_cost(d) for d in definitions if isinstance(d, dict))
    return polynomials + sum(OPERATION_COST[d.op] for d in definitions if isinstance(d, Opaque) and d.op is not None)


@given(program=programs(), point=points)
@settings(max_examples=80, deadline=None)
def test_reading_searching_and_redefining_keep_the_values(program: RandomProgram, point: list[Fraction]) -> None:
    inputs, parameters = point[:INPUTS], point[INPUTS:]
    wanted = program.evaluate(inputs, parameters)
    graph = Graph()
    with rational_functions():
        results = program.trace(graph)
        network = network_of(graph, results)
        search = Search(network)
        stages = []
        steps = (lambda: None, lambda: search.run(300), lambda: search.resubstitute(3000), search.move_coefficients)
        for step in steps:
            step()
            assert network.cost == counted(network)
            stages.append(cut(*graph_of(network, graph)))
    for tape in stages:
        assert evaluate(tape, {"q": inputs, PARAMETER: parameters}, RATIONAL) == wanted


@given(program=programs())
@settings(max_examples=60, deadline=None)
def test_the_network_counts_what_the_tape_costs_and_changes_can_be_taken_back(program: RandomProgram) -> None:
    graph = Graph()
    network = network_of(graph, program.trace(graph))
    before, price, mark = dict(network.definition), network.cost, network.mark()
    Search(network).run(500)
    assert cut(*graph_of(network, graph)).operations.cost <= network.cost
    network.undo(mark)
    assert network.definition == before
    assert network.cost == price == counted(network)


SHARED = {
    "pairs of terms whatever their sign": (lambda x, y, z, w, *_: [x + y + z, w - x - y], Operations(add=3)),
    "pairs of factors": (lambda x, y, z, w, *_: [x * y * z, x * w * y], Operations(mul=3)),
    "sums without their factors": (lambda x, y, z, w, *_: [x * z + y * z, x * w - -(y * w)], Operations(mul=2, add=1)),
    "a difference of squares": (
        lambda x, y, z, w, *_: [x * x - y * y, (x + y) * z, (x - y) * w], Operations(mul=3, add=2)
    ),
    "parameters inside sums": (lambda x, y, *n: [n[4] * (n[5] * x + n[6] * y)], Operations(mul=2, add=1)),
}  # fmt: skip


@pytest.mark.parametrize("case", SHARED)
def test_what_occurs_twice_is_computed_once(case: str) -> None:
    _, arguments, parameters = names()
    values, operations = SHARED[case]
    assert improved(*values(*arguments, *parameters)) == operations


def test_multiples_of_a_sum_squares_of_sine_and_cosine_and_sums_that_cancel_save_operations() -> None:
    _, (x, y, z, *_), _ = names()
    sums = [2 * x + 3 * y, 4 * x + 6 * y + z, 6 * x + 9 * y - z]
    assert improved(*sums).total <= 7
    _, (x, y, *_), _ = names()
    s, c = x.sin(), x.cos()
    assert improved(s * s * y + c * c * y).arithmetic == 0
    _, (x, *_), (a, b, *_) = names()
    tape = cut(*improve(x.graph, [(((a + b) - b) * x).ref, ((a + b - a) * x * x).ref]))
    assert tape.hoisted_operations == Operations()


def test_a_coefficient_with_which_values_stand_everywhere_costs_nothing() -> None:
    _, (x, y, u, v, w, z), (a, b, d, *_) = names()
    sums = a * x + b * y, a * y - b * x
    forces = d * (sums[0] * u + sums[1] * v), d * (sums[0] * w - sums[1] * z)
    assert improved(*forces) == Operations(mul=8, add=4)
    # Where one stands without the coefficient too, a product for each sum is as cheap as it gets.
    assert improved(*forces, sums[0], sums[1]) == Operations(mul=10, add=4)


def test_a_trace_is_the_same_in_every_frame() -> None:
    _, (angle, x, y, z, *_), _ = names()
    s, c = angle.sin(), angle.cos()
    first = c * c * x + s * s * y - 2 * s * c * z
    second = s * s * x + c * c * y + 2 * s * c * z
    found = improved(first, second)
    assert found.arithmetic <= 9


def test_no_difference_brings_in_what_a_value_does_not_depend_on() -> None:
    graph, (x, y, *_), (light, heavy, *_) = names()
    small = light * x * y
    both = (light + heavy) * x * y
    large = heavy * x * y
    network = network_of(graph, [value.ref for value in (small, both, large)])
    others = Resubstitution(network)
    for variable, _ in network.polynomials():
        for definition in others.alternatives(variable):
            if len(definition) > 1:
                assert not others.fits(variable, definition) or network.residue[variable] == network.evaluate(
                    definition
                )
    root = network.definition[-1]
    target = root.operands[0].variable
    minus = {(root.operands[1].variable,): 2, (root.operands[2].variable,): 3}
    assert network.evaluate(minus) == network.residue[target]
    assert not others.fits(target, minus)


@given(program=programs())
@settings(max_examples=40, deadline=None)
def test_results_do_not_depend_on_the_run(program: RandomProgram) -> None:
    graphs = [Graph(), Graph()]
    first, second = (cut(*improve(graph, program.trace(graph))) for graph in graphs)
    assert first == second


def test_hoisted_work_is_shared_like_the_body() -> None:
    _, (x, y, *_), (a, b, c, d, *_) = names()
    tape = cut(*improve(x.graph, [((a * b + a * c) * x).ref, ((d * b + d * c) * y).ref]))
    assert tape.operations == Operations(mul=2)
    assert tape.hoisted_operations == Operations(mul=2, add=1)


def test_few_values_are_alive_where_an_order_allows_it() -> None:
    _, variables, _ = names(40)
    squares = [v * v for v in variables]
    total = squares[-1]
    for square in squares[-2::-1]:
        total = square + total
    graph, outputs = improve(total.graph, [total.ref])
    order = schedule(graph, outputs)
    places = {i: step for step, i in enumerate(order)}
    last = {k: places[i] for i in order for k in graph.operands[i] if graph.op[k] not in LEAVES}
    assert max(sum(places[k] <= step < end for k, end in last.items()) for step in range(len(order))) <= 2
    assert all(places[k] < places[i] for i in order for k in graph.operands[i])


def test_a_sum_in_two_products_is_shared_until_nothing_saves() -> None:
    graph, (a, b, c, d, *_), _ = names()
    outputs = [value.ref for value in (a * c + b * c, a * d + b * d)]
    network = network_of(graph, outputs)
    before = network.cost
    Extractor(network).run()
    assert network.cost < before
    assert cut(*graph_of(network, graph)).operations.arithmetic == 3  # (a + b), times c, times d
    settled = network.cost
    Extractor(network).run()
    assert network.cost == settled
    network = network_of(graph, [(a * b).ref])  # what occurs once is left alone
    before = network.cost
    Extractor(network).run()
    assert network.cost == before


def test_residues_are_fixed_scattered_and_follow_the_operations_modulo_a_prime() -> None:
    """2^61 - 1 is prime by Fermat, for enough bases to leave no doubt."""
    assert all(pow(base, PRIME - 1, PRIME) == 1 for base in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37))
    found = [scatter("parameter", k) for k in range(1000)]
    assert found == [scatter("parameter", k) for k in range(1000)]
    assert len(set(found)) == 1000
    assert all(0 <= residue < PRIME for residue in found)
    a, b = scatter("a"), scatter("b")
    assert residue_of(Op.ADD, [a, b]) == (a + b) % PRIME
    assert residue_of(Op.MULTIPLY, [a, b]) == a * b % PRIME
    assert residue_of(Op.NEGATE, [a]) == -a % PRIME


def test_equal_values_are_one_coefficient_however_they_are_computed() -> None:
    graph = Graph()
    a, b = (graph.input(PARAMETER, k) for k in range(2))
    known = Coefficients(graph)
    product = known.multiply(known.same(a), known.same(b))
    assert known.multiply(known.same(b), known.same(a)) == product
    assert known.add(product, negated(product)) == ZERO
    assert known.residue(product) == known.residue(known.same(a)) * known.residue(known.same(b)) % PRIME


@pytest.mark.parametrize("name", [field.name for field in fields(Policy)])
def test_every_threshold_has_a_reason_and_is_tried_below_and_above(name: str) -> None:
    below, above = values_tried(name)
    assert below < getattr(POLICY, name) < above
    assert re.search(rf"# .*\n    {name}: |    {name}: .*  # ", inspect.getsource(Policy))


def test_one_of_both_ways_to_accelerations_is_left_for_every_number_of_joints() -> None:
    assert POLICY.fewest_articulated <= POLICY.most_factorised + 1


def test_an_effort_has_a_name_and_a_search_without_work_finds_less() -> None:
    idle = replace(POLICY, search_work=0, draft_work=0, hoisted_work=0, frame_choice_work=0)
    costs, _ = measured(idle, ["puma560-corke"], ["inertia_matrix"])
    usual = build_program(Robot.load("puma560-corke"), names=["inertia_matrix"])["inertia_matrix"]
    assert usual.tape.operations.cost < costs["puma560-corke", "inertia_matrix"]
    assert effort_named("quick") is Effort.QUICK
    with pytest.raises(DeriveError, match="unknown effort 'most'"):
        effort_named("most")

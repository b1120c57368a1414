"""Operation counts on well known arms are those of docs/benchmarks.md and ``bench/results``, and below all others.

Multiplications, additions and divisions; signs are free, sines and cosines apart, work on parameters alone apart.
"""

from dataclasses import replace
from functools import cache
from itertools import product

import pytest

from bench.operations_report import best_other
from bench.quantities import QUANTITIES
from bench.results import read_json
from bench.robots import COUNTED, load
from derive.programs.build import build_program
from derive.programs.program import Program
from derive.robot.task_rows import task_rows

RESULTS = read_json("operations")["robots"]
USUAL = ("scara-symbolic", "planar-2r-symbolic")
"""Robots whose programs are searched in every run of the tests; the sweep does the others."""

LONG = ("puma560-symbolic", "arm-7r-symbolic")
REMEDY = "fewer are welcome: `make bench` writes the new ones; more are not"


@cache
def program_of(name: str) -> Program:
    return build_program(load(name).robot)


def test_every_robot_of_the_benchmarks_has_its_counts() -> None:
    assert set(RESULTS) == set(COUNTED)


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.sweep] * (n not in USUAL)) for n in COUNTED])
def test_counts_are_the_committed_ones(name: str) -> None:
    program, stated = program_of(name), RESULTS[name]["counts"]["derive"]
    tapes = {quantity.symbol: program[quantity.function].operations for quantity in QUANTITIES}
    found = {symbol: (count.mul, count.add, count.div, count.sin + count.cos) for symbol, count in tapes.items()}
    wanted = {symbol: tuple(cell[kind] for kind in ("mul", "add", "div", "trig")) for symbol, cell in stated.items()}
    assert found == wanted, REMEDY


@pytest.mark.parametrize("name", COUNTED)
@pytest.mark.parametrize("symbol", [quantity.symbol for quantity in QUANTITIES])
def test_every_other_tool_needs_more(name: str, symbol: str) -> None:
    counts = RESULTS[name]["counts"]
    ours, (best, _) = counts["derive"][symbol]["arithmetic"], best_other(counts, symbol)
    assert ours < best or ours == 0


@pytest.mark.parametrize("name", ["scara-symbolic", *(pytest.param(name, marks=pytest.mark.sweep) for name in LONG)])
@pytest.mark.parametrize("function", ["gravity_vector", "inertia_matrix", "inverse_dynamics", "coriolis_matrix"])
def test_gravity_along_the_first_axis_needs_no_first_angle(name: str, function: str) -> None:
    sources = [node.source for node in program_of(name)[function].tape.nodes if node.source is not None]
    assert all((source.kind, source.index) != ("q", 0) for source in sources)


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.sweep] * (n not in USUAL)) for n in COUNTED])
def test_what_follows_from_others_needs_less_than_these_and_the_rest_by_hand(name: str) -> None:
    """Eliminations and products of full matrices, as a library does them."""
    program = program_of(name)
    cost = {function.name: function.operations.total for function in program}
    n, m = program["jacobian"].shape[1], len(task_rows(load(name).robot))
    square, elimination = 2 * m * m * n, 2 * m**3 // 3
    assert cost["jacobian_hessian"] < n * cost["jacobian_dot"]
    assert cost["wrench_torques"] < cost["jacobian"] + 11 * n
    assert cost["wrench_torques_end"] < cost["jacobian_end"] + 11 * n
    assert cost["wrench_torques_dq"] < cost["jacobian_hessian"] + 11 * n * n
    assert cost["wrench_torques_end_dq"] < cost["jacobian_hessian"] + cost["jacobian"] + 22 * n * n
    assert cost["manipulability"] < cost["jacobian"] + (elimination if m == n else square + elimination)
    by_hand = cost["jacobian"] + cost["jacobian_hessian"] + square + 3 * elimination + n * (square + 2 * m * m)
    assert cost["manipulability_dq"] < by_hand
    by_hand = cost["jacobian"] + cost["inertia_matrix"] + 2 * n**3 // 3 + 2 * n * n * m + square + 2 * m**3
    assert cost["task_inertia"] < by_hand


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.sweep] * (n not in USUAL)) for n in COUNTED])
def test_dynamics_under_a_wrench_need_less_than_without_and_what_joints_feel_of_it(name: str) -> None:
    plain = ("inverse_dynamics", "forward_dynamics", "inverse_dynamics_dq")
    names = {f"{stem}{suffix}" for stem in ("wrench_torques", *plain) for suffix in ("", "_dq", "_end", "_end_dq")}
    names |= {f"{stem}_wrench{suffix}" for stem in plain[:2] for suffix in ("", "_dq", "_end", "_end_dq")}
    robot = replace(load(name).robot, wrench=("world", "end"))
    cost = {function.name: function.operations.cost for function in build_program(robot, names=names)}
    for function, axes in product(plain, ("", "_end")):
        order, stem = "_dq" * function.endswith("_dq"), function.removesuffix("_dq")
        assert cost[f"{stem}_wrench{axes}{order}"] < cost[function] + cost[f"wrench_torques{axes}{order}"]

"""Operations are counted alike in tapes, in printed code and in CasADi's graphs."""

import ast

import casadi
import pytest

from bench.counting.casadi_graph import count_casadi, shared
from bench.counting.counts import Counts
from bench.counting.python_source import count_nodes, count_python
from bench.operations import _row
from bench.ours import OURS, program_of, tape_counts
from bench.quantities import QUANTITIES
from bench.robots import load
from derive.targets.numpy import render_numpy
from tests.targets.generated_models import source_of

SMALL = ("planar-2r-numeric", "planar-2r-symbolic")


@pytest.mark.parametrize("text", ["x**2 + y", "-x*x - -y", "x*(x + y)"])
def test_signs_are_free_and_a_square_is_one_multiplication(text: str) -> None:
    x, y = casadi.SX.sym("x"), casadi.SX.sym("y")
    expressions = {"x**2 + y": x**2 + y, "-x*x - -y": -x * x - -y, "x*(x + y)": x * (x + y)}
    function = casadi.Function("f", [x, y], [expressions[text]])
    assert count_nodes(ast.parse(text)) == count_casadi(shared(function)) == Counts(mul=1, add=1)


def test_equal_sines_count_once_other_functions_apart_and_other_powers_not() -> None:
    counts = count_nodes(ast.parse("a = sin(q) + sin(q)*cos(q)\nb = math.sqrt(a)"))
    assert counts == Counts(mul=1, add=1, trig=2, other=1)
    with pytest.raises(ValueError, match="multiplications"):
        count_nodes(ast.parse("x**-1"))


@pytest.mark.parametrize("name", SMALL)
def test_counts_of_the_tape_are_those_of_the_generated_module(name: str) -> None:
    robot = load(name).robot
    program = program_of(robot)
    source = render_numpy(source_of(robot, program))["model_numpy.py"]
    counts = {function.name: tape_counts(function) for function in program}
    assert {function: count_python(source, f"_{function}") for function in counts} == counts


@pytest.mark.parametrize("name", SMALL)
def test_our_own_figures_belong_to_results_that_are_right(name: str) -> None:
    case = load(name)
    row = _row(OURS, case)
    assert {cell["arithmetic"] for cell in row.values()} == {
        tape_counts(program_of(case.robot)[quantity.function]).arithmetic for quantity in QUANTITIES
    }
    assert not [cell for cell in row.values() if cell["error"] > 1e-12]

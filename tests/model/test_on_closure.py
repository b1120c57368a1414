"""What names of passive joints are where loops are closed: the joined frames meet, and stay together."""

from itertools import islice

import mpmath
import pytest
import sympy

from derive.checking.latex.quantities import slope
from derive.errors import CheckError
from derive.lecture.sympy_conversion import Matrix, expression_from_sympy
from derive.model.closure import OnClosure
from derive.model.equality import DIGITS, compare, evaluate, samples
from derive.robot.coupling import derivatives
from derive.robot.expression import ZERO, Name, names
from tests.model.test_loops import ROBOTS, model_of

every = pytest.mark.parametrize("name", ROBOTS)


def gap(name: str) -> Matrix:
    """The way between the joined frames, from forward kinematics alone."""
    one, other = (model_of(name).frame(row)[:3, 3] for row in ("coupler", "rocker"))
    if name == "rod":
        return sympy.Matrix([(one - other).dot(one - other) - sympy.Symbol("l2") ** 2])
    return sympy.Matrix(one - other)


@every
def test_samples_are_closed_and_move_along_the_loop(name: str) -> None:
    robot, start = model_of(name).robot, gap(name)
    speed = slope(robot, start, "t")
    formulas = [expression_from_sympy(e) for e in (*start, *speed, *slope(robot, speed, "t")) if e != 0]
    wanted = sorted({n for e in formulas for n in names(e)})
    points = list(islice(samples(robot, wanted), 4))
    assert len(points) == 4
    with mpmath.workdps(DIGITS):
        assert all(abs(evaluate(e, point)) < 1e-35 for point in points for e in formulas)


@every
def test_what_the_closure_says_is_proven_exactly_and_nothing_else(name: str) -> None:
    model = model_of(name)
    robot, first = model.robot, next(e for e in gap(name) if e != 0)
    assert compare(robot, expression_from_sympy(first), ZERO).exact
    wrong = compare(robot, expression_from_sympy(first.subs(sympy.Symbol("l1"), 2 * sympy.Symbol("l1"))), ZERO)
    assert not wrong.equal
    assert wrong.counter_example is not None
    (joint, by), derivative = next((key, e) for key, e in derivatives(robot).items() if len(key) == 2)
    row, column = [j.variable for j in robot.passive].index(joint), list(map(str, model.q)).index(by)
    formula = expression_from_sympy(model.G[row, column])
    assert compare(robot, formula, derivative).exact
    assert not compare(robot, formula, Name(by)).equal
    on = OnClosure(robot)
    assert {*names(on.reduced(derivative))} <= {*on.free, *(each.variable for each in robot.passive)}
    with pytest.raises(CheckError, match="along a closed loop"):  # a partial derivative could be that of the tree
        slope(robot, model.B, by)

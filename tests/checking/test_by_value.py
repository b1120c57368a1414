"""Formulas that are named by their values: every quantity is found, and no formula with a slip."""

import pytest

from derive.checking.by_value import ByValue
from derive.checking.latex.left import taken_apart
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.quantities import own_quantity, slope
from derive.lecture.sympy_conversion import Matrix, expression_from_sympy
from derive.model.model import Model
from derive.robot.expression import ZERO, Expression, Name, Sum, add, multiply, names, negate, number
from derive.robot.robot import Robot

ROBOTS = ("anthropomorphic-arm", "scara-perugia", "stanford-laschi", "planar-3r")
MODELS = {name: Model(Robot.load(name)) for name in ROBOTS}


def table(value: Matrix) -> Table:
    return Table(tuple(tuple(Entry(expression_from_sympy(e)) for e in row) for row in value.tolist()))


def moves(e: Expression, model: Model) -> bool:
    """Whether a formula says more than an abbreviation does."""
    joints = {joint.variable for joint in model.robot.joints}
    several = any(not isinstance(term, Name) for term in e.terms) if isinstance(e, Sum) else len(set(names(e))) > 1
    return several and not joints.isdisjoint(names(e))


@pytest.mark.parametrize("robot", ROBOTS)
def test_positions_axes_and_jacobians_are_found_in_the_axes_of_every_frame(robot: str) -> None:
    model = MODELS[robot]
    known = ByValue(model, None)
    n = model.n
    for i in range(n):
        turn = model.frame(i)[:3, :3].T
        for value in (
            turn * (model.frame(n) - model.frame(max(i - 1, 0)))[:3, 3],
            turn * model.frame(n)[:3, :3],
            turn * model.quantity("J")[:3, :],
        ):
            printed = table(value)
            if any(moves(entry.formula, model) for entry in printed.entries):
                assert known.quantity(printed, None)


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_wrong_sign_of_a_term_or_a_factor_is_no_quantity(robot: str) -> None:
    model = MODELS[robot]
    known = ByValue(model, None)
    formulas = [expression_from_sympy(e) for e in model.quantity("T")[:3, 3]]
    sums = [e for e in formulas if isinstance(e, Sum) and moves(e, model)]
    assert sums
    for e in sums:
        assert known.quantity(e, None)
        for k, term in enumerate(e.terms):
            for slip in (negate(term), multiply(number(2), term)):
                assert not known.quantity(add(*e.terms[:k], slip, *e.terms[k + 1 :]), None)
        assert not known.quantity(Table(((Entry(e),), (Entry(negate(e)),), (Entry(ZERO),))), None)


def test_energies_inertias_and_velocities_are_found() -> None:
    model = Model(Robot.load("planar-2r-perugia"))
    known = ByValue(model, None)
    assert known.quantity(expression_from_sympy(own_quantity(model, "kinetic[2]")), None).startswith("kinetic[2]")
    assert known.quantity(expression_from_sympy(model.quantity("B")[0, 1]), None).startswith("B[1,2]")
    assert known.quantity(expression_from_sympy(model.quantity("g")[0]), None) == "g[1]"
    velocity = slope(model.robot, own_quantity(model, "centre[2]"), "t")
    assert known.quantity(table(velocity), None) == "linear velocity of centre[2]"


@pytest.mark.parametrize(
    ("name", "found"), [("x", False), ("y", True), ("k", True), ("x_1", False), ("y_1", True), ("y_2", False)]
)
def test_a_coordinate_is_one_of_its_own_axis_and_point(name: str, found: bool) -> None:
    model = MODELS["planar-3r"]
    height = expression_from_sympy(model.quantity("T[0,1]")[1, 3])
    assert bool(ByValue(model, None).quantity(height, taken_apart(name))) is found

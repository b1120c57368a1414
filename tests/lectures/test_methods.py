"""The Newton-Euler equations of the notes, and the general formulas of their Lagrange chapter."""

from __future__ import annotations

import numpy as np
import pytest

from derive.algebra.domain import PolynomialDomain
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.lectures.lagrange_formulas import FORMULAS
from tests.lectures.method_results import METHODS, SETS, arms, method_results, recursion_of, variants

ROBOTS_WITH_ROTORS = ("planar-2r-perugia", "scara-perugia", "scara-perugia-zup")


@pytest.mark.parametrize("name", SETS)
def test_the_equations_are_confirmed(name: str) -> None:
    assert not [result.entry for result in method_results(name) if not result.confirmed]


def test_each_of_two_slips_in_one_equation_is_wrong_alone() -> None:
    assert not [text for text, holds in variants() if holds]


@pytest.mark.parametrize("robot", arms(), ids=lambda robot: robot.name)
def test_both_sets_give_the_same_torques(robot: Robot) -> None:
    base, link = (recursion_of(name, robot).torques for name in SETS)
    np.testing.assert_allclose(base, link, rtol=1e-12)


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("robot", arms()[:2], ids=lambda robot: robot.name)
def test_the_torques_are_those_of_lagrange_identically(robot: Robot, name: str) -> None:
    lagrange = [expression_from_sympy(entry) for entry in Model(robot).tau]
    domain = PolynomialDomain(robot, lagrange)
    rates = [domain.rate(i) for i in range(robot.n)]
    recursion = SETS[name](robot, domain, rates, [domain.acceleration(i) for i in range(robot.n)])
    assert [domain.constant(entry) for entry in lagrange] == list(recursion.torques)


def test_gravity_enters_through_the_acceleration_of_the_base() -> None:
    assert METHODS["initial_conditions"]["status"] == "ok"
    for name in SETS:
        first, *_, last = recursion_of(name, arms()[2]).links
        assert (first.previous.w, first.previous.wd, first.previous.v) == ((0.0, 0.0, 0.0),) * 3
        assert first.previous.vd == (0.0, 0.0, 9.8062)
        assert last.following.f == last.following.n == (0.0, 0.0, 0.0)


def test_only_stopping_at_the_first_joint_gives_all_torques() -> None:
    (erratum,) = METHODS["algorithm"]["errata"]
    n = 5

    def visited(stop: int) -> int:
        return len(range(n, stop - 1, -1))

    assert visited({"n": n, "1": 1}[erratum["printed_stop"]]) < n
    assert visited({"n": n, "1": 1}[erratum["correct_stop"]]) == n


def test_every_general_formula_of_lagrange_is_tested() -> None:
    assert {item["name"] for item in METHODS["lagrange"]} == FORMULAS.keys()


@pytest.mark.parametrize("robot", ROBOTS_WITH_ROTORS)
@pytest.mark.parametrize("formula", FORMULAS)
def test_a_general_formula_of_lagrange_holds(formula: str, robot: str) -> None:
    assert FORMULAS[formula](Model(Robot.load(robot)))

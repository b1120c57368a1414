"""Printed equations of motion against those of a cart with a pole that are derived here from its energies."""

import random

import pytest
import sympy

from derive.checking.motions import Motions
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.model import Model
from tests.rows import robot_of_rows

CART = """
base: [[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
gravity: [0, -g, 0]
links: [{mass: M, com: [0, 0, 0]}, {mass: m, com: [0, 0, 0]}]
"""
NAMES = "x theta xd thetad xdd thetadd M m l g"


class Points(dict[str, float]):
    """A random value for every name."""

    def __missing__(self, name: str) -> float:
        return random.Random(name).uniform(0.3, 1.7)


@pytest.fixture(scope="module")
def motions() -> Motions:
    return Motions(Model(robot_of_rows("P q: x, alpha: pi/2 | R q: theta, a: l", CART)), [Points()])


def equations() -> list[sympy.Expr]:
    """M(q) qdd + ... of both coordinates by Lagrange, with the pole upright at theta = 0."""
    x, theta, xd, thetad, xdd, thetadd, big, m, length, g = sympy.symbols(NAMES)
    speed = (xd + length * thetad * sympy.cos(theta)) ** 2 + (length * thetad * sympy.sin(theta)) ** 2
    lagrangian = big * xd**2 / 2 + m * speed / 2 - m * g * length * sympy.cos(theta)
    rates = {x: xd, theta: thetad, xd: xdd, thetad: thetadd}
    return [
        sum(lagrangian.diff(v).diff(name) * rate for name, rate in rates.items()) - lagrangian.diff(q)
        for q, v in ((x, xd), (theta, thetad))
    ]


def test_an_acceleration_holds_where_the_force_in_it_drives_alone(motions: Motions) -> None:
    force, xdd, thetadd = sympy.symbols("?u xdd thetadd")
    pushed, falling = equations()
    solved = sympy.solve([pushed - force, falling], [xdd, thetadd])
    for name in (xdd, thetadd):
        zero = name - solved[name]
        assert motions.driven(expression_from_sympy(zero), ["u"]) == "where tau[1] = u alone drives"
        assert motions.driven(expression_from_sympy(zero + sympy.Symbol("theta") / 100), ["u"]) == ""


def test_a_linear_equation_holds_near_rest_and_one_that_is_not_linear_does_not(motions: Motions) -> None:
    force, theta = sympy.symbols("?u theta")
    names = sympy.symbols(NAMES)[1:6]
    pushed = equations()[0] - force
    linear = pushed.subs(dict.fromkeys(names, 0)) + sum(pushed.diff(n).subs(dict.fromkeys(names, 0)) * n for n in names)
    assert motions.driven(expression_from_sympy(linear.expand()), ["u"]).endswith(
        "near rest with all joint variables zero"
    )
    assert motions.driven(expression_from_sympy(linear + theta**3), ["u"]) == ""
    assert motions.driven(expression_from_sympy(linear + theta / 10), ["u"]) == ""


def test_an_equation_divided_by_a_mass_is_that_of_its_torque(motions: Motions) -> None:
    falling = (equations()[1] / sympy.Symbol("m")).expand()
    name, right = motions.meant(expression_from_sympy(falling))
    assert name == "tau[2]/(m)"
    assert right is not None

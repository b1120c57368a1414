"""Closed forms at a point are the numbers of the independent recursion, and partial numbers leave the rest."""

import random
from fractions import Fraction

import numpy as np
import pytest
import sympy

from derive.errors import DeriveError, QuantityError
from derive.lecture.point import at_point
from derive.model.model import Model
from derive.robot.cells import typed_point
from derive.robot.expression import Number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

FUNCTIONS = {
    "T": ("forward_kinematics", 1),
    "J": ("jacobian", 1),
    "B": ("inertia_matrix", 1),
    "g": ("gravity_vector", 1),
    "Cqd": ("coriolis_vector", 2),
    "tau": ("inverse_dynamics", 3),
}


@pytest.mark.parametrize("name", ["puma560-corke", "scara-matlab"])
def test_every_number_is_that_of_the_independent_recursion(name: str) -> None:
    robot = Robot.load(name)
    rng = random.Random(3)
    states = [[round(rng.uniform(-1, 1), 3) for _ in range(robot.n)] for _ in range(3)]
    texts = [", ".join(map(str, state)) for state in states]
    point = typed_point(robot, [texts[0]], texts[1], texts[2])
    turn = np.pi / 180 if robot.units.degrees else 1.0
    scale = np.array([turn if joint.is_revolute else 1.0 for joint in robot.joints])
    oracle = Oracle.of(robot, {})
    for quantity, (function, count) in FUNCTIONS.items():
        ours = np.array(at_point(Model(robot).quantity(quantity), point).tolist(), dtype=float)
        theirs = oracle.evaluate(function, *(np.array(state) * scale for state in states[:count]))
        np.testing.assert_allclose(ours.reshape(np.shape(theirs)), theirs, rtol=0, atol=1e-12 * (1 + abs(theirs).max()))


def value(text: str) -> Number:
    return Number(Fraction(text))


def test_what_has_no_number_stays_and_all_digits_keep_roots() -> None:
    a, b, q = sympy.symbols("a b q")
    found = at_point(a * sympy.cos(q) + b**2 * sympy.sin(q), {"q": value("0"), "b": value("2")})
    assert found == a
    assert at_point(sympy.Matrix([a * b]), {"a": value("3"), "b": value("0.5")}) == sympy.Matrix([sympy.Rational(3, 2)])
    q, a = sympy.symbols("q a")
    quarter = typed_point(Robot.load("planar-2r-perugia"), ["q1=pi/4"])["q1"]
    assert at_point(a * sympy.cos(q), {"q": quarter}, exact=True) == sympy.sqrt(2) * a / 2


def test_numbers_beside_symbols_are_rounded_as_they_are_printed_and_whole_results_are_not() -> None:
    model = Model(Robot.load("planar-2r-perugia"))
    assert str(model.at("T", [0.3, 0.5])[0, :]) == "Matrix([[0.696707, -0.717356, 0, 0.955336*a1 + 0.696707*a2]])"
    assert str(model.at("detJ", [0.3, 0.5], digits=3)) == "0.479*a1*a2"
    assert str(model.at("B", [0, "pi/3"])[1, 1]) == "Il2 + Im2*kr2**2 + l2**2*ml2"
    assert str(model.at("p[1]", ["pi/4", 0], exact=True)) == "sqrt(2)*a1/2 + sqrt(2)*a2/2"
    long = model.at("p[1]", [0.3, 0.5], digits=None).coeff(sympy.Symbol("a1"))
    assert abs(long - sympy.cos(sympy.Rational(3, 10))).evalf(40) < 1e-29
    number = model.at("p[1]", [0.3, 0.5], values={"a1": 1, "a2": 1})
    assert number.is_Rational
    assert len(str(number)) > 30


def test_what_cancels_exactly_is_zero_and_what_is_small_is_not() -> None:
    q, a = sympy.symbols("q a")
    third = typed_point(Robot.load("planar-2r-perugia"), ["q1=pi/3"])["q1"]
    assert at_point(2 * sympy.cos(q) - 1, {"q": third}) == 0
    assert at_point(a * sympy.cos(q) - 1, {"q": third, "a": value("2.0000000000000000001")}) > 0


def test_an_angle_without_direction_is_refused() -> None:
    x, q = sympy.symbols("x q")
    for exact in (True, False):
        with pytest.raises(QuantityError, match="phi has no finite real value"):
            at_point(sympy.atan2(x, sympy.sin(q)), {"x": value("0"), "q": value("0")}, name="phi", exact=exact)
        with pytest.raises(QuantityError):
            at_point(1 / x, {"x": value("0")}, exact=exact)
        with pytest.raises(QuantityError):
            at_point(sympy.sqrt(x), {"x": value("-2")}, exact=exact)


def test_a_model_gives_the_same_numbers() -> None:
    robot = Robot.load("planar-2r-perugia")
    typed = typed_point(robot, ["0.3, pi/4", "a1=0.5,a2=0.4"], "1, -2")
    model = Model(robot)
    found = model.at("J_dot", [0.3, "pi/4"], qd=[1, -2], values={"a1": 0.5, "a2": "2/5"})
    assert found == at_point(model.J_dot, typed)
    half = sympy.sqrt(2) * sympy.prod(sympy.symbols("a1 a2")) / 2
    assert model.at("det(J)", values={"q2": "pi/4"}, exact=True) == half
    with pytest.raises(DeriveError):
        model.at("T", [0.3])


def test_parameters_of_the_file_have_their_numbers_unless_others_are_typed() -> None:
    robot = Robot.load("puma560-corke")
    assert typed_point(robot, ["[1, 2, 3, 4, 5, 6]"])["a2"] == value("0.4318")
    assert typed_point(robot, ["a2=1/2"])["a2"] == value("0.5")
    with pytest.raises(DeriveError, match="q7"):
        typed_point(robot, ["q7=1"])

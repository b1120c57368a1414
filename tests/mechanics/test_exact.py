"""Exact polynomials of position, Jacobian, inertia and gravity against the recursions in floats."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.algebra.domain import PolynomialDomain, polynomial_expression
from derive.algebra.ring import Polynomial
from derive.mechanics.exact_dynamics import Dynamics
from derive.mechanics.exact_kinematics import Kinematics
from derive.mechanics.floats import value_at
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import number
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from tests.random_robots import robot_text


@pytest.mark.parametrize("seed", range(6))
def test_exact_quantities_have_the_values_of_the_recursions(seed: int) -> None:
    robot = Robot.from_text(robot_text(random.Random(seed), 1 + seed % 3))
    numbers = tuple(
        (name, number(Fraction(k + 2, 7))) for k, name in enumerate(free_symbols(replace(robot, runtime=())))
    )
    robot = replace(robot, parameters=(*robot.parameters, *numbers), runtime=())
    domain = PolynomialDomain(robot)
    q = np.random.default_rng(seed).uniform(-2, 2, len(robot.joints))
    values = parameter_values(robot) | dict(zip((joint.variable for joint in robot.joints), q, strict=True))

    def value(p: Polynomial) -> float:
        return to_float(polynomial_expression(p, domain), values)

    kinematics, dynamics = Kinematics(robot, domain), Dynamics(robot, domain)
    end = [value(x) for x in kinematics.end.position]
    assert end == pytest.approx([row[3] for row in value_at(robot, "T", q)[:3]], abs=1e-12)
    columns = kinematics.linear_columns(kinematics.end.position)
    assert (
        pytest.approx(np.array(value_at(robot, "J", q))[:3], abs=1e-12)
        == np.array([[value(x) for x in column] for column in columns]).T
    )
    inertia = [[value(dynamics.expand(entry)) for entry in row] for row in dynamics.inertia_matrix]
    assert np.array(inertia) == pytest.approx(np.array(value_at(robot, "B", q)), rel=1e-10, abs=1e-12)
    gravity = [[value(entry)] for entry in kinematics.gravity_vector]
    assert np.array(gravity) == pytest.approx(np.array(value_at(robot, "g", q)), rel=1e-10, abs=1e-10)

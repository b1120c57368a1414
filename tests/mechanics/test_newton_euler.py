"""Two derivations of the dynamics, Lagrange and Newton-Euler, agree identically: the same polynomials."""

from __future__ import annotations

import random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from derive.algebra.domain import PolynomialDomain
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.mechanics.chain import build_chain
from derive.mechanics.newton_euler import inverse_dynamics
from derive.mechanics.printed_newton_euler import newton_euler_base, newton_euler_link, without_rotors
from derive.model.model import Model
from derive.robot.description import Convention
from derive.robot.expression import Expression, Name, multiply
from derive.robot.names import velocity_name
from derive.robot.robot import Robot
from tests.random_robots import catalogue, robot_text

MAX_JOINTS = 4
CATALOGUE = [*catalogue().values()]
SMALL = [robot for robot in CATALOGUE if robot.has_dynamics and robot.n <= MAX_JOINTS]
STANDARD = [without_rotors(robot) for robot in SMALL if robot.convention is Convention.STANDARD]


def lagrange(robot: Robot) -> list[Expression]:
    """B qdd + C qd + g, in the closed form that users see, friction taken off."""
    model = Model(robot)
    pairs = zip(model.tau, model.friction, strict=True)
    return [expression_from_sympy(torque - friction) for torque, friction in pairs]


def viscous(robot: Robot, i: int) -> Expression:
    return multiply(robot.links[i].viscous, Name(velocity_name(robot.joints[i].variable)))


def check_identity(robot: Robot) -> None:
    torques = lagrange(robot)
    domain = PolynomialDomain(robot, torques)
    rates = [domain.rate(i) for i in range(robot.n)]
    accelerations = [domain.acceleration(i) for i in range(robot.n)]
    traced = inverse_dynamics(build_chain(robot, domain), rates, accelerations)
    assert [domain.constant(torque) - other for torque, other in zip(torques, traced, strict=True)] == [0] * robot.n


@pytest.mark.parametrize("robot", SMALL, ids=lambda robot: robot.name)
def test_every_small_robot_of_the_catalogue(robot: Robot) -> None:
    check_identity(robot)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(n=st.integers(1, 3), seed=st.integers(0, 2**32 - 1))
def test_random_robots(n: int, seed: int) -> None:
    check_identity(Robot.from_text(robot_text(random.Random(seed), n)))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_random_robots_with_four_joints(seed: int) -> None:
    check_identity(Robot.from_text(robot_text(random.Random(seed), MAX_JOINTS)))


@pytest.mark.parametrize("recursion", [newton_euler_base, newton_euler_link])
@pytest.mark.parametrize("robot", STANDARD, ids=lambda robot: robot.name)
def test_the_recursions_of_the_lectures(robot: Robot, recursion: object) -> None:
    torques = lagrange(robot)
    domain = PolynomialDomain(robot, torques)
    rates = [domain.rate(i) for i in range(robot.n)]
    found = recursion(robot, domain, rates, [domain.acceleration(i) for i in range(robot.n)])  # type: ignore[operator]
    friction = [domain.constant(viscous(robot, i)) for i in range(robot.n)]
    assert [domain.constant(t) + b for t, b in zip(torques, friction, strict=True)] == list(found.torques)

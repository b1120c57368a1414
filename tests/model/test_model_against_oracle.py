"""Closed forms against the independent recursion in floats, on random robots of every kind."""

from __future__ import annotations

import random
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from derive.model.model import Model
from derive.robot.load import catalogue_names
from derive.robot.names import number_of, robot_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from derive.verification.oracle.lagrange import com_jacobians, rotor_jacobians
from tests.evaluate import evaluate
from tests.random_robots import catalogue, robot_text

CATALOGUE_WITH_LINKS = [name for name, robot in catalogue().items() if robot.has_dynamics]


class Numbers:
    """A model with a number for everything: symbols by name, a configuration, rates and accelerations."""

    def __init__(self, robot: Robot, seed: int) -> None:
        rng = random.Random(seed)
        self.model = Model(robot)
        parameters = {name: rng.uniform(0.3, 1.7) for name in robot_symbols(robot) if name not in number_of(robot)}
        self.oracle = Oracle.of(robot, parameters)
        self.q, self.qd, self.qdd = (np.array([rng.uniform(-2, 2) for _ in range(robot.n)]) for _ in range(3))
        self.values: dict[str, float] = dict(parameters)
        self.values |= {name: float(_sympy(value)) for name, value in number_of(robot).items()}
        for symbols, numbers in (
            (self.model.q, self.q),
            (self.model.qd, self.qd),
            (self.model.qdd, self.qdd),
        ):
            self.values |= {s.name: float(x) for s, x in zip(symbols, numbers, strict=True)}

    def value(self, expression: Any) -> Any:
        return evaluate(expression, self.values)


def _sympy(value: Any) -> Any:
    from derive.lecture.sympy_conversion import expression_to_sympy

    return expression_to_sympy(value)


def close(ours: Any, theirs: Any) -> None:
    theirs = np.asarray(theirs, dtype=float).reshape(np.shape(ours))
    scale = max(1.0, float(np.max(np.abs(theirs), initial=0.0)))
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-11 * scale)


def check_kinematics(n: Numbers) -> None:
    close(n.value(n.model.T), n.oracle.evaluate("forward_kinematics", n.q))
    links = n.oracle.evaluate("link_transforms", n.q)
    for i in range(1, n.model.n + 1):
        close(n.value(n.model.frame(i)), links[i - 1])
    jacobian = n.oracle.evaluate("jacobian", n.q)
    close(n.value(n.model.J), jacobian)
    rotation = n.oracle.evaluate("forward_kinematics", n.q)[:3, :3]
    close(n.value(n.model.J_end), np.vstack([rotation.T @ jacobian[:3], rotation.T @ jacobian[3:]]))


def check_dynamics(n: Numbers) -> None:
    model = n.model
    close(n.value(model.B), n.oracle.evaluate("inertia_matrix", n.q))
    close(n.value(model.C), n.oracle.evaluate("coriolis_matrix", n.q, n.qd))
    close(n.value(model.g), n.oracle.evaluate("gravity_vector", n.q))
    close(n.value(model.tau), n.oracle.evaluate("inverse_dynamics", n.q, n.qd, n.qdd))
    b = n.oracle.evaluate("inertia_matrix", n.q)
    close(n.value(model.energy.kinetic), n.qd @ b @ n.qd / 2)
    skew = n.value(model.N)
    close(skew, -skew.T)
    close(skew, n.value(model.Bdot) - 2 * n.value(model.C))


def check_body_jacobians(n: Numbers) -> None:
    coms, rotors = com_jacobians(n.oracle.arm, n.q), rotor_jacobians(n.oracle.arm, n.q)
    for i in range(1, n.model.n + 1):
        close(n.value(n.model.Jv_com(i)), coms[0][i - 1])
        close(n.value(n.model.Jw_com(i)), coms[1][i - 1])
        close(n.value(n.model.Jv_motor(i)), rotors[0][i - 1])


@cache
def numbers_of(name: str) -> Numbers:
    return Numbers(Robot.load(name), seed=7)


@pytest.mark.parametrize("name", catalogue_names())
def test_kinematics_of_every_built_in_robot_agrees_with_the_oracle(name: str) -> None:
    check_kinematics(numbers_of(name))


@pytest.mark.parametrize("name", CATALOGUE_WITH_LINKS)
def test_dynamics_of_every_built_in_robot_agrees_with_the_oracle(name: str) -> None:
    check_dynamics(numbers_of(name))
    check_body_jacobians(numbers_of(name))


@settings(max_examples=18, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 10**6), n=st.integers(1, 4))
def test_closed_forms_of_random_robots_agree_with_the_oracle(seed: int, n: int) -> None:
    robot = Robot.from_text(robot_text(random.Random(seed), n))
    numbers = Numbers(robot, seed)
    check_kinematics(numbers)
    if robot.has_dynamics:
        check_dynamics(numbers)
        check_body_jacobians(numbers)


@pytest.mark.slow
@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(1, marks=pytest.mark.sweep),
        pytest.param(4, marks=pytest.mark.sweep),
        5,
        pytest.param(7, marks=pytest.mark.sweep),
    ],
)
def test_closed_forms_of_long_random_robots_agree_with_the_oracle(seed: int) -> None:
    robot = Robot.from_text(robot_text(random.Random(1000 + seed), 5 + seed % 2))
    numbers = Numbers(robot, seed)
    check_kinematics(numbers)
    if robot.has_dynamics:
        check_dynamics(numbers)


@settings(max_examples=25, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 10**6), n=st.integers(1, 3))
def test_analytic_jacobians_are_the_derivatives_of_the_angles(seed: int, n: int) -> None:
    numbers = Numbers(Robot.from_text(robot_text(random.Random(seed), n)), seed)
    model, step = numbers.model, 1e-6
    for kind, angles in (("rpy", model.rpy), ("zyz", model.euler_zyz)):
        column = 0 if kind == "rpy" else 2
        rotation = numbers.value(model.R)
        if np.hypot(rotation[0, column], rotation[1, column]) < 0.05:
            continue
        jacobian = numbers.value(model.J_analytic(kind))
        for k, symbol in enumerate(model.q):
            here = numbers.values[symbol.name]
            samples = []
            for shift in (step, -step):
                numbers.values[symbol.name] = here + shift
                samples.append(numbers.value(angles).ravel())
            numbers.values[symbol.name] = here
            change = (samples[0] - samples[1] + np.pi) % (2 * np.pi) - np.pi
            np.testing.assert_allclose(jacobian[3:, k], change / (2 * step), atol=1e-5)

"""The closed forms of regressors and base parameters, and the functions generated for identification."""

import random

import numpy as np
import numpy.typing as npt
import pytest

from derive.errors import Location
from derive.model.model import Model
from derive.programs.build import build_program
from derive.programs.program import Program
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.inertial_parameters import REGRESSOR_JOINTS, has_regressor, standard_parameters
from derive.robot.names import robot_symbols
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.evaluate import evaluate
from tests.programs.formulations.test_recursions import random_state, value
from tests.random_robots import catalogue, random_robot, robot_text, seeds

SMALL = [robot for robot in catalogue().values() if robot.has_dynamics and robot.n <= 4]
RANDOM = [Robot.from_text(robot_text(random.Random(seed), 1 + seed % 3)) for seed in range(9)]


def numbers_for(model: Model) -> dict[str, float]:
    rng = random.Random(1)
    known = {name: float(number) for name, number in parameter_values(model.robot).items()}
    symbols = [*robot_symbols(model.robot), *map(str, (*model.q, *model.qd, *model.qdd))]
    return {**{name: rng.uniform(0.3, 1.5) for name in symbols}, **known}


@pytest.mark.parametrize("robot", SMALL + RANDOM, ids=lambda robot: robot.name)
def test_closed_forms_give_the_torques(robot: Robot) -> None:
    model = Model(robot)
    values = numbers_for(model)

    def at(name: str) -> npt.NDArray[np.float64]:
        result: npt.NDArray[np.float64] = evaluate(getattr(model, name), values)
        return result

    torques = at("tau")
    tolerance = 1e-10 * np.abs(torques).max()
    np.testing.assert_allclose(at("regressor") @ at("standard_parameters"), torques, atol=tolerance)
    np.testing.assert_allclose(at("regressor_base") @ at("base_parameters"), torques, atol=tolerance)
    assert model.regressor.shape == (robot.n, len(model.standard_parameter_names))
    assert model.base_parameters.shape == (len(model.base_parameter_names), 1)


def test_a_planar_arm_has_the_base_parameters_of_the_books() -> None:
    """Siciliano et al., Robotics, section 7.2.2, with masses of rotors and the first one's inertia."""
    model = Model(Robot.load("planar-2r-perugia"))
    found = dict(zip(model.base_parameter_names, map(str, model.base_parameters), strict=True))
    assert found["mx1"] == "a1*(ml2 + mm2) + l1*ml1"
    assert found["Izz1"] == "Il1 + Im1*kr1**2 + a1**2*(ml2 + mm2) + l1**2*ml1"
    assert found["mx2"] == "l2*ml2"
    assert found["Izz2"] == "Il2 + l2**2*ml2"
    assert found["Im2"] == "Im2"


def identification_program(robot: Robot) -> Program:
    return build_program(robot, names=("regressor", "base_regressor", "base_parameters"))


@pytest.mark.parametrize("seed", seeds(10, usual=4))
def test_generated_functions_give_the_torques_and_what_the_formulas_say(seed: int) -> None:
    drawn = random_robot(random.Random(seed), 1 + seed % 6)
    robot = Robot.from_text(drawn.text)
    program = identification_program(robot)
    state = random_state(program, robot.n, drawn.values, seed)
    chosen = dict(zip(program.parameters, state.parameters, strict=True))
    oracle = Oracle.of(robot, chosen)
    torques = oracle.evaluate("inverse_dynamics", state.q, state.qd, state.qdd)
    parameters = value(program, "base_parameters", state)
    base = value(program, "base_regressor", state) @ parameters
    np.testing.assert_allclose(base, torques, atol=1e-12 * np.abs(torques).max(), rtol=0)
    assert program["regressor"].shape == (robot.n, len(standard_parameters(robot)))
    values = parameter_values(robot, chosen)
    for column, number in zip(program["base_parameters"].columns, parameters, strict=True):
        if column.formula:
            formula = to_float(parse_expression(column.formula, Location("formula", 1, 1)), values)
            assert formula == pytest.approx(number, rel=1e-9, abs=1e-12)


def test_long_arms_have_no_generated_regressor() -> None:
    rows = "\n".join("  - {type: revolute, a: 0.1, alpha: pi/2}" for _ in range(REGRESSOR_JOINTS + 1))
    links = "\n".join("  - {mass: 1}" for _ in range(REGRESSOR_JOINTS + 1))
    robot = Robot.from_text(f"name: long\ntitle: long\nconvention: standard\njoints:\n{rows}\nlinks:\n{links}\n")
    assert not has_regressor(robot)
    assert identification_program(robot).functions == ()

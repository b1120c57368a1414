"""Traced recursions and closed forms on any robot, and the functions generated for identification."""

import cmath
import random
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
import sympy

from derive.algebra.constants import to_float
from derive.errors import Location, QuantityError, RobotFileError
from derive.mechanics.forward_dynamics import articulated_accelerations
from derive.mechanics.regrouping import regroup
from derive.model.model import Model
from derive.programs.build import build_program
from derive.programs.formulations.trace import Trace
from derive.programs.program import Program
from derive.programs.tape.build import bake, cut
from derive.programs.tape.tape import PARAMETER, Op, Operations, evaluate
from derive.robot.description import derivatives
from derive.robot.evaluate import parameter_values
from derive.robot.evaluate import to_float as number_at
from derive.robot.expression import ZERO
from derive.robot.inertial_parameters import REGRESSOR_JOINTS, has_regressor, standard_parameters
from derive.robot.names import free_symbols, robot_symbols
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from derive.verification.oracle.functions import ANGLES, FUNCTIONS, Oracle
from derive.verification.oracle.rates import distance_from_singularity, task_mobility
from tests.evaluate import evaluate as evaluated
from tests.mechanics.arms import assert_close
from tests.random_robots import RandomRobot, catalogue, random_robot, robot_text, seeds
from tests.rows import robot_of_rows, text_of_rows

ARITHMETIC = {
    "number": to_float,
    "sin": cmath.sin,
    "cos": cmath.cos,
    "sqrt": cmath.sqrt,
    "sign": lambda x: float(np.sign(x.real)),
    "absolute": abs,
    "less": lambda a, b: float(a.real < b.real),
    "minimum": lambda a, b: a if a.real < b.real else b,
}
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class State:
    q: Floats
    qd: Floats
    qdd: Floats
    tau: Floats
    h: Floats
    parameters: tuple[float, ...]  # numbers of the free ones


def random_state(program: Program, n: int, values: dict[str, float], seed: int) -> State:
    """A state at random, away from zero velocities."""
    rng = random.Random(seed)
    draw = lambda n=n: np.array([rng.choice((-1, 1)) * rng.uniform(0.1, 1.5) for _ in range(n)])  # noqa: E731
    return State(draw(), draw(), draw(), draw(), draw(6), tuple(values.get(name, 0.7) for name in program.parameters))


def inputs_of(state: State, **changed: Floats) -> dict[str, list[float]]:
    inputs = {kind: list(changed.get(kind, getattr(state, kind))) for kind in ("q", "qd", "qdd", "tau", "h")}
    return {**inputs, PARAMETER: list(state.parameters)}


def value(program: Program, name: str, state: State, **changed: Floats) -> Floats:
    """A function at a state, with some arguments changed."""
    function = program[name]
    return np.array(evaluate(function.tape, inputs_of(state, **changed), ARITHMETIC)).reshape(function.shape).real


TOLERANCE = 1e-11


@dataclass(frozen=True)
class Case:
    robot: RandomRobot
    program: Program
    state: State


@cache
def case_of(seed: int) -> Case:
    robot = random_robot(random.Random(seed), 1 + seed % 6)
    program = build_program(Robot.from_text(robot.text))
    return Case(robot, program, random_state(program, robot.n, robot.values, seed))


@pytest.fixture(params=seeds(14, usual=3), ids=lambda seed: f"seed{seed}")
def case(request: pytest.FixtureRequest) -> Case:
    return case_of(request.param)


def test_functions_are_those_of_the_oracle(case: Case) -> None:
    """Regressors and accelerations, which have yardsticks of their own, elsewhere."""
    program, state = case.program, case.state
    chosen = dict(zip(program.parameters, state.parameters, strict=True))
    oracle = Oracle.of(Robot.from_text(case.robot.text), chosen)
    for name in set(oracle.functions) - {"forward_dynamics"}:
        if name not in ANGLES or distance_from_singularity(oracle.arm, ANGLES[name], state.q) > 1e-3:
            arguments = [getattr(state, argument) for argument in FUNCTIONS[name].arguments]
            volume = oracle.evaluate(name.removesuffix("_dq"), state.q) if name.startswith("manipulability") else 1.0
            far = name != "task_inertia" or np.linalg.cond(task_mobility(oracle.arm, state.q)) < 1e4
            if far and (name != "manipulability_dq" or volume > 1e-3):
                wanted = oracle.evaluate(name, *arguments) * volume
                assert_close(value(program, name, state) * volume, wanted, TOLERANCE)
    inertia = value(program, "inertia_matrix", state)
    assert np.array_equal(inertia, inertia.T)


def test_accelerations_have_the_torques_that_make_them(case: Case) -> None:
    """Those of the program, and by articulated bodies in base parameters, whatever the program has chosen."""
    program, state = case.program, case.state
    inertia = value(program, "inertia_matrix", state)
    if np.linalg.cond(inertia) > 1e8:
        return
    trace = Trace(Robot.from_text(case.robot.text))
    torques = [tau - loss for tau, loss in zip(trace.arguments("tau"), trace.with_friction(trace.zeros()), strict=True)]
    values = articulated_accelerations(regroup(trace.chain), trace.arguments("qd"), torques)
    tape = cut(*bake(trace.graph, [v.ref for v in values], trace.choice.numbers))
    articulated = np.array(evaluate(tape, inputs_of(state), ARITHMETIC)).real
    for found in (value(program, "forward_dynamics", state), articulated):
        left = value(program, "inverse_dynamics", state, qdd=found) - state.tau
        assert np.abs(left).max() <= 1e-9 * max(1, np.abs(inertia).max(), np.abs(state.tau).max())


def test_a_fixed_axis_has_no_rate_and_angles_that_are_singular_everywhere_no_jacobian() -> None:
    program = build_program(robot_of_rows("R a: 0.5 | R a: 0.4"))
    assert "analytic_jacobian_rpy" in program
    assert "analytic_jacobian_zyz" not in program
    program = build_program(robot_of_rows("P"))
    assert program["jacobian_dot"].operations == Operations()


def test_closed_forms_of_rates_are_the_generated_ones() -> None:
    robot = Robot.load("scara-perugia")
    model, oracle = Model(robot), Oracle.of(robot, dict.fromkeys(free_symbols(robot), 0.7))
    q, qd = np.random.default_rng(0).uniform(-1, 1, (2, robot.n))
    numbers = {symbol: 0.7 for symbol in model.J_dot.free_symbols | model.coriolis_vector.free_symbols}
    numbers |= {sympy.Symbol(name): float(value) for name, value in parameter_values(robot).items()}
    numbers |= dict(zip((*model.q, *model.qd), (*q, *qd), strict=True))
    for matrix, name in ((model.J_dot, "jacobian_dot"), (model.coriolis_vector, "coriolis_vector")):
        found = np.array(matrix.subs(numbers).tolist(), dtype=float)
        assert_close(found.reshape(-1), oracle.evaluate(name, q, qd).reshape(-1), TOLERANCE)


MASSES = """
gravity: [0, -9.81, 0]
links: [{mass: m1, com: [-0.1, 0, 0]}, {mass: m2}]
parameters: {m2: 0}
"""


def test_a_joint_without_inertia_has_torques_but_no_accelerations() -> None:
    program = build_program(robot_of_rows("R a: 0.5 | R", MASSES))
    tape = program["forward_dynamics"].tape
    assert {node.op for node in tape.nodes} >= {Op.DIVIDE}
    assert tape.operations == Operations(div=2)
    assert program["inverse_dynamics"].operations.total > 0


@pytest.mark.parametrize("cell", ["y/x", "1/(x*y)"])
def test_cells_that_divide_by_zero_with_their_numbers_are_refused(cell: str) -> None:
    text = text_of_rows(f"R a: '{cell}'", "parameters: {x: 1}")
    with pytest.raises(RobotFileError, match="no real value"):
        Robot.from_text(text.replace("x: 1", "x: 0"))
    robot = replace(Robot.from_text(text), parameters=(("x", ZERO),))
    with pytest.raises(QuantityError, match="division by zero"):
        build_program(robot)


@pytest.mark.sweep
def test_many_joints_are_traced_in_time_and_without_recursion() -> None:
    program = build_program(robot_of_rows("|".join(["R a: 0.3, d: 0.1, alpha: pi/2"] * 64)))
    assert program["link_transforms"].operations.total < 4000
    assert len(program["jacobian"].tape.outputs) == 6 * 64


SMALL = [robot for robot in catalogue().values() if robot.has_dynamics and robot.n <= 4]
RANDOM = [Robot.from_text(robot_text(random.Random(seed), 1 + seed % 3)) for seed in range(9)]


@pytest.mark.first(6)
@pytest.mark.parametrize("robot", SMALL + RANDOM, ids=lambda robot: robot.name)
def test_closed_forms_give_the_torques(robot: Robot) -> None:
    model, rng = Model(robot), random.Random(1)
    symbols = [*robot_symbols(robot), *map(str, (*model.q, *model.qd, *model.qdd))]
    symbols += [*(joint.variable for joint in robot.passive), *(name.name for name in derivatives(robot).values())]
    values = {name: rng.uniform(0.3, 1.5) for name in symbols}
    values |= {name: float(number) for name, number in parameter_values(robot).items()}

    def at(name: str) -> npt.NDArray[np.float64]:
        result: npt.NDArray[np.float64] = evaluated(getattr(model, name), values)
        return result

    torques = at("tau")
    tolerance = 1e-10 * np.abs(torques).max()
    np.testing.assert_allclose(at("regressor") @ at("standard_parameters"), torques, atol=tolerance)
    if robot.loops:  # which have no base parameters
        return
    np.testing.assert_allclose(at("regressor_base") @ at("base_parameters"), torques, atol=tolerance)
    assert model.regressor.shape == (robot.dof, len(model.standard_parameter_names))
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
            formula = number_at(parse_expression(column.formula, Location("formula", 1, 1)), values)
            assert formula == pytest.approx(number, rel=1e-9, abs=1e-12)


def test_long_arms_have_no_generated_regressor() -> None:
    n = REGRESSOR_JOINTS + 1
    robot = robot_of_rows("|".join(["R a: 0.1, alpha: pi/2"] * n), "links:\n" + "  - {mass: 1}\n" * n)
    assert not has_regressor(robot)
    assert identification_program(robot).functions == ()

"""Rates and derivatives are those of the functions that they are named after, on any robot."""

import numpy as np
import pytest
import sympy

from derive.mechanics.forward_dynamics import articulated_accelerations
from derive.mechanics.regrouping import regroup
from derive.model.model import Model
from derive.programs.build import build_program
from derive.programs.formulations.trace import Trace
from derive.programs.program import Program
from derive.programs.tape.build import bake, cut
from derive.programs.tape.tape import Operations, evaluate
from derive.robot.evaluate import parameter_values
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.programs.formulations.test_recursions import Case, assert_close, case_of, units
from tests.programs.recursion_values import ARITHMETIC, STEP, State, derivative, inputs_of, value
from tests.random_robots import seeds


@pytest.fixture(params=seeds(9, usual=3), ids=lambda seed: f"seed{seed}")
def case(request: pytest.FixtureRequest) -> Case:
    return case_of(request.param)


def test_jacobian_rate_is_the_derivative_of_the_jacobian_along_the_motion(case: Case) -> None:
    program, state = case.program, case.state
    assert_close(value(program, "jacobian_dot", state), derivative(program, "jacobian", state, state.qd))


@pytest.mark.parametrize("kind", ["rpy", "zyz"])
def test_analytic_jacobian_is_the_derivative_of_position_and_angles(case: Case, kind: str) -> None:
    program, state = case.program, case.state
    if f"analytic_jacobian_{kind}" not in program:
        return
    pose = value(program, "forward_kinematics", state)
    if np.hypot(*pose[:2, {"rpy": 0, "zyz": 2}[kind]]) < 1e-3:
        return
    rates = [derivative(program, "forward_kinematics", state, unit) for unit in units(case.robot.n)]
    columns = [[*rate[:3, 3], *ANGLE_RATES[kind](pose[:3, :3], rate[:3, :3])] for rate in rates]
    assert_close(value(program, f"analytic_jacobian_{kind}", state), np.array(columns).T)


def turn_rate(y: float, x: float, dy: float, dx: float) -> float:
    """The derivative of atan2(y, x)."""
    return (x * dy - y * dx) / (x * x + y * y)


def rpy_rates(r: np.ndarray, d: np.ndarray) -> list[float]:
    cosine = np.hypot(r[0, 0], r[1, 0])
    pitch = turn_rate(-r[2, 0], cosine, -d[2, 0], (r[0, 0] * d[0, 0] + r[1, 0] * d[1, 0]) / cosine)
    return [turn_rate(r[2, 1], r[2, 2], d[2, 1], d[2, 2]), pitch, turn_rate(r[1, 0], r[0, 0], d[1, 0], d[0, 0])]


def zyz_rates(r: np.ndarray, d: np.ndarray) -> list[float]:
    sine = np.hypot(r[0, 2], r[1, 2])
    theta = turn_rate(sine, r[2, 2], (r[0, 2] * d[0, 2] + r[1, 2] * d[1, 2]) / sine, d[2, 2])
    return [turn_rate(r[1, 2], r[0, 2], d[1, 2], d[0, 2]), theta, turn_rate(r[2, 1], -r[2, 0], d[2, 1], -d[2, 0])]


ANGLE_RATES = {"rpy": rpy_rates, "zyz": zyz_rates}


def test_coriolis_vector_is_the_coriolis_matrix_times_the_velocities(case: Case) -> None:
    program, state = case.program, case.state
    assert_close(value(program, "coriolis_vector", state), value(program, "coriolis_matrix", state) @ state.qd)


@pytest.mark.parametrize(("name", "argument"), [("inverse_dynamics_dq", "q"), ("inverse_dynamics_dqd", "qd")])
def test_torque_derivatives_are_those_of_the_torques(case: Case, name: str, argument: str) -> None:
    program, state = case.program, case.state
    columns = [
        value(program, "inverse_dynamics", state, **{argument: getattr(state, argument) + 1j * STEP * unit}).imag / STEP
        for unit in units(case.robot.n)
    ]
    assert_close(value(program, name, state), np.array(columns).T)


def test_articulated_bodies_give_the_accelerations_of_the_torques(case: Case) -> None:
    program, state = case.program, case.state
    inertia = value(program, "inertia_matrix", state)
    if np.linalg.cond(inertia) > 1e8:
        return
    found = accelerations(Robot.from_text(case.robot.text), program, state)
    left = value(program, "inverse_dynamics", state, qdd=found) - state.tau
    assert np.abs(left).max() <= 1e-9 * max(1, np.abs(inertia).max(), np.abs(state.tau).max())


def accelerations(robot: Robot, program: Program, state: State) -> np.ndarray:
    """By articulated bodies in base parameters, whatever the program has chosen."""
    trace = Trace(robot)
    torques = [tau - loss for tau, loss in zip(trace.arguments("tau"), trace.with_friction(trace.zeros()), strict=True)]
    values = articulated_accelerations(regroup(trace.chain), trace.arguments("qd"), torques)
    tape = cut(*bake(trace.graph, [v.ref for v in values], trace.choice.numbers))
    return np.array(evaluate(tape, inputs_of(state), ARITHMETIC)).real


PLANAR = """
name: planar
convention: standard
joints: [{type: revolute, a: 0.5}, {type: revolute, a: 0.4}]
"""


def test_angles_that_are_singular_everywhere_have_no_jacobian() -> None:
    program = build_program(Robot.from_text(PLANAR))
    assert "analytic_jacobian_rpy" in program
    assert "analytic_jacobian_zyz" not in program


def test_a_fixed_axis_has_no_rate() -> None:
    program = build_program(Robot.from_text("name: one\nconvention: standard\njoints: [{type: prismatic}]\n"))
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
        assert_close(found.reshape(-1), oracle.evaluate(name, q, qd).reshape(-1))

"""Laws that the traced recursions obey on any robot: both conventions, R and P, motors, base, tool, any gravity."""

import random
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest

from derive.errors import QuantityError, RobotFileError
from derive.programs.build import build_program
from derive.programs.program import Program
from derive.programs.tape.tape import Op, Operations
from derive.robot.expression import ZERO
from derive.robot.robot import Robot
from tests.programs.recursion_values import STEP, State, derivative, random_state, value
from tests.random_robots import RandomRobot, random_robot, seeds

TOLERANCE = 1e-11
SEEDS = seeds(14, usual=3)


@dataclass(frozen=True)
class Case:
    robot: RandomRobot
    program: Program
    state: State


@cache
def case_of(seed: int) -> Case:
    """The case of a seed: one to six joints."""
    robot = random_robot(random.Random(seed), 1 + seed % 6)
    program = build_program(Robot.from_text(robot.text))
    return Case(robot, program, random_state(program, robot.n, robot.values, seed))


@pytest.fixture(params=SEEDS, ids=lambda seed: f"seed{seed}")
def case(request: pytest.FixtureRequest) -> Case:
    return case_of(request.param)


def assert_close(found: npt.NDArray[np.float64], wanted: npt.NDArray[np.float64]) -> None:
    scale = max(1.0, float(np.abs(wanted).max(initial=0.0)))
    assert np.abs(found - wanted).max(initial=0.0) <= TOLERANCE * scale


def units(n: int) -> list[npt.NDArray[np.float64]]:
    return list(np.eye(n))


def test_poses_are_rigid_and_the_last_link_carries_the_tool(case: Case) -> None:
    program, state = case.program, case.state
    pose = value(program, "forward_kinematics", state)
    links = value(program, "link_transforms", state)
    for frame in (pose, *links):
        assert_close(frame[:3, :3].T @ frame[:3, :3], np.eye(3))
        assert frame[3].tolist() == [0, 0, 0, 1]
        assert np.linalg.det(frame[:3, :3]) == pytest.approx(1)
    assert_close(links[-1] @ case.robot.tool, pose)


def test_jacobian_is_the_derivative_of_the_pose(case: Case) -> None:
    program, state, n = case.program, case.state, case.robot.n
    rotation = value(program, "forward_kinematics", state)[:3, :3]
    columns = []
    for direction in units(n):
        rate = derivative(program, "forward_kinematics", state, direction)
        spin = rate[:3, :3] @ rotation.T
        columns.append([*rate[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]])
    assert_close(value(program, "jacobian", state), np.array(columns).T)


def test_inertia_matrix_is_symmetric_and_positive_definite(case: Case) -> None:
    program, state = case.program, case.state
    inertia = value(program, "inertia_matrix", state)
    assert np.array_equal(inertia, inertia.T)
    assert np.linalg.eigvalsh(inertia).min() > 0


def test_coriolis_matrix_is_the_christoffel_matrix(case: Case) -> None:
    program, state, n = case.program, case.state, case.robot.n
    gradient = np.array([derivative(program, "inertia_matrix", state, unit) for unit in units(n)])
    by_k = np.einsum("kij->ijk", gradient)
    symbols = (by_k + by_k.transpose(0, 2, 1) - by_k.transpose(2, 1, 0)) / 2
    assert_close(value(program, "coriolis_matrix", state), symbols @ state.qd)


def test_inertia_rate_less_twice_coriolis_is_skew(case: Case) -> None:
    program, state = case.program, case.state
    coriolis = value(program, "coriolis_matrix", state)
    rate = derivative(program, "inertia_matrix", state, state.qd)
    assert_close(coriolis + coriolis.T, rate)


def test_torque_is_made_of_its_parts(case: Case) -> None:
    program, state = case.program, case.state
    friction = value(program, "inverse_dynamics", state) - value(program, "inverse_dynamics", state, qd=-state.qd)
    parts = (
        value(program, "inertia_matrix", state) @ state.qdd
        + value(program, "coriolis_matrix", state) @ state.qd
        + value(program, "gravity_vector", state)
    )
    assert_close(value(program, "inverse_dynamics", state), parts + friction / 2)


def test_forward_dynamics_undoes_inverse_dynamics(case: Case) -> None:
    program, state = case.program, case.state
    inertia = value(program, "inertia_matrix", state)
    if np.linalg.cond(inertia) > 1e8:
        return
    found = value(program, "forward_dynamics", state, tau=value(program, "inverse_dynamics", state))
    assert np.abs(inertia @ (found - state.qdd)).max() <= 1e-9 * max(1, np.abs(inertia).max())


def test_gravity_is_the_torque_at_rest(case: Case) -> None:
    program, state, n = case.program, case.state, case.robot.n
    rest = np.zeros(n)
    held = value(program, "inverse_dynamics", state, qd=rest, qdd=rest)
    assert_close(value(program, "gravity_vector", state), held)


def test_the_work_of_inertia_and_coriolis_torques_is_the_rate_of_kinetic_energy(case: Case) -> None:
    program, state = case.program, case.state
    torque = value(program, "inertia_matrix", state) @ state.qdd + value(program, "coriolis_matrix", state) @ state.qd
    rate = state.qd @ value(program, "inertia_matrix", state) @ state.qdd
    rate += state.qd @ derivative(program, "inertia_matrix", state, state.qd) @ state.qd / 2
    assert_close(np.array([state.qd @ torque]), np.array([rate]))


def test_the_rate_of_the_energies_is_the_work_of_the_torques_less_friction(case: Case) -> None:
    program, state = case.program, case.state
    moved = {"q": state.q + 1j * STEP * state.qd, "qd": state.qd + 1j * STEP * state.qdd}
    rate = (
        value(program, "kinetic_energy", state, **moved) + value(program, "potential_energy", state, q=moved["q"])
    ).imag
    torque = value(program, "inverse_dynamics", state)
    friction = torque - value(program, "inverse_dynamics", state, qd=-state.qd)
    assert_close(rate / STEP, state.qd @ (torque - friction / 2))


def test_the_jacobian_of_the_end_effector_is_the_other_turned(case: Case) -> None:
    program, state = case.program, case.state
    back = value(program, "forward_kinematics", state)[:3, :3].T
    assert_close(value(program, "jacobian_end", state), np.kron(np.eye(2), back) @ value(program, "jacobian", state))


SINGULAR = """
name: singular
convention: standard
joints: [{type: revolute, a: 0.5}, {type: revolute}]
gravity: [0, -9.81, 0]
links: [{mass: m1, com: [-0.1, 0, 0]}, {mass: m2}]
parameters: {m2: 0}
"""


def test_a_joint_without_inertia_has_torques_but_no_accelerations() -> None:
    program = build_program(Robot.from_text(SINGULAR))
    tape = program["forward_dynamics"].tape
    assert {node.op for node in tape.nodes} >= {Op.DIVIDE}
    assert tape.operations == Operations(div=2)
    assert program["inverse_dynamics"].operations.total > 0


@pytest.mark.parametrize("cell", ["y/x", "1/(x*y)"])
def test_cells_that_divide_by_zero_with_their_numbers_are_refused(cell: str) -> None:
    joints = f"[{{type: revolute, q: q1, a: '{cell}'}}]"
    text = f"name: one\nconvention: standard\njoints: {joints}\nparameters: {{x: 1}}\n"
    with pytest.raises(RobotFileError, match="no real value"):
        Robot.from_text(text.replace("x: 1", "x: 0"))
    robot = replace(Robot.from_text(text), parameters=(("x", ZERO),))
    with pytest.raises(QuantityError, match="division by zero"):
        build_program(robot)


@pytest.mark.sweep
def test_many_joints_are_traced_in_time_and_without_recursion() -> None:
    joints = "\n".join("  - {type: revolute, a: 0.3, d: 0.1, alpha: pi/2}" for _ in range(64))
    program = build_program(Robot.from_text(f"name: long\nconvention: standard\njoints:\n{joints}\n"))
    assert program["link_transforms"].operations.total < 4000
    assert len(program["jacobian"].outputs) == 6 * 64

"""The independent recursion by itself: numbers known by hand, energies over a motion, parts by their definitions.

That it agrees with another engine in every function is the matter of `test_against_pinocchio`.
"""

import random

import numpy as np
import pytest
from hypothesis import given, settings

from derive.model.identification.base_parameters import base_set
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle import frames, newton
from derive.verification.oracle.functions import FUNCTIONS, Oracle
from derive.verification.oracle.identification import Identification
from derive.verification.oracle.lagrange import com_jacobians, kinetic_energy, potential_energy, rotor_jacobians
from tests.random_robots import Array, RandomRobot, configurations, robots

PENDULUM = """
name: pendulum
convention: standard
joints:
  - {type: revolute, a: 0.7}
gravity: [0, -9.81, 0]
links:
  - {mass: 2, com: [-0.2, 0, 0], inertia: {zz: 0.3}, friction: {viscous: 0.4, coulomb: 0.25}}
"""


def oracle_of(robot: RandomRobot) -> Oracle:
    return Oracle.of(Robot.from_text(robot.text), robot.values)


def state(n: int, seed: int = 3) -> Array:
    return configurations(random.Random(seed), n, 3)


@given(robots())
@settings(max_examples=30, deadline=None)
def test_inertia_from_com_and_rotor_jacobians_is_symmetric_and_positive_definite(robot: RandomRobot) -> None:
    oracle, (q, *_) = oracle_of(robot), state(robot.n)
    matrix = oracle.evaluate("inertia_matrix", q)
    assert np.allclose(matrix, matrix.T, rtol=1e-12, atol=1e-12)
    assert np.linalg.eigvalsh(matrix).min() > 0
    linear, _ = com_jacobians(oracle.arm, q)
    rotor, _ = rotor_jacobians(oracle.arm, q)
    translation = np.einsum("k,kai,kaj->ij", oracle.arm.mass, linear, linear)
    translation += np.einsum("k,kai,kaj->ij", oracle.arm.rotor_mass, rotor, rotor)
    rotation = np.linalg.eigvalsh(matrix - translation)  # zero for a slider
    assert rotation.min() > -1e-13 * np.abs(matrix).max()


@given(robots(max_joints=4))
@settings(max_examples=4, deadline=None)
def test_energy_changes_by_the_work_of_torques_minus_friction(robot: RandomRobot) -> None:
    """Along a motion simulated by Runge and Kutta, the work as one more state; dry friction jumps at turning points."""
    oracle, (q, qd, force) = oracle_of(robot), state(robot.n)
    tau = force * np.sqrt(np.diagonal(oracle.evaluate("inertia_matrix", q)))

    def rate(x: Array) -> Array:
        position, velocity = x[: robot.n], x[robot.n : -1]
        lost = oracle.arm.viscous * velocity + oracle.arm.coulomb * np.sign(velocity)
        acceleration = oracle.evaluate("forward_dynamics", position, velocity, tau)
        return np.concatenate([velocity, acceleration, [(tau - lost) @ velocity]])

    def energy(x: Array) -> float:
        arm, position, velocity = oracle.arm, x[: robot.n], x[robot.n : -1]
        return float(kinetic_energy(arm, position, velocity) + potential_energy(arm, position))

    start = np.concatenate([q, qd, [0.0]])
    end, h = start, 2e-4
    for _ in range(100):
        k1 = rate(end)
        k2 = rate(end + h / 2 * k1)
        k3 = rate(end + h / 2 * k2)
        k4 = rate(end + h * k3)
        end = end + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    scale = max(1.0, abs(energy(start)), float(kinetic_energy(oracle.arm, q, qd)))
    crossed = (np.sign(start[robot.n : -1]) != np.sign(end[robot.n : -1])) & (oracle.arm.coulomb != 0)
    assert abs(energy(end) - energy(start) - end[-1]) < (1e-3 if crossed.any() else 1e-7) * scale


def test_a_hanging_pendulum_needs_torque_against_gravity_when_lifted() -> None:
    """q counts from the horizontal x axis: at q = 0 gravity pulls the link down, so holding it takes +m g l."""
    oracle = Oracle.of(Robot.from_text(PENDULUM))
    hold = oracle.evaluate("gravity_vector", [[0.0], [-np.pi / 2], [np.pi]])[:, 0]
    assert hold == pytest.approx([2 * 9.81 * 0.5, 0.0, -2 * 9.81 * 0.5])
    let_go = oracle.evaluate("forward_dynamics", [0.0], [0.0], [0.0])
    assert let_go == pytest.approx([-2 * 9.81 * 0.5 / (2 * 0.25 + 0.3)])


def test_friction_resists_motion_and_vanishes_at_rest() -> None:
    oracle = Oracle.of(Robot.from_text(PENDULUM))
    down = [-np.pi / 2]
    torques = [oracle.evaluate("inverse_dynamics", down, [rate], [0.0])[0] for rate in (2.0, -2.0, 0.0)]
    assert torques == pytest.approx([2 * 0.4 + 0.25, -2 * 0.4 - 0.25, 0.0])


def test_a_geared_rotor_couples_joints_with_parallel_axes_by_ratio_times_inertia() -> None:
    """Planar arm with rotors (Siciliano et al., section 7.3.2): b_12 gains kr2 Im2, b_22 gains kr2^2 Im2, b_11 Im2."""
    text = """
name: rotors
convention: standard
joints:
  - {type: revolute, a: 0.5}
  - {type: revolute, a: 0.4}
gravity: [0, 0, 0]
links:
  - {motor: {mass: 0, inertia: 0.02, ratio: 100}}
  - {motor: {mass: 0, inertia: 0.03, ratio: 50}}
"""
    matrix = Oracle.of(Robot.from_text(text)).evaluate("inertia_matrix", [0.3, 0.8])
    wanted = [[100**2 * 0.02 + 0.03, 50 * 0.03], [50 * 0.03, 50**2 * 0.03]]
    assert matrix == pytest.approx(np.array(wanted))


@given(robots())
@settings(max_examples=30, deadline=None)
def test_accelerations_of_the_last_link_are_second_differences_of_its_frame(robot: RandomRobot) -> None:
    arm, (q, qd, qdd) = oracle_of(robot).arm, state(robot.n)
    places = [frames.chain_frames(arm, q + qd * t + 0.5 * qdd * t * t)[-1, :3, 3] for t in (-1e-4, 0.0, 1e-4)]
    chain = frames.chain_frames(arm, q)
    axis, _ = frames.joint_axes(arm, chain)
    last = newton.link_motions(arm, chain, axis, qd, qdd)[-1]
    measured = (places[0] - 2 * places[1] + places[2]) / 1e-8
    assert np.allclose(last.acceleration_at(places[1]), measured, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("name", ["scara-perugia", "planar-2r-perugia"])
def test_regressors_give_the_torques_and_values_have_the_axes_of_their_definitions(name: str) -> None:
    robot = Robot.load(name)
    numbers = {symbol: 0.3 + 0.1 * place for place, symbol in enumerate(free_symbols(robot))}
    oracle = Oracle.of(robot, numbers, base_set(robot).parameters)
    q, qd, qdd = np.random.default_rng(4).uniform(-1.0, 1.0, (3, 5, robot.n))
    assert isinstance(oracle.identification, Identification)
    base = oracle.evaluate("base_regressor", q, qd, qdd) @ oracle.evaluate("base_parameters")
    assert np.allclose(base, oracle.evaluate("inverse_dynamics", q, qd, qdd), rtol=1e-9, atol=1e-9)
    for function in oracle.functions:
        definition = FUNCTIONS[function]
        assert oracle.evaluate(function, *(q[0] for _ in definition.arguments)).ndim == definition.axes, function

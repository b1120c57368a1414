"""The independent recursion obeys mechanics: identities that no other engine is needed for."""

import random

import numpy as np
import pytest
from hypothesis import given, settings

from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from derive.verification.oracle.lagrange import (
    com_jacobians,
    inertia_derivatives,
    kinetic_energy,
    potential_energy,
    rotor_jacobians,
)
from tests.random_robots import Array, RandomRobot, configurations, robots

STEP = 1e-6

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


def central_difference(function, q: Array) -> Array:  # type: ignore[no-untyped-def]
    steps = np.eye(len(q)) * STEP
    return np.stack([(function(q + step) - function(q - step)) / (2 * STEP) for step in steps], axis=-1)


@given(robots())
@settings(max_examples=30, deadline=None)
def test_the_jacobian_is_the_derivative_of_the_pose(robot: RandomRobot) -> None:
    oracle, (q, *_) = oracle_of(robot), state(robot.n)
    pose = oracle.evaluate("forward_kinematics", q)
    slope = central_difference(lambda x: oracle.evaluate("forward_kinematics", x), q)
    spin = np.einsum("abk,cb->ack", slope[:3, :3], pose[:3, :3])
    angular = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    wanted = np.vstack([slope[:3, 3], angular])
    assert np.allclose(oracle.evaluate("jacobian", q), wanted, atol=1e-7)


@given(robots())
@settings(max_examples=30, deadline=None)
def test_transforms_are_rigid_motions(robot: RandomRobot) -> None:
    oracle, (q, *_) = oracle_of(robot), state(robot.n)
    for pose in (*oracle.evaluate("link_transforms", q), oracle.evaluate("forward_kinematics", q)):
        assert np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
        assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)
        assert (pose[3] == [0, 0, 0, 1]).all()


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


@given(robots())
@settings(max_examples=30, deadline=None)
def test_gravity_vector_is_the_gradient_of_potential_energy(robot: RandomRobot) -> None:
    oracle, (q, *_) = oracle_of(robot), state(robot.n)
    gradient = central_difference(lambda x: potential_energy(oracle.arm, x), q)
    assert np.allclose(oracle.evaluate("gravity_vector", q), gradient, atol=1e-6)


@given(robots())
@settings(max_examples=30, deadline=None)
def test_bdot_minus_2c_is_skew(robot: RandomRobot) -> None:
    oracle, (q, qd, _) = oracle_of(robot), state(robot.n)
    change = np.einsum("kij,k->ij", inertia_derivatives(oracle.arm, q), qd)
    skew = change - 2 * oracle.evaluate("coriolis_matrix", q, qd)
    assert np.allclose(skew, -skew.T, atol=1e-11 * max(1.0, np.abs(skew).max()))


@given(robots())
@settings(max_examples=30, deadline=None)
def test_derivatives_of_inertia_are_those_of_differences(robot: RandomRobot) -> None:
    oracle, (q, *_) = oracle_of(robot), state(robot.n)
    slope = central_difference(lambda x: oracle.evaluate("inertia_matrix", x), q)
    exact = np.moveaxis(inertia_derivatives(oracle.arm, q), 0, -1)
    assert np.allclose(exact, slope, atol=1e-7 * max(1.0, np.abs(exact).max()))


@given(robots())
@settings(max_examples=40, deadline=None)
def test_newton_euler_is_lagrange(robot: RandomRobot) -> None:
    oracle, (q, qd, qdd) = oracle_of(robot), state(robot.n)
    inertial = oracle.evaluate("inertia_matrix", q) @ qdd + oracle.evaluate("coriolis_matrix", q, qd) @ qd
    friction = oracle.arm.viscous * qd + oracle.arm.coulomb * np.sign(qd)
    lagrange = inertial + oracle.evaluate("gravity_vector", q) + friction
    newton = oracle.evaluate("inverse_dynamics", q, qd, qdd)
    assert np.allclose(newton, lagrange, rtol=1e-11, atol=1e-11 * max(1.0, np.abs(lagrange).max()))
    assert np.allclose(oracle.evaluate("forward_dynamics", q, qd, newton), qdd, atol=1e-8)


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
    end = start
    for _ in range(100):
        end = runge_kutta(rate, end, 2e-4)
    scale = max(1.0, abs(energy(start)), float(kinetic_energy(oracle.arm, q, qd)))
    crossed = (np.sign(start[robot.n : -1]) != np.sign(end[robot.n : -1])) & (oracle.arm.coulomb != 0)
    assert abs(energy(end) - energy(start) - end[-1]) < (1e-3 if crossed.any() else 1e-7) * scale


def runge_kutta(rate, x: Array, h: float) -> Array:  # type: ignore[no-untyped-def]
    k1 = rate(x)
    k2 = rate(x + h / 2 * k1)
    k3 = rate(x + h / 2 * k2)
    k4 = rate(x + h * k3)
    return np.asarray(x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))


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

"""The oracle against Pinocchio and against what any arm obeys."""

import random

import numpy as np
import pytest
from hypothesis import given, settings

from derive.model.identification.base_parameters import base_set
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle import frames, newton
from derive.verification.oracle.functions import ANGLES, FUNCTIONS, Oracle
from derive.verification.oracle.identification import Identification
from derive.verification.oracle.lagrange import kinetic_energy, link_jacobians, potential_energy, rotor_jacobians
from derive.verification.oracle.rates import distance_from_singularity
from tests.random_robots import RandomRobot, configurations, random_robot, robots
from tests.rows import robot_of_rows
from tests.verification.oracle.pinocchio_reference import Array, Reference, reference

TOLERANCE = 1e-10


def motion(n: int, seed: int = 0) -> dict[str, Array]:
    q, qd, qdd, tau = configurations(random.Random(seed), n, 4)
    h = configurations(random.Random(seed), 6, 1)[0]
    return {"q": q, "qd": qd, "qdd": qdd, "tau": 20 * tau, "h": h}


def relative_error(got: Array, wanted: Array) -> float:
    assert got.shape == wanted.shape
    return float(np.abs(got - wanted).max() / max(1.0, np.abs(wanted).max()))


def check(oracle: Oracle, outside: Reference, arguments: dict[str, Array]) -> None:
    for name in oracle.functions:
        q, *rates = (arguments[argument] for argument in FUNCTIONS[name].arguments)
        distance = distance_from_singularity(oracle.arm, ANGLES[name], q) if name in ANGLES else 1.0
        got, wanted = oracle.evaluate(name, q, *rates), getattr(outside, name)(q, *rates)
        if outside.determines(name, q):
            assert relative_error(got, wanted) * distance < TOLERANCE, name


@given(robots())
@settings(max_examples=30, deadline=None)
def test_every_function_agrees_with_pinocchio(robot: RandomRobot) -> None:
    oracle, outside = Oracle.of(Robot.from_text(robot.text), robot.values), reference(robot)
    check(oracle, outside, motion(robot.n))


@given(robots(dynamics=False))
@settings(max_examples=30, deadline=None)
def test_kinematics_agrees_without_dynamics(robot: RandomRobot) -> None:
    oracle, outside = Oracle.of(Robot.from_text(robot.text), robot.values), reference(robot)
    assert set(oracle.functions) <= {name for name, definition in FUNCTIONS.items() if not definition.dynamic}
    check(oracle, outside, motion(robot.n))


@pytest.mark.parametrize("standard", [True, False])
def test_kinematics_agrees_for_64_joints(standard: bool) -> None:
    robot = random_robot(random.Random(64), 64, standard=standard, dynamics=False)
    check(Oracle.of(Robot.from_text(robot.text), robot.values), reference(robot), motion(64))


def test_the_sample_of_robots_covers_the_format() -> None:
    """Else agreement would mean little: every feature occurs often among the first 200 seeds."""
    sample = [random_robot(random.Random(seed)) for seed in range(200)]
    joints = [joint for robot in sample for joint in robot.joints]
    links = [link for robot in sample for link in robot.links]
    text = "\n".join(robot.text for robot in sample)
    assert sum(robot.standard for robot in sample) in range(60, 140)
    assert {robot.n for robot in sample} == set(range(1, 8))
    for feature in (
        [joint for joint in joints if not joint.revolute],
        [joint for joint in joints if joint.sign < 0 and joint.revolute],
        [joint for joint in joints if joint.sign < 0 and not joint.revolute],
        [joint for joint in joints if joint.revolute and joint.theta],
        [link for link in links if link.rotor_inertia],
        [link for link in links if link.ratio < 0],
        [link for link in links if link.armature],
        [link for link in links if link.coulomb],
        [robot for robot in sample if (robot.base != np.eye(4)).any()],
        [robot for robot in sample if (robot.tool != np.eye(4)).any()],
        [robot for robot in sample if robot.gravity[0]],
        [robot for robot in sample if robot.values],
    ):
        assert len(feature) >= 20
    for word in ("deg", "mm", "runtime", "sqrt(", "sin(", "limits", "armature", "viscous"):
        assert text.count(word) >= 20, word


@given(robots())
@settings(max_examples=12, deadline=None)
def test_a_batch_is_its_configurations_one_by_one(robot: RandomRobot) -> None:
    oracle = Oracle.of(Robot.from_text(robot.text), robot.values)
    rng = random.Random(1)
    widths = {"q": robot.n, "qd": robot.n, "qdd": robot.n, "tau": robot.n, "h": 6}
    drawn = {kind: configurations(rng, width, 6).reshape(2, 3, width) for kind, width in widths.items()}
    for name in oracle.functions:
        arguments = [drawn[kind] for kind in FUNCTIONS[name].arguments]
        together = oracle.evaluate(name, *arguments)
        alone = oracle.evaluate(name, *(argument[1, 2] for argument in arguments))
        assert relative_error(*np.nan_to_num((together[1, 2], alone))) < 1e-12


BODY = "{mass: 2, com: [-0.2, 0, 0], inertia: {zz: 0.3}, friction: {viscous: 0.4, coulomb: 0.25}}"
PENDULUM = robot_of_rows("R a: 0.7", f"gravity: [0, -9.81, 0]\nlinks: [{BODY}]")


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
    (linear, _), (rotor, _) = (
        jacobians(oracle.arm, frames.chain_frames(oracle.arm, q)) for jacobians in (link_jacobians, rotor_jacobians)
    )
    translation = np.einsum("k,kai,kaj->ij", oracle.arm.mass, linear, linear)
    translation += np.einsum("k,kai,kaj->ij", oracle.arm.rotor_mass, rotor, rotor)
    rotation = np.linalg.eigvalsh(matrix - translation)  # zero for a slider
    assert rotation.min() > -1e-13 * np.abs(matrix).max()


@given(robots(max_joints=4))
@settings(max_examples=3, deadline=None)
def test_energy_changes_by_the_work_of_torques_minus_friction(robot: RandomRobot) -> None:
    """Along a motion simulated by Runge and Kutta, the work as one more state; dry friction jumps at turning points."""
    oracle, (q, qd, force) = oracle_of(robot), state(robot.n)
    tau = force * np.sqrt(np.diagonal(oracle.evaluate("inertia_matrix", q)))

    def rate(x: Array) -> Array:
        position, velocity = x[: robot.n], x[robot.n : -1]
        lost = oracle.arm.viscous * velocity + oracle.arm.coulomb[0] * np.sign(velocity)
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
    crossed = (np.sign(start[robot.n : -1]) != np.sign(end[robot.n : -1])) & (oracle.arm.coulomb[0] != 0)
    assert abs(energy(end) - energy(start) - end[-1]) < (1e-3 if crossed.any() else 1e-7) * scale


def test_a_hanging_pendulum_needs_torque_against_gravity_when_lifted() -> None:
    """q counts from the horizontal x axis: at q = 0 gravity pulls the link down, so holding it takes +m g l."""
    oracle = Oracle.of(PENDULUM)
    hold = oracle.evaluate("gravity_vector", [[0.0], [-np.pi / 2], [np.pi]])[:, 0]
    assert hold == pytest.approx([2 * 9.81 * 0.5, 0.0, -2 * 9.81 * 0.5])
    let_go = oracle.evaluate("forward_dynamics", [0.0], [0.0], [0.0])
    assert let_go == pytest.approx([-2 * 9.81 * 0.5 / (2 * 0.25 + 0.3)])


def test_a_geared_rotor_couples_joints_with_parallel_axes_by_ratio_times_inertia() -> None:
    """Planar arm with rotors (Siciliano et al., section 7.3.2): b_12 gains kr2 Im2, b_22 gains kr2^2 Im2, b_11 Im2."""
    rotors = "{motor: {mass: 0, inertia: 0.02, ratio: 100}}, {motor: {mass: 0, inertia: 0.03, ratio: 50}}"
    robot = robot_of_rows("R a: 0.5 | R a: 0.4", f"gravity: [0, 0, 0]\nlinks: [{rotors}]")
    matrix = Oracle.of(robot).evaluate("inertia_matrix", [0.3, 0.8])
    wanted = [[100**2 * 0.02 + 0.03, 50 * 0.03], [50 * 0.03, 50**2 * 0.03]]
    assert matrix == pytest.approx(np.array(wanted))


@given(robots())
@settings(max_examples=30, deadline=None)
def test_accelerations_of_the_last_link_are_second_differences_of_its_frame(robot: RandomRobot) -> None:
    arm, (q, qd, qdd) = oracle_of(robot).arm, state(robot.n)
    places = [frames.chain_frames(arm, q + qd * t + 0.5 * qdd * t * t)[-1, :3, 3] for t in (-1e-4, 0.0, 1e-4)]
    chain = frames.chain_frames(arm, q)
    last = newton.link_motions(arm, chain, frames.joint_axes(arm, chain), qd, qdd)[-1]
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
    rows = dict.fromkeys(("q", "qd", "qdd", "tau"), q[0]) | {"h": np.ones(6)}
    for function in oracle.functions:
        definition = FUNCTIONS[function]
        assert oracle.evaluate(function, *(rows[k] for k in definition.arguments)).ndim == definition.axes, function

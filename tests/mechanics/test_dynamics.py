"""Kinematics and dynamics of chains against the independent recursion."""

from __future__ import annotations

import random

import numpy as np
import pytest

from derive.algebra.domain import PolynomialDomain
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.mechanics import forward_kinematics as kinematics
from derive.mechanics.chain import build_chain
from derive.mechanics.energy import gravity_vector, inertia_matrix, kinetic_energy, potential_energy
from derive.mechanics.exact import Dynamics, Kinematics
from derive.mechanics.forward_dynamics import articulated_accelerations, carried, factorised, forward_dynamics
from derive.mechanics.newton_euler import inverse_dynamics
from derive.mechanics.printed_newton_euler import printed_newton_euler, without_rotors
from derive.mechanics.regressor import Regressor, with_unit_rotors
from derive.mechanics.regrouping import Rule, regroup
from derive.mechanics.torque_derivatives import coriolis_matrix, torque_position_derivative, torque_velocity_derivative
from derive.mechanics.vectors import column
from derive.model.model import Model
from derive.robot.description import Convention
from derive.robot.inertial_parameters import standard_parameters
from derive.robot.robot import Robot
from tests.lectures.general_results import arms
from tests.mechanics.arms import SEEDS, Arm, Array, arm_of, assert_close, trees_of
from tests.random_robots import catalogue, robot_text, seeds


@pytest.fixture(params=[*SEEDS, *trees_of(200, 3, 40)])
def arm(request: pytest.FixtureRequest) -> Arm:
    """An arm or a tree."""
    return request.param() if callable(request.param) else arm_of(request.param)


@pytest.fixture(params=[*SEEDS, *trees_of(200, 2, 20)])
def limb(request: pytest.FixtureRequest) -> Arm:
    """An arm, or that to an end of a tree."""
    return request.param().limb() if callable(request.param) else arm_of(request.param)


def friction(arm: Arm) -> Array:
    """b*qd + f*sign(qd) of every joint."""
    joints = arm.chain.joints
    return np.array([j.viscous * v + j.coulomb * np.sign(v) for j, v in zip(joints, arm.qd, strict=True)])


def test_inertia_coriolis_gravity_and_torques_are_those_of_the_oracle(arm: Arm) -> None:
    found = np.array(inertia_matrix(arm.chain))
    assert_close(found, arm.expected("inertia_matrix"))
    assert (found == found.T).all()
    assert np.linalg.eigvalsh(found).min() > 0
    found = np.array(coriolis_matrix(arm.chain, arm.qd.tolist(), 0.5))
    assert_close(found, arm.expected("coriolis_matrix", arm.q, arm.qd))
    assert_close(gravity_vector(arm.chain), arm.expected("gravity_vector"))
    found = np.array(inverse_dynamics(arm.chain, arm.qd.tolist(), arm.qdd.tolist()))
    assert_close(found + friction(arm), arm.expected("inverse_dynamics", arm.q, arm.qd, arm.qdd))


def test_energies_are_those_of_links_rotors_and_armatures(arm: Arm) -> None:
    found = kinetic_energy(arm.chain, arm.qd.tolist(), 0.5)
    assert_close(found, arm.expected("kinetic_energy", arm.q, arm.qd))
    assert found > 0
    wanted = arm.expected("potential_energy")
    for meeting in range(arm.robot.n + 1):
        assert_close(potential_energy(arm.chain, meeting), wanted)


def test_accelerations_undo_newton_and_euler_and_inertia_is_carried_into_the_task(arm: Arm) -> None:
    chain, qd, still = arm.chain, arm.qd.tolist(), [0.0] * arm.robot.n
    torques = inverse_dynamics(chain, qd, arm.qdd.tolist())
    wanted = np.array(arm.qdd)
    tolerance = 1e-14 * np.linalg.cond(inertia_matrix(chain)) * 10
    found = forward_dynamics(inertia_matrix(chain), inverse_dynamics(chain, qd, still), torques)
    assert_close(found, wanted, tolerance)
    assert_close(articulated_accelerations(chain, qd, torques), wanted, tolerance)
    rows, inertia = np.array(kinematics.jacobian(arm.chain)), np.array(inertia_matrix(arm.chain))
    (_, pivots, lifted), tolerance = factorised(inertia.tolist(), rows.tolist()), 1e-13 * np.linalg.cond(inertia)
    assert_close(carried(lifted, pivots, 0.0), rows @ np.linalg.solve(inertia, rows.T), tolerance)


def test_derivatives_of_torques(arm: Arm) -> None:
    """That of Coulomb friction is zero; viscous friction is part of the one by velocities."""
    chain, qd, qdd = arm.chain, arm.qd.tolist(), arm.qdd.tolist()
    state = (arm.q, arm.qd, arm.qdd)
    assert_close(torque_position_derivative(chain, qd, qdd, 0.5), arm.expected("inverse_dynamics_dq", *state), 1e-11)
    by_velocity = arm.expected("inverse_dynamics_dqd", arm.q, arm.qd)
    assert_close(torque_velocity_derivative(chain, qd, 0.5), by_velocity, 1e-11)


@pytest.mark.parametrize("second_moments", [False, True])
def test_regrouped_bodies_move_alike(arm: Arm, second_moments: bool) -> None:
    chain, qd, qdd = arm.chain, arm.qd.tolist(), arm.qdd.tolist()
    grouped = regroup(chain, [Rule(second_moments=second_moments)] * arm.robot.n, 0.5)
    assert_close(inertia_matrix(grouped), inertia_matrix(chain))
    assert_close(coriolis_matrix(grouped, qd, 0.5), coriolis_matrix(chain, qd, 0.5))
    assert_close(inverse_dynamics(grouped, qd, qdd), inverse_dynamics(chain, qd, qdd))
    assert_close(kinetic_energy(grouped, qd, 0.5), kinetic_energy(chain, qd, 0.5))
    assert_close(potential_energy(grouped), potential_energy(chain))
    assert not any(body.mass for body, joint in zip(grouped.bodies, grouped.joints, strict=True) if joint.revolute)


def test_torques_are_the_regressor_times_the_parameters(arm: Arm) -> None:
    chain = arm.chain_of(with_unit_rotors(arm.robot))
    regressor = Regressor(chain, arm.qd.tolist(), arm.qdd.tolist(), ends=True, sign=lambda x: float(np.sign(x)))
    rows = regressor.rows(standard_parameters(arm.robot))
    assert_close(rows, arm.expected("regressor", arm.q, arm.qd, arm.qdd), 1e-11)


SMALL = [r for r in catalogue().values() if r.has_dynamics and r.n <= 4 and not r.coupled]


def check_identity(robot: Robot) -> None:
    """B qdd + C qd + g, in the closed form that users see, friction taken off, is what the recursion computes."""
    model = Model(robot)
    torques = [expression_from_sympy(tau - friction) for tau, friction in zip(model.tau, model.friction, strict=True)]
    domain = PolynomialDomain(robot, torques)
    rates, accelerations = ([f(i) for i in range(robot.n)] for f in (domain.rate, domain.acceleration))
    chain, exact = build_chain(robot, domain), Dynamics(robot, domain)
    traced = inverse_dynamics(chain, rates, accelerations)
    assert [domain.constant(torque) - other for torque, other in zip(torques, traced, strict=True)] == [0] * robot.n
    assert [[exact.expand(entry) for entry in row] for row in exact.inertia_matrix] == inertia_matrix(chain)
    assert Kinematics(robot, domain).gravity_vector == gravity_vector(chain)


@pytest.mark.parametrize("robot", SMALL, ids=lambda robot: robot.name)
def test_every_small_robot_of_the_catalogue(robot: Robot) -> None:
    check_identity(robot)


@pytest.mark.parametrize("seed", seeds(48, usual=4))
def test_random_robots(seed: int) -> None:
    check_identity(Robot.from_text(robot_text(random.Random(seed), 1 + seed % 4)))


STANDARD = [without_rotors(robot) for robot in SMALL if robot.convention is Convention.STANDARD]


@pytest.mark.first(3)
@pytest.mark.parametrize("base", [True, False])
@pytest.mark.parametrize("robot", [*arms()[:2], *STANDARD], ids=lambda robot: robot.name)
def test_the_recursions_of_lectures_are_lagrange_s_identically(robot: Robot, base: bool) -> None:
    lagrange = [expression_from_sympy(entry) for entry in Model(robot).tau]
    domain = PolynomialDomain(robot, lagrange)
    rates, accelerations = ([f(i) for i in range(robot.n)] for f in (domain.rate, domain.acceleration))
    found = printed_newton_euler(robot, domain, rates, accelerations, base=base)
    assert [domain.constant(entry) for entry in lagrange] == list(found.torques)


def test_poses_and_jacobians_are_those_of_the_oracle(limb: Arm) -> None:
    chain = limb.chain
    assert_close(kinematics.forward_kinematics(chain).rows(0.0, 1.0), limb.expected("forward_kinematics"))
    assert_close([f.rows(0.0, 1.0) for f in kinematics.link_transforms(chain)], limb.expected("link_transforms"))
    assert_close(kinematics.jacobian(chain), limb.expected("jacobian"))
    slopes = np.reshape(kinematics.jacobian_hessian(kinematics.jacobian(chain), 0.0), (6, chain.n, chain.n))
    assert_close(slopes, limb.expected("jacobian_hessian"))
    assert_close(kinematics.jacobian_rate(chain, limb.qd.tolist()), limb.expected("jacobian_dot", limb.q, limb.qd))


class Rooted(float):
    """A float that has its square root as a method, as the scalars of tapes do."""

    def sqrt(self) -> Rooted:
        return Rooted(float(self) ** 0.5)


for _name in ("add", "radd", "sub", "rsub", "mul", "rmul", "truediv", "rtruediv"):
    _plain = getattr(float, f"__{_name}__")
    setattr(Rooted, f"__{_name}__", lambda self, other, _plain=_plain: Rooted(_plain(self, other)))


@pytest.mark.parametrize("kind", ["rpy", "zyz"])
def test_analytic_jacobian_is_the_geometric_one_in_rates_of_angles(limb: Arm, kind: str) -> None:
    """J_A = diag(1, E^-1) J with omega = E phidot (Siciliano et al., Robotics, section 3.6)."""
    pose = kinematics.forward_kinematics(limb.chain)
    tilted = tuple(map(Rooted, column(pose.rotation, kinematics.TILTED[kind])))
    distance = np.hypot(*tilted[:2])
    if distance < 1e-9:  # these angles are singular wherever the arm is
        return
    rows = [[Rooted(x) for x in row] for row in kinematics.jacobian(limb.chain)]
    found = np.array(kinematics.analytic_jacobian(kind, tilted, rows), dtype=float)
    assert_close(found, limb.expected(f"analytic_jacobian_{kind}"), 1e-12 / distance**2)

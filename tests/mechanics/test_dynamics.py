"""The recursions of the dynamics, run in floats, against the independent recursion."""

from __future__ import annotations

import numpy as np
import pytest

from derive.mechanics.coriolis import coriolis_matrix
from derive.mechanics.energy import kinetic_energy, potential_energy
from derive.mechanics.forward_dynamics import articulated_accelerations, forward_dynamics
from derive.mechanics.inertia_matrix import gravity_vector, inertia_matrix
from derive.mechanics.newton_euler import inverse_dynamics, link_motions
from derive.mechanics.regressor import Regressor, with_unit_rotors
from derive.mechanics.regrouping import Rule, regroup
from derive.mechanics.torque_derivatives import torque_position_derivative, torque_velocity_derivative
from derive.robot.inertial_parameters import standard_parameters
from tests.mechanics.arms import SEEDS, Arm, Array, arm_of, assert_close


@pytest.fixture(params=SEEDS)
def arm(request: pytest.FixtureRequest) -> Arm:
    """One arm after another."""
    return arm_of(request.param)


def friction(arm: Arm) -> Array:
    """b*qd + f*sign(qd) of every joint."""
    joints = arm.chain.joints
    return np.array([j.viscous * v + j.coulomb * np.sign(v) for j, v in zip(joints, arm.qd, strict=True)])


def test_inertia_matrix_is_that_of_the_link_jacobians_and_positive_definite(arm: Arm) -> None:
    found = np.array(inertia_matrix(arm.chain))
    assert_close(found, arm.expected("inertia_matrix"))
    assert (found == found.T).all()
    assert np.linalg.eigvalsh(found).min() > 0


def test_coriolis_matrix_is_christoffels(arm: Arm) -> None:
    found = np.array(coriolis_matrix(arm.chain, arm.qd.tolist(), 0.5))
    assert_close(found, arm.expected("coriolis_matrix", arm.q, arm.qd))


def test_gravity_and_torques(arm: Arm) -> None:
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


def test_the_base_is_accelerated_against_gravity(arm: Arm) -> None:
    still = [0.0] * arm.robot.n
    motions = link_motions(arm.chain, still, still)
    assert_close(motions[0].acceleration, -np.array(arm.chain.gravity))
    assert len(motions) == arm.robot.n + 1
    assert all(not any(motion.omega) and not any(motion.alpha) for motion in motions)


def test_both_ways_to_the_accelerations_undo_newton_and_euler(arm: Arm) -> None:
    chain, qd, still = arm.chain, arm.qd.tolist(), [0.0] * arm.robot.n
    torques = inverse_dynamics(chain, qd, arm.qdd.tolist())
    wanted = np.array(arm.qdd)
    tolerance = 1e-14 * np.linalg.cond(inertia_matrix(chain)) * 10
    assert_close(
        forward_dynamics(inertia_matrix(chain), inverse_dynamics(chain, qd, still), torques), wanted, tolerance
    )
    assert_close(articulated_accelerations(chain, qd, torques), wanted, tolerance)


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

"""The recursions on trees against Pinocchio, their base parameters."""

import random

import numpy as np
import pytest

from derive.mechanics.energy import gravity_vector, inertia_matrix, kinetic_energy, potential_energy
from derive.mechanics.forward_dynamics import articulated_accelerations
from derive.mechanics.newton_euler import inverse_dynamics
from derive.mechanics.torque_derivatives import coriolis_matrix, torque_position_derivative, torque_velocity_derivative
from derive.model.identification.base_parameters import base_set
from derive.robot.inertial_parameters import standard_parameters
from derive.verification.oracle.functions import Oracle
from tests.mechanics.arms import assert_close, moving
from tests.random_robots import configurations, seeds
from tests.random_trees import random_tree
from tests.verification.oracle.pinocchio_reference import TreeBuilder


@pytest.mark.parametrize("seed", seeds(200, 6, 200))
def test_dynamics_of_trees_are_those_of_pinocchio(seed: int) -> None:
    drawn = random_tree(random.Random(seed))
    tree, other = moving(drawn.robot, seed), TreeBuilder(drawn).build()
    chain, state = tree.chain, (tree.q, tree.qd, tree.qdd)
    qd, qdd = tree.qd.tolist(), tree.qdd.tolist()
    inertia, torques = inertia_matrix(chain), inverse_dynamics(chain, qd, qdd)
    assert_close(inertia, other.inertia_matrix(tree.q), 1e-11)
    assert_close(coriolis_matrix(chain, qd, 0.5), other.coriolis_matrix(tree.q, tree.qd), 1e-10)
    assert_close(gravity_vector(chain), other.gravity_vector(tree.q), 1e-11)
    assert_close(torques, other.rigid_torque(*state), 1e-11)
    assert_close(kinetic_energy(chain, qd, 0.5), other.kinetic_energy(tree.q, tree.qd), 1e-11)
    assert_close(potential_energy(chain), other.potential_energy(tree.q), 1e-11)
    assert_close(articulated_accelerations(chain, qd, torques), tree.qdd, 1e-13 * np.linalg.cond(inertia))
    assert_close(torque_position_derivative(chain, qd, qdd, 0.5), other.inverse_dynamics_dq(*state), 1e-10)
    assert_close(torque_velocity_derivative(chain, qd, 0.5), other.inverse_dynamics_dqd(tree.q, tree.qd), 1e-10)


@pytest.mark.parametrize("seed", seeds(60, 4, 30))
def test_base_parameters_are_as_many_as_the_rank_of_the_regressor_and_give_the_torques(seed: int) -> None:
    robot = random_tree(random.Random(seed), 1 + seed % 6).robot
    chosen, q, qd, qdd = base_set(robot), *configurations(random.Random(seed), robot.n, 180).reshape(3, 60, robot.n)
    oracle, names = Oracle.of(robot, base=chosen.parameters), standard_parameters(robot)
    columns = oracle.evaluate("regressor", q, qd, qdd).reshape(-1, len(names))
    columns = columns / np.maximum(np.abs(columns).max(axis=0), 1.0)
    assert (np.linalg.matrix_rank(columns, 1e-10), chosen.proven) == (len(chosen.parameters), True)
    torques = oracle.evaluate("base_regressor", q, qd, qdd) @ oracle.evaluate("base_parameters")
    assert_close(torques, oracle.evaluate("inverse_dynamics", q, qd, qdd), 1e-10)

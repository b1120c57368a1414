"""Arms in numbers, and inverse kinematics by Newton's method."""

import math
import random
from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy

from derive.inverse.numeric.chain import POSITION, NumericChain, Problem
from derive.inverse.numeric.newton import Status, fit, polish, solve
from derive.inverse.words.elementary import array_value
from derive.inverse.words.solutions import ArrayDomain, DigitsDomain, parameter_numbers
from derive.mechanics.chain import build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.forward_kinematics import forward_kinematics as end_of
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.rows import robot_of_rows

RNG = np.random.default_rng(3)


def chain_and_pose(name, q, **parameters):
    robot = Robot.load(name)
    return NumericChain.of(robot, parameters), forward_kinematics(oracle_arm(robot, parameters), np.array(q))


REGULAR = [0.3, 0.4, 0.5, 0.6, 1, 0.7]


def test_a_regular_pose_has_all_its_branches_each_once():
    chain, pose = chain_and_pose("puma560-corke", REGULAR)
    found = solve(chain, pose)
    assert len(found.q) == 8
    assert set(found.status) == {Status.EXACT}
    assert np.abs(chain.pose_and_jacobian(found.q)[0] - pose).max() < 1e-13
    assert np.abs(found.q - REGULAR).max(axis=1).min() < 1e-12


def test_a_singular_wrist_takes_its_free_joint_from_near():
    chain, pose = chain_and_pose("puma560-corke", [0.3, 0.4, 0.5, 0.6, 0, 0.7])
    found = solve(chain, pose, near=[0.3, 0.4, 0.5, 1, 0, 0])
    assert found.status[0] == Status.SINGULAR
    assert found.free[0].tolist() == [False, False, False, True, False, False]
    assert np.allclose(found.q[0], [0.3, 0.4, 0.5, 1, 0, 0.3], atol=1e-12)
    assert (found.status[1:] == Status.EXACT).all()


@pytest.mark.parametrize(("beyond", "statuses"), [(0, [2]), (1e-12, [2]), (1e-6, []), (3, [])])
def test_a_stretched_arm_has_one_solution_and_one_out_of_reach_has_none(beyond, statuses):
    chain, pose = chain_and_pose("planar-2r-perugia", [0.3, 0], a1=0.5, a2=0.4)
    pose[:2, 3] *= 1 + beyond
    found = solve(chain, pose, entries=POSITION)
    assert found.status.tolist() == statuses
    if statuses:
        assert np.allclose(found.q, [[0.3, 0]], atol=1e-5)


def test_given_joints_keep_their_values_and_slides_are_lengths():
    chain, pose = chain_and_pose("scara-perugia", [0.4, 0.9, 0.7, -0.3], a1=0.5, a2=0.4, d4=0.2)
    found = solve(chain, pose)
    assert len(found.q) == 2
    assert np.allclose(found.q[:, 2], 0.7)
    held = solve(chain, pose, given={1: -0.9})
    assert np.allclose(held.q, found.q[found.q[:, 1] < 0])
    assert not len(solve(chain, pose, given={1: 0.3}).q)


def test_limits_drop_branches_and_turn_others_fully():
    robot = robot_of_rows("R a: 0.5, limits: [-0.1, 4] | R a: 0.4, limits: [-4, 0.1]")
    chain, pose = NumericChain.of(robot), forward_kinematics(numeric_arm(robot), np.array([3.5, -1.0]))
    everything, within = (solve(chain, pose, entries=POSITION, limits=limits) for limits in (False, True))
    assert len(everything.q) == 2
    assert np.allclose(within.q, [[3.5, -1.0]])
    assert np.abs(everything.q).max() <= math.pi


def test_polish_takes_candidates_to_rounding_and_leaves_those_that_are_none():
    chain, pose = chain_and_pose("puma560-corke", REGULAR)
    problem = Problem(chain, pose, free=np.ones(6, dtype=bool))
    exact = solve(chain, pose).q
    rough = np.vstack([exact + 1e-6 * RNG.uniform(-1, 1, exact.shape), np.full((1, 6), np.nan)])
    refined, residual = polish(problem, rough)
    assert np.allclose(refined[:-1], exact, atol=1e-12)
    assert residual[:-1].max() < 1e-14
    assert np.isnan(refined[-1]).all()
    assert residual[-1] == math.inf


def test_poses_of_a_batch_are_fitted_one_each():
    chain, q = NumericChain.of(Robot.load("puma560-corke")), RNG.uniform(-2, 2, (5, 6))
    poses = chain.pose_and_jacobian(q)[0]
    ends, residuals = fit(Problem(chain, poses, free=np.ones(6, dtype=bool)), q + 0.01)
    assert residuals.max() < 1e-13
    assert np.allclose(ends, q, atol=1e-9)


@pytest.mark.parametrize("pose", [np.eye(3), np.full((4, 4), np.nan)])
def test_what_is_no_pose_is_refused(pose):
    chain, _ = chain_and_pose("planar-2r-perugia", [0, 0], a1=1.0, a2=1.0)
    with pytest.raises(ValueError, match="pose"):
        solve(chain, pose)
    with pytest.raises(ValueError, match="given joints must be indices from 0 to 1; got "):
        solve(chain, np.eye(4), given={2: 0.0})


def oracle_arm(robot, parameters):
    """The oracle's arm; masses and the like do not matter."""
    return numeric_arm(robot, {**dict.fromkeys(free_symbols(robot), 1.0), **parameters})


def test_pose_and_slopes_are_those_of_the_independent_recursion():
    robot = Robot.load("stanford-deluca")
    values = {"d1": 0.4, "d2": 0.15, "d6": 0.26}
    chain, arm = NumericChain.of(robot, values), oracle_arm(robot, values)
    q = RNG.uniform(-2, 2, (3, 6))
    pose, slope = chain.pose_and_jacobian(q)
    assert np.allclose(pose, forward_kinematics(arm, q), atol=1e-14)
    step = 1e-30j * np.eye(6)
    exact = forward_kinematics(arm, q[:, None, :] + step).imag[..., :3, :] / 1e-30
    assert np.allclose(slope, exact, atol=1e-13)


def test_positions_agree_in_digits_arrays_and_floats() -> None:
    robot = replace(Robot.load("puma560-corke"), links=(), gravity=None)
    values = parameter_numbers(robot, random.Random(1))
    q = [0.3, -0.4, 0.5, -0.6, 0.7, -0.8]
    numbers = {str(symbol): float(value) for symbol, value in values.items()}
    expected = end_of(build_chain(robot, FloatDomain(robot, q, numbers))).position
    with mpmath.workdps(50):
        exact = end_of(build_chain(robot, DigitsDomain(robot, list(map(mpmath.mpf, q)), values)))
    arrays = end_of(build_chain(robot, ArrayDomain(robot, [np.array([x, 0.0]) for x in q], values)))
    assert np.allclose([float(x) for x in exact.position], expected, atol=1e-15)
    assert np.allclose([x[0] for x in arrays.position], expected, atol=1e-15)


def test_an_expression_is_not_a_number_where_it_is_not_real() -> None:
    x = sympy.Symbol("x")
    with np.errstate(invalid="ignore"):
        found = array_value(sympy.atan2(sympy.sqrt(1 - x**2), x), {x: np.array([0.5, 2.0])})
    assert np.isclose(found[0], np.arccos(0.5))
    assert np.isnan(found[1])

"""Solutions of batches of poses in floats: every branch, none twice, none that does not reproduce its pose."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from derive.inverse.closed.branches import STARTS, InverseSolver, starts
from derive.inverse.closed.solve import solve
from derive.inverse.numeric.newton import Status
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.inverse.arms import random_arm


@cache
def solver_and_arm(name):
    robot = Robot.load(name)
    numbers = {symbol: 0.3 + 0.1 * k for k, symbol in enumerate(free_symbols(robot))}
    return InverseSolver.of(robot, solve(robot), numbers), numeric_arm(robot, numbers)


def branches_at(name, q):
    solver, arm = solver_and_arm(name)
    pose = forward_kinematics(arm, np.array(q, dtype=float))
    return solver.solve(pose), pose, arm


def test_a_batch_has_the_branches_of_its_poses_one_by_one():
    q = np.random.default_rng(2).uniform(-2, 2, (2, 3, 6))
    together, poses, arm = branches_at("puma560-corke", q)
    assert together.q.shape == (2, 3, 8, 6)
    assert (together.status == Status.EXACT).all()
    assert np.abs(forward_kinematics(arm, together.q) - poses[..., None, :, :]).max() < 1e-12
    alone = solver_and_arm("puma560-corke")[0].solve(poses[1, 2])
    assert np.allclose(alone.q, together.q[1, 2], atol=1e-12)
    away = np.abs(np.exp(1j * together.q) - np.exp(1j * q[..., None, :])).max(axis=-1)
    assert away.min(axis=-1).max() < 1e-9


def test_a_singular_wrist_gives_each_posture_once_and_takes_its_free_joint_from_near():
    found, pose, arm = branches_at("puma560-corke", [0.3, 0.4, 0.5, 0.6, 0, 0.7])
    there = found.status != Status.NONE
    assert np.isnan(found.q[~there]).all()
    assert there.sum() == 7
    assert (found.status == Status.SINGULAR).sum() == 1
    assert np.abs(forward_kinematics(arm, found.q[there]) - pose).max() < 1e-12
    found = solver_and_arm("puma560-corke")[0].solve(pose, near=[0, 0, 0, 1.1, 0, 0])
    free = found.q[found.status == Status.SINGULAR]
    assert any(np.allclose(q[3:], [1.1, 0, 0.2], atol=1e-9) for q in free)


@pytest.mark.parametrize(("part", "branches"), [(1, 1), (1 + 1e-13, 1), (0.9, 2), (1.1, 0), (0.1, 0)])
def test_a_stretched_scara_has_one_branch_on_the_boundary_two_inside_and_none_outside(part, branches):
    solver, arm = solver_and_arm("scara-perugia")
    pose = forward_kinematics(arm, np.array([0.3, 0.0, 0.5, 0.2]))
    pose[:2, 3] *= part
    found = solver.solve(pose)
    there = found.status != Status.NONE
    assert there.sum() == branches
    assert np.isnan(found.q[~there]).all()
    if branches == 1:
        assert found.status[there].tolist() == [Status.BOUNDARY]
        assert np.allclose(found.q[there], [[0.3, 0, 0.5, 0.2]], atol=1e-5)


def test_an_arm_without_closed_form_is_solved_by_newton_in_the_same_shape():
    solver, arm = solver_and_arm("puma560-corke")
    robot, graph = Robot.load("puma560-corke"), solver.graph
    other = InverseSolver.of(robot, replace(graph, nodes=(), why_not="for the test"))
    poses = forward_kinematics(arm, np.random.default_rng(1).uniform(-2, 2, (2, 6)))
    ours, theirs = other.solve(poses), solver.solve(poses)
    for k in range(2):
        a, b = (np.sort_complex(np.exp(1j * found.q[k]).sum(axis=-1)) for found in (ours, theirs))
        assert np.allclose(a, b, atol=1e-9)


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        (np.eye(3), "shape"),
        (np.full((2, 4, 4), np.nan), "finite"),
        (np.diag([1, 1, 1.1, 1]), r"not orthonormal \(error 2.1e-01 > "),
        (np.diag([1, 1, -1, 1]), "reflection"),
        (np.diag([1, 1, 1, 2]), "last row"),
        (np.eye(4) + np.diag([1e200] * 1, 3), "1e\\+200 m away"),
        ([[1, 2], [3]], "equal length"),
    ],
)
def test_what_is_no_pose_is_refused(pose, message):
    with pytest.raises(ValueError, match=message):
        solver_and_arm("puma560-corke")[0].solve(pose)
    with pytest.raises(ValueError, match=r"given must be finite numbers of shape \(..., 0\)"):
        solver_and_arm("puma560-corke")[0].solve(np.eye(4), given=[0.3])


def test_what_else_a_caller_gives_is_refused_in_words():
    solver, one = solver_and_arm("puma560-corke")[0], np.eye(4)
    for value in ("pose", None, one + 0j):
        with pytest.raises(TypeError, match="poses must be real numbers; got dtype"):
            solver.solve(value)
    for near in ([0.0, 0.0], [0.0, np.nan, 0.0, 0.0, 0.0, 0.0]):
        with pytest.raises(ValueError, match=r"near must be finite numbers of shape \(6,\); got shape \([26],\)"):
            solver.solve(one, near=near)
    with pytest.raises(ValueError, match=r"given has the batch shape \(3,\), but the poses have \(2,\)"):
        solver.solve(np.stack([one, one]), given=np.zeros((3, 0)))


def test_solutions_that_stand_alone_beside_infinitely_many_are_listed():
    case = random_arm("5dof", 17)
    robot = case.robot()
    solver = InverseSolver.of(robot, solve(robot), case.values)
    pose = forward_kinematics(case.arm, np.array([np.radians(55), np.pi, -np.pi / 2, -2.342869, np.pi]))
    found = solver.solve(pose)
    there = found.q[found.status != Status.NONE]
    assert np.abs(forward_kinematics(case.arm, there) - pose).max() < 1e-10
    alone = [[0.959931, 0, 1.570796], [0.959931, np.pi, -1.570796]]
    alone += [[1.393032, 0, 2.003897], [-2.53632, np.pi, 1.925454]]
    apart = np.abs(np.exp(1j * there[:, None, :3]) - np.exp(1j * np.array(alone))).max(axis=2)
    assert (apart.min(axis=0) < 2e-3).all()


def test_starts_fill_the_joint_space_evenly():
    for joints in (1, 3, 5):
        table = starts(joints)
        assert table.shape == (STARTS, joints)
        assert np.abs(table).max() <= 1
        assert np.abs(table.mean(axis=0)).max() < 0.15
        assert ((table > 0).sum(axis=0) >= STARTS // 3).all()

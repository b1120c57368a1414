"""Closure, elimination and candidates of a general arm."""

from __future__ import annotations

import numpy as np
import pytest

from derive.inverse.general.candidates import candidates, finished
from derive.inverse.general.choice import eliminations
from derive.inverse.general.closure import Loop, closures, middle_part
from derive.inverse.general.elimination import EigenProblem
from derive.inverse.general.rigid_motion import (
    BESIDE,
    beside,
    motion_by,
    pose_features,
)


def random_loop(types, seed=0):
    return Loop(tuple(t == "R" for t in types), tuple(random_frames(np.random.default_rng(seed), len(types) + 1)))


def pose_of(loop, q):
    """T at a configuration, (1, 4, 4)."""
    return loop.pose([motion_by(turns, x) for turns, x in zip(loop.revolute, q, strict=True)])[None]


def products(loop, joints, q):
    """The multilinear products of (1, c, s) or (1, d, d^2)."""
    result = np.ones(1)
    for joint in joints:
        x = q[joint]
        line = (1, np.cos(x), np.sin(x)) if loop.revolute[joint] else (1, x, x * x)
        result = np.multiply.outer(result, line).reshape(-1)
    return result


@pytest.mark.parametrize("types", ["RRRRRR", "RPRRRR", "PRRPRR", "RRRRR", "RRPR"])
def test_around_the_loop_both_ways_give_the_same_numbers(types):
    loop = random_loop(types)
    q = np.random.default_rng(3).uniform(-2, 2, loop.n)
    pose = pose_of(loop, q)
    ways = closures(loop)
    assert len(ways) >= loop.n
    for way in ways:
        left = way.eliminated_part(loop) @ products(loop, way.order[2:0:-1], q)
        right = way.unknown_part(loop, pose_features(pose)).reshape(15, -1) @ products(loop, way.unknowns, q)
        if way.aligned is None:
            left = left.reshape(15)
        np.testing.assert_allclose(left, right, atol=1e-10)


def test_a_loop_may_be_read_from_another_joint_and_locked_joints_become_part_of_its_gaps():
    loop = random_loop("RRRPRR")
    q = np.random.default_rng(4).uniform(-2, 2, 6)
    motions = [motion_by(turns, x) for turns, x in zip(loop.revolute, q, strict=True)]
    turned, constant = loop.rotated(2, loop.pose(motions)[None])
    np.testing.assert_allclose(turned.pose(motions[2:] + motions[:2]), constant, atol=1e-12)
    loop = random_loop("RRRRRRR")
    q = np.random.default_rng(5).uniform(-2, 2, 7)
    motions = [motion_by(True, x) for x in q]
    left = loop.locked([None, None, motions[2], None, None, None, motions[6]])
    assert left.n == 5
    np.testing.assert_allclose(left.pose([motions[k] for k in (0, 1, 3, 4, 5)]), loop.pose(motions), atol=1e-12)


def test_the_middle_of_three_joints_moves_what_the_last_one_carries():
    loop = random_loop("RRR")
    q = np.random.default_rng(6).uniform(-2, 2, 3)
    way = closures(random_loop("RRRRRR"))[-1].alone
    parts, near, far = middle_part(loop, way)
    carried = loop.carried(way.dropped)
    moved = near @ motion_by(True, -way.direction * q[1]) @ far
    seen = np.einsum("k,kj->j", (1, np.cos(q[1]), np.sin(q[1])), parts)
    np.testing.assert_allclose(seen, carried.action(moved) @ carried.start, atol=1e-12)


def random_frames(random, count):
    """Rigid motions, (count, 4, 4)."""
    frames = np.tile(np.eye(4), (count, 1, 1))
    for k in range(count):
        rotation = np.linalg.qr(random.normal(size=(3, 3)))[0]
        frames[k, :3, :3] = rotation * np.linalg.det(rotation)
        frames[k, :3, 3] = random.normal(size=3)
    return frames


def test_poses_beside_are_poses_at_a_small_distance_that_grows_with_the_unit():
    frames = random_frames(np.random.default_rng(5), 4)
    unit = np.array([1.0, 2.0, 10.0, 1e-3])
    for which in range(len(BESIDE)):
        moved = beside(frames, which, unit)
        turn = moved[:, :3, :3] @ frames[:, :3, :3].transpose(0, 2, 1)
        np.testing.assert_allclose(turn @ turn.transpose(0, 2, 1), np.broadcast_to(np.eye(3), (4, 3, 3)), atol=1e-15)
        shift = moved[:, :3, 3] - (turn @ frames[:, :3, 3:])[..., 0]
        np.testing.assert_allclose(shift / unit[:, None], np.broadcast_to(shift[0], (4, 3)), atol=1e-12)
        assert 1e-4 < np.abs(turn - np.eye(3)).max() < 0.1
        assert (moved[:, 3] == (0, 0, 0, 1)).all()


def apart(loop, joints, q):
    """Differences of joints from q, full turns aside; NaN where a joint is not known."""
    difference = joints - q
    return np.abs(np.where(loop.revolute, 2 * np.sin(difference / 2), difference))


@pytest.mark.parametrize("types", ["RRRRRR", "PRRPRR", "RRRRR"])
def test_a_configuration_is_among_the_candidates_of_its_pose_first_in_part_and_then_whole(types):
    loop = random_loop(types)
    q = np.random.default_rng(7).uniform(-2, 2, (3, loop.n))
    pose = np.concatenate([pose_of(loop, one) for one in q])
    elimination = min(eliminations(loop, pose[:1]), key=lambda each: each.eigenvalues)
    problem = EigenProblem.of(loop, elimination)
    found = candidates(problem, pose)
    known = list(elimination.unknowns)
    whole = finished(problem, found, pose)
    assert np.isnan(np.delete(found.joints, known, axis=1)).all()
    assert not found.doubtful.any()
    for place, one in enumerate(q):
        part = apart(loop, found.joints[found.place == place], one)[:, known]
        assert part.max(axis=1).min() < 1e-6
        assert apart(loop, whole.joints[whole.place == place], one).max(axis=1).min() < 1e-6


def test_the_joints_of_an_arm_whose_position_is_wanted_follow_from_linear_equations():
    loop = random_loop("RRR").with_tip
    q = np.array([0.4, -1.1, 0.8])
    pose = pose_of(random_loop("RRR"), q)
    elimination = min(eliminations(loop, pose), key=lambda each: each.eigenvalues)
    problem = EigenProblem.of(loop, elimination)
    whole = finished(problem, candidates(problem, pose), pose)
    assert apart(loop, whole.joints, np.append(q, 0.0)).max(axis=1).min() < 1e-6

"""Numbers carried around the loop, and the equations from which joints are eliminated."""

import numpy as np
import pytest

from derive.inverse.general.closure import Loop, closures, middle_part
from derive.inverse.general.rigid_motion import joint_motion, motion_by, pose_features
from tests.inverse.general.test_rigid_motion import random_frames

PRIME = 2147483647


def random_loop(types, seed=0):
    """An arm of floats with general gaps."""
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


def test_residues_follow_the_same_path_as_floats():
    floats = random_loop("RRPRRR")
    # rotations of rational numbers: quarter turns after rational lengths
    turn = np.array([[0, 0, 1, 2], [1, 0, 0, 3], [0, 1, 0, 5], [0, 0, 0, 1]], dtype=object)
    loop = Loop(floats.revolute, (turn,) * 7, PRIME)
    t = [3, 5, 7, 11, 13, 17]
    inverse = [pow(1 + x * x, -1, PRIME) for x in t]
    circle = [((1 - x * x) * w % PRIME, 2 * x * w % PRIME) for x, w in zip(t, inverse, strict=True)]
    motions = [
        joint_motion(True, *(np.array(y, dtype=object) for y in circle[i]))
        if loop.revolute[i]
        else joint_motion(False, np.array(t[i], dtype=object))
        for i in range(6)
    ]
    pose = loop.pose(motions)[None]
    lines = [(1, *circle[i]) if loop.revolute[i] else (1, t[i], t[i] ** 2) for i in range(6)]
    for way in closures(loop):
        left = np.array([[a * b for b in lines[way.order[1]]] for a in lines[way.order[2]]], dtype=object).reshape(9)
        right = np.ones(1, dtype=object)
        for joint in way.unknowns:
            right = np.array([a * b for a in right for b in lines[joint]], dtype=object)
        carried = loop.settle(way.eliminated_part(loop).reshape(15, 9) @ left)
        assert (carried == loop.settle(way.unknown_part(loop, pose_features(pose)).reshape(15, 27) @ right)).all()


def test_a_loop_read_from_another_joint_has_the_same_configurations():
    loop = random_loop("RRRPRR")
    q = np.random.default_rng(4).uniform(-2, 2, 6)
    motions = [motion_by(turns, x) for turns, x in zip(loop.revolute, q, strict=True)]
    turned, constant = loop.rotated(2, loop.pose(motions)[None])
    np.testing.assert_allclose(turned.pose(motions[2:] + motions[:2]), constant, atol=1e-12)


def test_locked_joints_become_part_of_the_gaps():
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

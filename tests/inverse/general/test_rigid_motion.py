"""Numbers of axes, frames and points, and the matrices by which rigid motions map them."""

import numpy as np
import pytest

from derive.inverse.general.rigid_motion import (
    BESIDE,
    axis_action,
    beside,
    frame_action,
    inverse_features,
    point_action,
    pose_features,
    rigid_inverse,
)


def random_frames(random, count):
    """Rigid motions, (count, 4, 4)."""
    frames = np.tile(np.eye(4), (count, 1, 1))
    for k in range(count):
        rotation = np.linalg.qr(random.normal(size=(3, 3)))[0]
        frames[k, :3, :3] = rotation * np.linalg.det(rotation)
        frames[k, :3, 3] = random.normal(size=3)
    return frames


def axis_numbers(u, p):
    """The fifteen numbers by their definition."""
    return np.concatenate([[1], u, p, [p @ p, p @ u], np.cross(p, u), (p @ p) * u - 2 * (p @ u) * p])


def test_axis_action_maps_the_numbers_of_an_axis_to_those_of_the_moved_axis():
    random = np.random.default_rng(1)
    for frame in random_frames(random, 5):
        u, p = random.normal(size=3), random.normal(size=3)
        moved = axis_numbers(frame[:3, :3] @ u, frame[:3, :3] @ p + frame[:3, 3])
        np.testing.assert_allclose(axis_action(pose_features(frame)) @ axis_numbers(u, p), moved, atol=1e-12)


@pytest.mark.parametrize("action", [axis_action, frame_action, point_action])
def test_actions_of_motions_one_after_the_other_are_multiplied(action):
    first, second = random_frames(np.random.default_rng(2), 2)
    one, two, both = (action(pose_features(frame)) for frame in (first, second, first @ second))
    np.testing.assert_allclose(both, one @ two, atol=1e-12)
    back = action(inverse_features(pose_features(first)))
    np.testing.assert_allclose(back @ one, np.eye(len(one)), atol=1e-12)
    np.testing.assert_allclose(back, action(pose_features(rigid_inverse(first))), atol=1e-12)


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

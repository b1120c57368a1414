"""Numbers of axes, frames and points, and the matrices by which rigid motions map them."""

import numpy as np
import pytest

from derive.model.inverse.rigid_motion import (
    axis_action,
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

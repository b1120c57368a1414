"""Solid parts: closed bodies with normals that point outwards, and joints that are drawn on their axes."""

import numpy as np
import pytest

from derive.handouts.figure.scene import Scene, arm_scene
from derive.handouts.figure.solids import LINK, Sizes, joint_centers, prism, shade, solid_faces
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses

SCALE = 100.0
SIZES = Sizes(1.0)


def scene(name: str) -> Scene:
    robot = Robot.load(name)
    poses = RobotPoses(robot)
    return arm_scene(robot, poses.frames(poses.zero))


@pytest.mark.parametrize("sides", [3, 4, 20])
def test_a_prism_is_closed_and_its_normals_point_outwards(sides: int) -> None:
    start, end = np.array((1.0, 2.0, 3.0)), np.array((2.0, 1.0, 5.0))
    faces = prism(start, end, 0.5, LINK, sides=sides)
    assert sum(len(some.corners) for some in faces) == sides + 2
    for some in faces:
        assert some.normals is not None
        for corners, normal in zip(some.corners, some.normals, strict=True):
            assert np.linalg.norm(normal) == pytest.approx(1.0)
            assert normal @ (corners.mean(axis=0) - (start + end) / 2) > 0
            assert np.ptp(corners @ normal) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke", "skeleton-modified", "spherical-wrist"])
def test_joints_are_drawn_on_their_axes_and_apart(name: str) -> None:
    arm = scene(name)
    centers = joint_centers(arm, SCALE, SIZES)
    for joint, center in zip(arm.joints, centers, strict=True):
        assert np.linalg.norm(np.cross(center - joint.anchor * SCALE, joint.direction)) == pytest.approx(0.0, abs=1e-9)
    gaps = [np.linalg.norm(a - b) for k, a in enumerate(centers) for b in centers[:k]]
    assert min(gaps) > SIZES.cylinder[1]


def test_an_arm_grows_with_its_scale_and_its_joints_do_not() -> None:
    arm = scene("scara-perugia")
    small, large = (
        np.concatenate([faces.corners.reshape(-1, 3) for faces in solid_faces(arm, k, SIZES)[0]])
        for k in (SCALE, 3 * SCALE)
    )
    assert 2.0 < np.ptp(large, axis=0).max() / np.ptp(small, axis=0).max() < 3.0


def test_what_faces_the_light_is_brighter() -> None:
    dark, bright = shade(LINK, np.array(((0.0, -1.0, 0.0), (0.0, 1.0, 0.0))))
    assert all(a < b <= 1.0 for a, b in zip(dark, bright, strict=True))

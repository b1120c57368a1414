"""The map of joint variables into a picture: its derivatives, its symmetry, and the way back."""

from __future__ import annotations

import numpy as np
import pytest

from derive.robot.robot import Robot
from derive.workspace.point import ArmPoint, Picture, PlaneMap, joint_ranges
from derive.workspace.poses import RobotPoses
from tests.workspace.arms import CYLINDRICAL, GANTRY, LIMITED, arm, plane


@pytest.mark.parametrize("name", ["puma560-usp", "stanford-laschi", "skeleton-root", "scara-bajd"])
@pytest.mark.parametrize("picture", Picture)
def test_derivatives_are_those_of_the_positions(name: str, picture: Picture) -> None:
    seen = plane(Robot.load(name), picture)
    q = seen.point.random(20, seen.joints, seed=1)
    slopes = seen.values(q)[1]
    for row in range(len(seen.joints)):
        step = np.zeros_like(q)
        step[row] = 1e-6
        measured = (seen.values(q + step)[0] - seen.values(q - step)[0]) / 2e-6
        assert np.abs(measured - slopes[:, row]).max() <= 1e-7 * seen.point.size


@pytest.mark.parametrize("name", ["kuka-lwr4", "stanford-laschi", "dh-modified-deluca", "human-body"])
def test_positions_are_those_of_the_frames(name: str) -> None:
    """From the tool inwards, vector by vector, and from the base outwards, frame by frame."""
    poses = RobotPoses(Robot.load(name))
    point = ArmPoint(poses, joint_ranges(poses), (0.1, -0.2, 0.3))
    joints = tuple(range(len(point.ranges)))
    q = point.random(10, joints, seed=2)
    seen = PlaneMap(point, Picture.SPACE, joints)
    rotation, origin = point.axis
    for place, configuration in zip(seen.places(q).T, q.T, strict=True):
        end = np.array(poses.frames([float(value) for value in configuration])[-1])
        expected = rotation.T @ ((end @ (0.1, -0.2, 0.3, 1.0))[:3] - origin)
        assert np.abs(place - expected).max() <= 1e-12 * point.size
    assert np.abs(seen.places(q) - seen.values(q)[0]).max() <= 1e-12 * point.size


def test_the_first_joint_that_turns_is_the_axis_unless_something_shifts_it() -> None:
    poses = [RobotPoses(robot) for robot in (arm(LIMITED), arm(CYLINDRICAL), Robot.load("skeleton-root"), arm(GANTRY))]
    assert [ArmPoint(p, joint_ranges(p)).turn for p in poses] == [0, 1, None, None]


def test_a_turn_about_the_axis_changes_no_section() -> None:
    poses = RobotPoses(Robot.load("kuka-kr5"))
    point = ArmPoint(poses, joint_ranges(poses))
    section = PlaneMap(point, Picture.SECTION, point.moving)
    q = point.random(30, point.moving)
    turned = q.copy()
    turned[0] += 1.3
    assert np.abs(section.values(q)[0] - section.values(turned)[0]).max() <= 1e-12


def test_joints_that_do_not_move_the_point_are_left_out() -> None:
    poses = RobotPoses(Robot.load("scara-perugia"))
    point = ArmPoint(poses, joint_ranges(poses))
    assert point.moving == (0, 1, 2)
    assert PlaneMap.of(point, Picture.TOP).joints == (0, 1)
    assert PlaneMap.of(point, Picture.SECTION).joints == (1, 2)


def test_the_nearest_configuration_is_within_the_limits_and_nearest() -> None:
    seen = plane(arm(LIMITED), Picture.TOP)
    targets = np.array([[2.0, 0.3, 0.0], [0.0, 1.0, 0.2]])
    starts = np.repeat(seen.inside(np.array([[0.5], [1.0]])), 3, axis=1)
    q, places, distances = seen.nearest(targets, starts)
    low, high = seen.box
    assert np.all((q >= low) & (q <= high))
    many = seen.values(seen.point.random(40_000, seen.joints))[0]
    best = [np.hypot(*(many - target[:, None])).min() for target in targets.T]
    assert np.hypot(*(targets - places)) == pytest.approx(distances)
    assert np.all(distances <= np.array(best) + 1e-9)
    assert distances == pytest.approx(best, abs=0.01)


def test_ranges_that_the_file_does_not_give_are_marked() -> None:
    ranges = joint_ranges(RobotPoses(arm("[{type: revolute, a: 2, limits: [0, 1]}, {type: prismatic}]")))
    assert [(way.lower, way.upper, way.assumed) for way in ranges] == [(0.0, 1.0, False), (0.0, 2.0, True)]
    assert ranges[1].interval == "from 0 to 2 m"

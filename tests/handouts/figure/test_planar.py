"""Planar arms are seen as they are."""

import numpy as np
import pytest

from derive.handouts.figure.planar import plane_normal, view_along
from derive.handouts.figure.scene import arm_scene
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses

PLANAR = {"planar-2r-perugia", "planar-3r", "skeleton", "skeleton-modified", "skeleton-root"}


def normal_of(robot: Robot) -> np.ndarray | None:
    poses = RobotPoses(robot)
    return plane_normal([arm_scene(robot, poses.frames([0.3] * robot.n))])


def test_which_built_in_robots_are_planar() -> None:
    assert {name for name in catalogue_names() if normal_of(Robot.load(name)) is not None} == PLANAR


def test_slides_alone_have_a_plane_and_one_slide_has_none() -> None:
    rows = "{type: prismatic, alpha: pi/2, theta: pi/2}"
    two = Robot.from_text(f"{{name: arm, convention: standard, joints: [{rows}, {rows}]}}")
    normal = normal_of(two)
    assert normal is not None
    assert np.abs(normal) == pytest.approx([0, 1, 0], abs=1e-12) or np.abs(normal) == pytest.approx(
        [1, 0, 0], abs=1e-12
    )
    assert normal_of(Robot.from_text(f"{{name: arm, convention: standard, joints: [{rows}]}}")) is None


def test_a_hand_that_leaves_the_plane_or_a_plane_that_turns_is_none() -> None:
    robot = Robot.load("planar-3r")
    frames = np.array(RobotPoses(robot).frames([0.3] * 3))
    raised, tilted = np.eye(4), np.eye(4)
    raised[2, 3] = 0.1
    tilted[1:3, 1:3] = [[0, -1], [1, 0]]
    scene = arm_scene(robot, frames.tolist())
    assert plane_normal([scene, scene]) is not None
    for moved in (raised, tilted):
        assert plane_normal([scene, arm_scene(robot, (moved @ frames).tolist())]) is None


@pytest.mark.parametrize(
    ("normal", "up", "right", "upwards"),
    [
        ((0, 0, 1), (0, 0, 1), (1, 0, 0), (0, 1, 0)),
        ((0, 0, -1), (0, 0, 1), (1, 0, 0), (0, 1, 0)),
        ((0, 0, 1), (0, 1, 0), (1, 0, 0), (0, 1, 0)),
        ((0, -1, 0), (0, 0, 1), (1, 0, 0), (0, 0, 1)),
        ((1, 0, 0), (0, 0, 1), (0, 1, 0), (0, 0, 1)),
    ],
)
def test_lengths_in_the_plane_are_kept_with_up_on_the_page(
    normal: tuple[float, ...], up: tuple[float, float, float], right: tuple[float, ...], upwards: tuple[float, ...]
) -> None:
    rows = view_along(np.array(normal, dtype=float), up).rows
    assert rows[0] == pytest.approx(right, abs=1e-4)
    assert rows[1] == pytest.approx(upwards, abs=1e-4)


def test_a_tilted_plane_is_seen_as_it_is_too() -> None:
    normal = np.array([0.0, -np.cos(0.5), np.sin(0.5)])
    assert view_along(normal, (0.0, 0.0, 1.0)).rows[2] == pytest.approx(normal, abs=1e-12)

"""Views and solid parts: a projection keeps what it must, planar arms are seen as they are, bodies are closed."""

import math

import numpy as np
import pytest

from derive.handouts.figure import projection
from derive.handouts.figure.scene import Scene, arm_scene
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses
from tests.random_robots import chains
from tests.rows import robot_of_rows

VIEWS = [
    projection.View(a, e, up) for a in (-2.0, 0.3) for e in (0.1, 1.2) for up in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
]


@pytest.mark.parametrize("view", VIEWS)
def test_lengths_along_the_page_are_kept_and_up_points_up(view: projection.View) -> None:
    right, upwards, toward = view.rows
    assert view.flat(3.0 * right) == pytest.approx((3.0, 0.0), abs=1e-12)
    assert view.flat(2.0 * upwards) == pytest.approx((0.0, 2.0), abs=1e-12)
    assert view.flat(toward) == pytest.approx((0.0, 0.0), abs=1e-12)
    x, y = view.flat(np.array(view.up))
    assert x == pytest.approx(0.0, abs=1e-12)
    assert y == pytest.approx(math.cos(view.elevation))


@pytest.mark.parametrize("view", VIEWS)
def test_faces_seen_from_behind_are_left_out_and_near_ones_come_last(view: projection.View) -> None:
    box = projection.prism(np.zeros(3), np.array((0.0, 0.0, 2.0)), 1.0, projection.LINK, sides=4)
    assert 1 <= len(list(projection.paint(box, view))) <= 3
    _, _, toward = view.rows
    square = np.stack([view.rows[0], view.rows[1], -view.rows[0]])
    far = projection.Faces((square - toward)[None], None, (0.2, 0.2, 0.2))
    near = projection.Faces((square + toward)[None], None, (0.8, 0.8, 0.8))
    assert [path.fill for path in projection.paint([near, far], view)] == [far.color, near.color]


def test_the_best_view_does_not_look_along_the_only_link() -> None:
    for axis in np.eye(3):
        ends = np.stack([np.zeros(3), axis])
        view = projection.best_view(ends, [np.eye(3)], [ends], (0.0, 0.0, 1.0))
        assert round(math.degrees(view.azimuth)) in projection.AZIMUTHS
        assert round(math.degrees(view.elevation)) in projection.ELEVATIONS
        assert np.hypot(*view.flat(axis)) > 0.5


PLANAR = {"planar-2r-perugia", "planar-3r", "skeleton", "skeleton-modified", "skeleton-root"}


def normal_of(robot: Robot) -> np.ndarray | None:
    poses = RobotPoses(robot)
    return projection.plane_normal([arm_scene(robot, poses.frames([0.3] * robot.n))])


def test_which_robots_are_planar_and_one_slide_has_no_plane() -> None:
    assert {name for name in chains() if normal_of(Robot.load(name)) is not None} == PLANAR
    slide = "P alpha: pi/2, theta: pi/2"
    normal = normal_of(robot_of_rows(f"{slide} | {slide}"))
    assert sorted(np.abs(normal)[:2]) == pytest.approx([0, 1], abs=1e-12)
    assert normal_of(robot_of_rows(slide)) is None


def test_a_hand_that_leaves_the_plane_or_a_plane_that_turns_is_none() -> None:
    robot = Robot.load("planar-3r")
    frames = np.array(RobotPoses(robot).frames([0.3] * 3))
    raised, tilted = np.eye(4), np.eye(4)
    raised[2, 3] = 0.1
    tilted[1:3, 1:3] = [[0, -1], [1, 0]]
    scene = arm_scene(robot, frames.tolist())
    assert projection.plane_normal([scene, scene]) is not None
    for moved in (raised, tilted):
        assert projection.plane_normal([scene, arm_scene(robot, (moved @ frames).tolist())]) is None


@pytest.mark.parametrize(
    ("normal", "up", "right", "upwards"),
    [
        ((0, 0, 1), (0, 0, 1), (1, 0, 0), (0, 1, 0)),
        ((0, 0, -1), (0, 0, 1), (1, 0, 0), (0, 1, 0)),
        ((0, 0, 1), (0, 1, 0), (1, 0, 0), (0, 1, 0)),
        ((0, -1, 0), (0, 0, 1), (1, 0, 0), (0, 0, 1)),
        ((1, 0, 0), (0, 0, 1), (0, 1, 0), (0, 0, 1)),
        ((0, -0.6, 0.8), (0, 0, 1), (1, 0, 0), (0, 0.8, 0.6)),
    ],
)
def test_lengths_in_the_plane_are_kept_with_up_on_the_page(
    normal: tuple[float, ...], up: tuple[float, float, float], right: tuple[float, ...], upwards: tuple[float, ...]
) -> None:
    rows = projection.view_along(np.array(normal, dtype=float), up).rows
    assert rows[0] == pytest.approx(right, abs=1e-4)
    assert rows[1] == pytest.approx(upwards, abs=1e-4)


SCALE = 100.0
SIZES = projection.Sizes(1.0)


def scene(name: str) -> Scene:
    robot = Robot.load(name)
    poses = RobotPoses(robot)
    return arm_scene(robot, poses.frames(poses.zero))


@pytest.mark.parametrize("sides", [3, 4, 20])
def test_a_prism_is_closed_and_its_normals_point_outwards(sides: int) -> None:
    start, end = np.array((1.0, 2.0, 3.0)), np.array((2.0, 1.0, 5.0))
    faces = projection.prism(start, end, 0.5, projection.LINK, sides=sides)
    assert sum(len(some.corners) for some in faces) == sides + 2
    for some in faces:
        for corners, normal in zip(some.corners, some.normals, strict=True):
            assert np.linalg.norm(normal) == pytest.approx(1.0)
            assert normal @ (corners.mean(axis=0) - (start + end) / 2) > 0
            assert np.ptp(corners @ normal) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke", "skeleton-modified", "spherical-wrist"])
def test_joints_are_drawn_on_their_axes_and_apart(name: str) -> None:
    arm = scene(name)
    centers = projection.joint_centers(arm, SCALE, SIZES)
    for joint, center in zip(arm.joints, centers, strict=True):
        assert np.linalg.norm(np.cross(center - joint.anchor * SCALE, joint.direction)) == pytest.approx(0.0, abs=1e-9)
    gaps = [np.linalg.norm(a - b) for k, a in enumerate(centers) for b in centers[:k]]
    assert min(gaps) > SIZES.cylinder[1]


def test_an_arm_grows_with_its_scale_and_its_joints_do_not() -> None:
    arm = scene("scara-perugia")
    small, large = (
        np.concatenate([faces.corners.reshape(-1, 3) for faces in projection.solid_faces(arm, k, SIZES)[0]])
        for k in (SCALE, 3 * SCALE)
    )
    assert 2.0 < np.ptp(large, axis=0).max() / np.ptp(small, axis=0).max() < 3.0


def test_what_faces_the_light_is_brighter() -> None:
    dark, bright = projection.shade(projection.LINK, np.array(((0.0, -1.0, 0.0), (0.0, 1.0, 0.0))))
    assert all(a < b <= 1.0 for a, b in zip(dark, bright, strict=True))

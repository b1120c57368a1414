"""Cells, orientations, blocks, and what an arm can reach at most."""

from typing import Any

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.inverse.numeric.chain import NumericChain
from derive.robot.robot import Robot
from derive.sampling.maps import MapGrid, extent, orientations_of
from derive.workspace.point import Range, joint_ranges
from derive.workspace.poses import RobotPoses
from tests.sampling.numeric_arms import ELBOW, PLANAR, PUMA, SCARA, UR5E, NumericArm


@pytest.mark.parametrize("arm", [UR5E, PUMA, PLANAR, SCARA, ELBOW], ids=lambda arm: arm.name)
@pytest.mark.first(1)
def test_no_configuration_leads_beyond_box_and_ball_and_some_lead_close(arm: NumericArm) -> None:
    ranges = joint_ranges(RobotPoses(arm.robot))
    least, most, radius = extent(NumericChain.of(arm.robot), ranges, [0, 1, 2])
    low, high = np.array([[way.lower, way.upper] for way in ranges]).T
    places = arm.pose_and_jacobian(np.random.default_rng(2).uniform(low, high, (100_000, len(ranges))))[0][:, :3, 3]
    assert ((places >= least) & (places <= most)).all()
    assert 0.93 * radius < np.linalg.norm(places - (least + most) / 2.0, axis=-1).max() <= radius


def test_extents_that_are_known() -> None:
    ranges = (Range("q1", 0.0, np.pi / 2, True), Range("q2", 0.0, 0.0, True), Range("q3", -np.pi, np.pi, True))
    low, high, _ = extent(NumericChain.of(PLANAR.robot), ranges, [0, 1])
    assert np.allclose([low, high], [[-0.2, -0.2], [1.1, 1.1]], atol=1e-8)
    # From the shoulder of a UR5e: |(L + sqrt(d5^2 + d6^2 s^2), d4 + d6 c)|, L the sum of both links.
    s = np.sin(np.linspace(0.0, np.pi, 100_001))
    c = np.sqrt(1.0 - s**2)
    most = np.hypot(0.425 + 0.3922 + np.sqrt(0.0997**2 + (0.0996 * s) ** 2), 0.1333 + 0.0996 * c).max()
    whole = MapGrid.of(UR5E.robot, 0.1)
    assert abs(whole.radius - most) < 1e-8
    assert np.allclose(whole.middle, [0.0, 0.0, 0.1625], atol=1e-8)


def test_blocks_hold_each_cell_once_and_all_that_are_within_reach() -> None:
    grid = MapGrid.of(SCARA.robot, 0.02)
    seen = np.zeros(grid.shape, dtype=int)
    for block in grid.blocks:
        seen[grid.slices(block)] += grid.cells(block)[1]
    middles = np.stack(np.meshgrid(*grid.centres, indexing="ij"), axis=-1)
    assert len(grid.blocks) > 2
    assert np.array_equal(seen, np.linalg.norm(middles - grid.middle, axis=-1) <= grid.radius)
    assert np.allclose(np.diff(grid.centres[0]), 0.02)


def test_directions_cover_the_sphere_and_rolls_a_turn() -> None:
    rotations, _, coordinates = orientations_of(("x", "y", "z", "orientation"), 200, 6)
    turns = rotations.reshape(200, 6, 3, 3)
    assert np.allclose(turns @ np.swapaxes(turns, -1, -2), np.eye(3))
    assert np.allclose(np.linalg.det(turns), 1.0)
    ways = np.stack([coordinates[f"direction_{name}"][1] for name in "xyz"], axis=-1)
    assert np.allclose(turns[..., 2], ways[:, None])
    assert np.allclose(ways.mean(axis=0), 0.0, atol=1e-2)
    assert np.allclose(3.0 * ways.T @ ways / 200, np.eye(3), atol=1e-2)
    nearest = np.sort(ways @ ways.T, axis=-1)[:, -2]
    assert np.degrees(np.arccos(nearest)).min() > 10.0  # of 15 where all are as far apart as can be
    step = np.swapaxes(turns[:, 0], -1, -2) @ turns[:, 1]
    assert np.allclose(step, [[0.5, -(0.75**0.5), 0.0], [0.75**0.5, 0.5, 0.0], [0.0, 0.0, 1.0]])
    assert np.allclose(orientations_of(("x", "y", "z", "approach"), 200, 6)[0][..., 2], ways)
    assert orientations_of(("x", "y"), 200, 6)[1] == {}


@pytest.mark.parametrize(
    ("robot", "options", "said"),
    [
        (PLANAR.robot, {"grid": 0.0}, "a grid of 0 m; allowed: the side of a cell in metres, above zero"),
        (PLANAR.robot, {"orientations": 0}, "0 orientations; allowed: whole numbers"),
        (PLANAR.robot, {"box": (0, 1, 0)}, "the box 0, 1, 0 is not .* allowed: x0,x1,y0,y1 with"),
        (PLANAR.robot, {"box": (5, 6, 0, 1)}, "x from -0.56.* to 1.1 m"),
        (Robot.load("spherical-wrist"), {}, "whose task orientation has no position"),
        (Robot.load("two-armed-torso"), {}, "the map of two-armed-torso, whose table is a tree"),
        (Robot.load("planar-3r"), {}, "the parameter 'a1' has no number"),
    ],
)
def test_what_is_no_map_is_refused(robot: Robot, options: dict[str, Any], said: str) -> None:
    with pytest.raises(DeriveError, match=said):
        MapGrid.of(robot, **options)

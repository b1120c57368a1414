"""The workspace: sampled positions are reached within the limits, and the outline lies around them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from derive.handouts.figure.poses import RobotPoses
from derive.handouts.figure.workspace import outline, sample_workspace, workspace_bytes
from derive.robot.robot import Robot

PLANAR = """
name: planar
convention: standard
joints:
  - {type: revolute, a: 1, limits: [0, pi/2]}
  - {type: revolute, a: 0.5}
"""


def test_positions_lie_between_the_inner_and_the_outer_reach() -> None:
    x, y, z = sample_workspace(RobotPoses(Robot.from_text(PLANAR)), 2000, 0).points
    reach = np.hypot(x, y)
    assert reach.min() >= 0.5 - 1e-12
    assert reach.max() <= 1.5 + 1e-12
    assert (reach.min(), reach.max()) == pytest.approx((0.5, 1.5), abs=0.01)
    assert np.abs(z).max() <= 1e-12


def test_limits_that_the_file_does_not_give_are_stated() -> None:
    (assumed,) = sample_workspace(RobotPoses(Robot.from_text(PLANAR)), 10, 0).assumed
    assert (assumed.variable, assumed.lower, assumed.upper, assumed.unit) == ("q2", -math.pi, math.pi, "rad")


def test_the_same_seed_gives_the_same_points() -> None:
    poses = RobotPoses(Robot.load("scara-perugia"))
    first, again, other = (sample_workspace(poses, 50, seed).points for seed in (3, 3, 4))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


@pytest.mark.filterwarnings("error")
def test_a_workspace_of_one_point_is_plotted_without_a_warning() -> None:
    pytest.importorskip("matplotlib")
    points = sample_workspace(RobotPoses(Robot.load("dh-modified-deluca")), 10, 0).points
    assert np.ptp(points, axis=1).max() <= 1e-12
    assert workspace_bytes(points, ".svg", "a point").startswith(b"<?xml")


def test_a_ring_has_an_outer_and_an_inner_outline() -> None:
    pytest.importorskip("contourpy")
    rng = np.random.default_rng(0)
    turn, radius = rng.uniform(-np.pi, np.pi, 20000), np.sqrt(rng.uniform(0.25, 1.0, 20000))
    lines = outline(radius * np.cos(turn), radius * np.sin(turn))
    sizes = sorted(float(np.hypot(*line.T).mean()) for line in lines)
    assert sizes == pytest.approx([0.5, 1.0], abs=0.1)
    assert all(np.allclose(line[0], line[-1]) for line in lines)

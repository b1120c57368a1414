"""Arms whose workspaces have closed forms, and maps of theirs."""

from __future__ import annotations

import numpy as np

from derive.robot.robot import Robot
from derive.workspace.point import ArmPoint, Picture, PlaneMap, joint_ranges
from derive.workspace.poses import RobotPoses

HOLED = "[{type: revolute, a: 1}, {type: revolute, a: 0.8}]"
"""A planar arm around whose base lies a hole of radius 0.2 m."""

LIMITED = "[{type: revolute, a: 1, limits: [0, pi/2]}, {type: revolute, a: 0.5, limits: [pi/6, 2]}]"

CUSPIDAL = "[{type: revolute, a: 1, alpha: -pi/2}, {type: revolute, d: 1, a: 2, alpha: pi/2}, {type: revolute, a: 1.5}]"
"""Burdick's and Wenger's orthogonal arm, which changes posture without meeting a singularity."""

CORNERED = """[{type: revolute, a: 1, alpha: -pi/2, limits: [-1, 2]},
  {type: revolute, d: 1, a: 2, alpha: pi/2, limits: [-2, 2.5]}, {type: revolute, a: 1.5, limits: [-2.2, 1]}]"""
"""The same within limits: from above, a small cell is reached only near the limit of joint 1."""

CYLINDRICAL = """[{type: prismatic, limits: [0.2, 1]}, {type: revolute, alpha: -pi/2, limits: [-1, 2]},
  {type: prismatic, limits: [0.3, 0.9]}]"""

GANTRY = """[{type: prismatic, alpha: -pi/2, limits: [0, 1]},
  {type: prismatic, alpha: -pi/2, theta: -pi/2, limits: [0, 2]}, {type: prismatic, limits: [0, 0.5]}]"""

TUBE = "[{type: revolute, a: 2, alpha: pi/2}, {type: revolute, a: 1}, {type: revolute, a: 0.4}]"
"""A torus with a torus inside that is not reached."""


STRAIGHT = """[{type: revolute, a: 0.686, alpha: -pi/2, limits: [-2.674, -1.935]},
  {type: revolute, a: 0.276, alpha: 0.7, d: 0.418}, {type: revolute, a: 0.136, alpha: -pi/2}]"""
"""Critical curves that are straight from above run back on themselves at both ends, and are tilted by the limits."""

EDGEWISE = """[{type: revolute, a: 0.562, d: -0.323, alpha: -pi/2, limits: [0.342, 3.1]},
  {type: revolute, a: 0.483, d: 0.744}, {type: revolute, a: 0.844, d: 0.713, alpha: -1.1, limits: [-0.129, 3.1]}]"""
"""From above joints 2 and 3 move the end along a line, parts of which belong to no limit."""

CLOSED = """[{type: revolute, a: 0.238, d: 0.582, alpha: -pi/2, limits: [-1.765, -0.975]},
  {type: revolute, a: 0.597, alpha: pi/3, limits: [-2.55, 2.792]}]"""
"""The section is a curve without an end, which bounds an area and covers none."""


def limited_joints(rng: np.random.Generator) -> str:
    """Three joints with lengths, twists and limits at random."""
    rows = []
    for _ in range(3):
        low = rng.uniform(-3.1, 0.5)
        limits = f", limits: [{low:.3f}, {min(low + rng.uniform(0.6, 5.5), 3.1):.3f}]" if rng.random() < 0.75 else ""
        twist, (a, d) = rng.choice(["0", "pi/2", "-pi/2", "0.7", "-1.1"]), rng.uniform((0.1, -0.5), (1.0, 0.8))
        rows.append(f"{{type: revolute, a: {a:.3f}, d: {d:.3f}, alpha: {twist}{limits}}}")
    return f"[{', '.join(rows)}]"


def arm(joints: str, rest: str = "") -> Robot:
    return Robot.from_text(f"name: arm\nconvention: standard\njoints: {joints}\n{rest}")


def plane(robot: Robot, picture: Picture, place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> PlaneMap:
    poses = RobotPoses(robot)
    return PlaneMap.of(ArmPoint(poses, joint_ranges(poses), place), picture)

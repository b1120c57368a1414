"""Arms whose workspaces have closed forms, and maps of theirs."""

from __future__ import annotations

from derive.handouts.figure.poses import RobotPoses
from derive.handouts.figure.workspace.point import ArmPoint, Picture, PlaneMap, joint_ranges
from derive.robot.robot import Robot

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


def arm(joints: str, rest: str = "") -> Robot:
    """A robot with these joints."""
    return Robot.from_text(f"name: arm\nconvention: standard\njoints: {joints}\n{rest}")


def plane(robot: Robot, picture: Picture, place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> PlaneMap:
    """A picture of a robot's workspace."""
    poses = RobotPoses(robot)
    return PlaneMap.of(ArmPoint(poses, joint_ranges(poses), place), picture)

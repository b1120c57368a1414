"""Arms whose workspaces have closed forms, and maps of theirs."""

from functools import cache

import numpy as np

from derive.robot.robot import Robot
from derive.workspace.point import ArmPoint, Picture, PlaneMap, joint_ranges
from derive.workspace.poses import RobotPoses
from tests.rows import robot_of_rows

ARMS = {
    # a planar arm around whose base lies a hole of radius 0.2 m
    "holed": "R a: 1 | R a: 0.8",
    "limited": "R a: 1, limits: [0, pi/2] | R a: 0.5, limits: [pi/6, 2]",
    # Burdick's and Wenger's orthogonal arm, which changes posture without meeting a singularity
    "cuspidal": "R a: 1, alpha: -pi/2 | R d: 1, a: 2, alpha: pi/2 | R a: 1.5",
    # the same within limits: from above, a small cell is reached only near the limit of joint 1
    "cornered": "R a: 1, alpha: -pi/2, limits: [-1, 2]"
    " | R d: 1, a: 2, alpha: pi/2, limits: [-2, 2.5] | R a: 1.5, limits: [-2.2, 1]",
    "cylindrical": "P limits: [0.2, 1] | R alpha: -pi/2, limits: [-1, 2] | P limits: [0.3, 0.9]",
    "gantry": "P alpha: -pi/2, limits: [0, 1] | P alpha: -pi/2, theta: -pi/2, limits: [0, 2] | P limits: [0, 0.5]",
    # a torus with a torus inside that is not reached
    "tube": "R a: 2, alpha: pi/2 | R a: 1 | R a: 0.4",
    # critical curves that are straight from above run back on themselves at both ends, and are tilted by the limits
    "straight": "R a: 0.686, alpha: -pi/2, limits: [-2.674, -1.935]"
    " | R a: 0.276, alpha: 0.7, d: 0.418 | R a: 0.136, alpha: -pi/2",
    # from above joints 2 and 3 move the end along a line, parts of which belong to no limit
    "edgewise": "R a: 0.562, d: -0.323, alpha: -pi/2, limits: [0.342, 3.1] | R a: 0.483, d: 0.744"
    " | R a: 0.844, d: 0.713, alpha: -1.1, limits: [-0.129, 3.1]",
    # the section is a curve without an end, which bounds an area and covers none
    "closed": "R a: 0.238, d: 0.582, alpha: -pi/2, limits: [-1.765, -0.975]"
    " | R a: 0.597, alpha: pi/3, limits: [-2.55, 2.792]",
}


def limited_joints(rng: np.random.Generator) -> str:
    """Three joints with lengths, twists and limits at random."""
    rows = []
    for _ in range(3):
        low = rng.uniform(-3.1, 0.5)
        limits = f", limits: [{low:.3f}, {min(low + rng.uniform(0.6, 5.5), 3.1):.3f}]" if rng.random() < 0.75 else ""
        twist, (a, d) = rng.choice(["0", "pi/2", "-pi/2", "0.7", "-1.1"]), rng.uniform((0.1, -0.5), (1.0, 0.8))
        rows.append(f"R a: {a:.3f}, d: {d:.3f}, alpha: {twist}{limits}")
    return " | ".join(rows)


def arm(joints: str) -> Robot:
    """One of these arms, a built-in robot, or an arm of other joints."""
    return robot_of_rows(ARMS.get(joints, joints)) if joints in ARMS or "R " in joints else Robot.load(joints)


@cache
def point(joints: str, place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> ArmPoint:
    poses = RobotPoses(arm(joints))
    return ArmPoint(poses, joint_ranges(poses), place)


def plane(joints: str, picture: Picture) -> PlaneMap:
    return PlaneMap.of(point(joints), picture)

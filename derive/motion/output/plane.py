"""The plane in which the arm of a motion moves, from whose normal films and pages show it."""

from dataclasses import replace

import numpy as np

from derive.arrays import Array
from derive.handouts.figure.projection import plane_normal
from derive.handouts.figure.scene import arm_scene
from derive.motion.motion import Motion
from derive.workspace.poses import RobotPoses

TIMES = 9  # when is looked whether a base that moves leaves the plane


def frames_of(motion: Motion, times: Array, q: Array) -> Array:
    """Where the frames of the arm are."""
    robot = motion.plan.robot
    values = (*robot.parameters, *motion.plan.values.items())
    poses = RobotPoses(replace(robot, parameters=tuple(dict(values).items())))
    frames = np.array([poses.frames([float(value) for value in row]) for row in q])
    moving = motion.base
    return frames if moving is None else moving(times, 0)[:, None] @ frames


def motion_normal(motion: Motion) -> Array | None:
    """The unit normal of the plane in which an arm moves; None where it moves in space, by its joints or its base."""
    times = np.linspace(0.0, motion.duration, TIMES)
    robot = motion.plan.robot
    return plane_normal([arm_scene(robot, frames) for frames in frames_of(motion, times, motion(times)[0])])

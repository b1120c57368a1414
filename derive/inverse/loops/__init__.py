"""Closed loops: the positions of passive joints, and how they move."""

from derive.robot.robot import Robot


def without_parallelograms(robot: Robot) -> Robot:
    """The robot with loops that equal lengths make linear written as coupled joints."""
    if not robot.loops:
        return robot
    from derive.inverse.loops.parallelogram import reduced  # NumPy, which models without loops do not need

    return reduced(robot)

"""Which robots there are, and how a function of the Python API is given one."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path

from derive.errors import RobotFileWarning
from derive.robot.cells import joint_values
from derive.robot.expression import Expression
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot

RobotLike = Robot | str | Path
"""A robot, the path of a robot file, or a name of the catalogue."""


def catalogue() -> tuple[str, ...]:
    """Names of the built-in robots.

    Returns:
        The names that ``derive list`` shows, sorted.
    """
    return catalogue_names()


def load(robot: RobotLike) -> Robot:
    """Load a robot.

    Args:
        robot: Path of a robot file, a name of the catalogue, or a robot, which stays as it is.

    Returns:
        The validated robot; its ``remarks`` are issued as `RobotFileWarning`, too.

    Raises:
        RobotFileError: The file cannot be read or does not describe a robot.
        UnknownRobotError: Neither a file nor a catalogue name.
    """
    return robot if isinstance(robot, Robot) else with_remarks(Robot.load(robot))


def with_remarks(robot: Robot) -> Robot:
    """Issue the remarks on a robot's file as warnings.

    Args:
        robot: A robot that has just been read.

    Returns:
        The same robot.
    """
    for remark in robot.remarks:
        warnings.warn(str(remark), RobotFileWarning, stacklevel=3)
    return robot


def load_all(robots: Iterable[RobotLike] | None) -> list[Robot]:
    """Load several robots.

    Args:
        robots: Robots, paths or names; None for the whole catalogue.

    Returns:
        The validated robots in that order.

    Raises:
        RobotFileError: A file cannot be read or does not describe a robot.
        UnknownRobotError: Neither a file nor a catalogue name.
    """
    return [load(robot) for robot in (catalogue() if robots is None else robots)]


def configuration(robot: Robot, q: Sequence[float | str]) -> tuple[Expression, ...]:
    """Exact joint values from numbers or cells.

    Args:
        robot: The robot.
        q: One number or cell such as ``"pi/2"`` per joint, in the units of the robot file (rad and m by default).

    Returns:
        The configuration [rad or m].

    Raises:
        DeriveError: Not one value per joint, or a value that is no number.
    """
    return joint_values(robot, [value if isinstance(value, str) else str(float(value)) for value in q])

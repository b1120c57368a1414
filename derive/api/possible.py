"""Links that exist, from Python: what ``--inertia possible`` makes of a robot."""

from __future__ import annotations

from derive.api.robots import Robot, RobotLike, load
from derive.model.identification.possible import Possible
from derive.model.identification.possible import possible as nearest


def possible(robot: RobotLike) -> Possible:
    """The nearest bodies that exist and give the same torques.

    Args:
        robot: Path of a robot file, a name of the catalogue, or a robot; its symbols all have numbers.

    Returns:
        The robot with these links, what was changed, and the text of its robot file.

    Raises:
        NoSuchBodies: There are none; the message says why.
        DeriveError: The robot has no links or symbols without numbers, or the packages of the extra are missing.
    """
    return nearest(Robot.of(load(robot, remarks_on_bodies=False)))

"""Which rows of the Jacobian belong to an arm's task."""

from collections.abc import Mapping
from contextlib import suppress
from math import sin

from derive.errors import ExpressionError
from derive.robot.description import Convention
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import ZERO
from derive.robot.options.inverse import POSE
from derive.robot.robot import Robot

PARTS = {"position": (0, 1, 2), "orientation": (3, 4, 5)}
_TURNS: Mapping[str, tuple[int, ...]] = {"phi": (5,), "approach": (3, 4, 5), "orientation": (3, 4, 5)}
_PARALLEL = 1e-12  # sine of a twist that is rounding


def task_rows(robot: Robot, part: str = "all") -> tuple[int, ...]:
    """The rows, from 0, of the task of the robot file, in the world, or of what moves of a part, in joint frame 1.

    The natural task is all that moves if that has at most as many rows as the arm has joints, else the position; of a
    wrist it is the orientation.
    """
    if part == "all" and robot.inverse.task != POSE:
        return tuple(sorted({row for word in robot.inverse.task for row in _TURNS.get(word, ("xyz".find(word),))}))
    inner = robot.joints[:-1] if robot.convention is Convention.STANDARD else robot.joints[1:]
    turns = [joint.is_revolute for joint in robot.joints]
    moving = tuple(range(6))
    with suppress(ExpressionError):
        values = parameter_values(robot)
        if all(abs(sin(to_float(joint.alpha, values))) < _PARALLEL for joint in inner):
            moving = (*(0, 1) * any(turns), *(2,) * (not all(turns)), *(5,) * any(turns))
    if part == "all" and len(moving) > robot.n:
        meeting = robot.n == 3 and all(turns) and {joint.a for joint in inner} | {robot.joints[1].d} == {ZERO}
        part = "orientation" if meeting else "position"
    return tuple(row for row in moving if row in PARTS.get(part, moving))

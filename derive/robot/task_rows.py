"""Which rows of the Jacobian belong to an arm's task."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from math import nan, sin

from derive.errors import ExpressionError
from derive.robot.description import Convention
from derive.robot.evaluate import parameter_values, to_float
from derive.robot.expression import Expression
from derive.robot.names import free_symbols
from derive.robot.options.inverse import POSE
from derive.robot.robot import Robot

PARTS = {"position": (0, 1, 2), "orientation": (3, 4, 5)}
_TURNS: Mapping[str, tuple[int, ...]] = {"phi": (5,), "approach": (3, 4, 5), "orientation": (3, 4, 5)}
_ROUNDING = 1e-12  # what is left of the sine of a twist, or of a length [m], that vanishes


def task_rows(robot: Robot, part: str = "all", *, are_parallel: bool | None = None) -> tuple[int, ...]:
    """The rows, from 0, of the task of the robot file, in the world, or of what moves of a part, in joint frame 1.

    ``are_parallel`` says whether all axes are, where the table alone does not: of the arm that leads to a tree's end.
    """
    # The natural task is all that moves if that has at most as many rows as the arm has joints, else the position; of
    # a wrist it is the orientation.
    if part == "all" and robot.inverse.task != POSE:
        return tuple(sorted({row for word in robot.inverse.task for row in _TURNS.get(word, ("xyz".find(word),))}))
    inner = robot.joints[:-1] if robot.convention is Convention.STANDARD else robot.joints[1:]
    turns, moving = [joint.is_revolute for joint in robot.joints], tuple(range(6))
    values = parameter_values(robot) | dict.fromkeys(free_symbols(robot), nan)

    def _vanishes(cell: Expression, function: Callable[[float], float] = float) -> bool:
        """Whether it is 0 whatever the numbers of free symbols, but for rounding."""
        with suppress(ExpressionError):
            return abs(function(to_float(cell, values))) < _ROUNDING
        return False

    parallel = [_vanishes(joint.alpha, sin) for joint in inner]
    if all(parallel) if are_parallel is None else are_parallel:
        moving = (*(0, 1) * any(turns), *(2,) * (not all(turns)), *(5,) * any(turns))
    if part == "all" and len(moving) > robot.n:
        is_wrist = are_parallel is None and robot.n == 3 and all(turns) and not any(parallel)
        is_wrist = is_wrist and all(map(_vanishes, [*(joint.a for joint in inner), robot.joints[1].d]))
        part = "orientation" if is_wrist else "position"
    return tuple(row for row in moving if row in PARTS.get(part, moving))

"""Joint limits as numbers."""

from __future__ import annotations

from derive.algebra.tape_cells import exact_number
from derive.algebra.tape_constant import to_float
from derive.robot.names import number_of
from derive.robot.robot import Joint, Robot


def joint_limits(robot: Robot) -> tuple[str, ...]:
    """``(lower, upper)`` or ``None`` for each joint [rad, m]; None also where a limit has no number."""
    return tuple(_limits(robot, joint) for joint in robot.joints)


def _limits(robot: Robot, joint: Joint) -> str:
    if joint.limits is None:
        return "None"
    bounds = [exact_number(bound, number_of(robot)) for bound in joint.limits]
    if any(bound is None for bound in bounds):
        return "None"
    return f"({', '.join(repr(to_float(bound)) for bound in bounds)})"

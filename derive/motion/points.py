"""What a plan names: poses, points, and what the tool carries."""

from __future__ import annotations

from dataclasses import dataclass

from derive.errors import Location
from derive.robot.expression import ZERO, Expression

Vector = tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Pose:
    """Where the end effector shall be.

    Attributes:
        position: In the world frame [m].
        angles: Roll, pitch, yaw, or Euler angles ZYZ [rad]; None for a position alone.
        is_zyz: Which of the two.
    """

    position: Vector
    angles: Vector | None
    is_zyz: bool


@dataclass(frozen=True, slots=True)
class Point:
    """A named configuration.

    Attributes:
        name: Its name.
        q: Joint variables [rad or m]; None where it is a pose.
        pose: The pose, None where it is given by joint variables.
        branch: Words of the name of the solution, such as ``elbow up``; empty for the nearest.
        location: Where it stands in the plan.
    """

    name: str
    q: Vector | None
    pose: Pose | None
    branch: str
    location: Location


@dataclass(frozen=True, slots=True)
class Payload:
    """A body that the tool carries, in the frame of the end effector.

    Attributes:
        mass: [kg].
        com: Centre of mass [m].
        inertia: Principal moments about it [kg m^2].
    """

    mass: Expression = ZERO
    com: Vector = (ZERO, ZERO, ZERO)
    inertia: Vector = (ZERO, ZERO, ZERO)

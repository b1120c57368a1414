"""What a plan names: poses, points, what the tool carries, and the segments between points."""

from __future__ import annotations

from dataclasses import dataclass

from derive.errors import Location
from derive.plans.profile import Profile
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


@dataclass(frozen=True, slots=True)
class Step:
    """One segment of the path.

    Attributes:
        to: Name of the point at its end.
        time: Its length [s]; None where limits decide.
        profile: How the arm goes.
        stops: Whether it stands at the end.
        cruise: Trapezoid: top speed as a multiple of distance by time; None for the usual one.
        straight: Whether the end effector moves on a line.
        through: Point of an arc in space; empty for none.
        by_hand: Whether the end effector moves on a spline in space, through this point and those beside it.
        payload: What the tool carries.
        location: Where it stands in the plan.
    """

    to: str
    time: Expression | None
    profile: Profile
    stops: bool
    cruise: Expression | None
    straight: bool
    through: str
    by_hand: bool
    payload: Payload | None
    location: Location

    @property
    def in_space(self) -> bool:
        """Whether the end effector moves on a line or an arc."""
        return self.straight or bool(self.through)

    @property
    def follows(self) -> bool:
        """Whether the joints follow the end effector."""
        return self.in_space or self.by_hand

"""What a plan names: poses, points, what the tool carries, and the segments between points."""

from dataclasses import dataclass

from derive.errors import Location
from derive.plans.profile import Profile
from derive.robot.expression import ZERO, Expression

Vector = tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Pose:
    """Where the end effector shall be."""

    position: Vector  # in the world frame [m]
    angles: Vector | None  # roll, pitch, yaw, or Euler angles ZYZ [rad]; None for a position alone
    is_zyz: bool  # which of the two


@dataclass(frozen=True, slots=True)
class Point:
    """A named configuration."""

    name: str  # its name
    q: Vector | None  # joint variables [rad or m]; None where it is a pose
    pose: Pose | None  # the pose, None where it is given by joint variables
    branch: str  # words of the name of the solution, such as ``elbow up``; empty for the nearest
    location: Location  # where it stands in the plan


@dataclass(frozen=True, slots=True)
class Payload:
    """A body that the tool carries, in the frame of the end effector."""

    mass: Expression = ZERO  # [kg]
    com: Vector = (ZERO, ZERO, ZERO)  # centre of mass [m]
    inertia: Vector = (ZERO, ZERO, ZERO)  # principal moments about it [kg m^2]


@dataclass(frozen=True, slots=True)
class Step:
    """One segment of the path."""

    to: str  # name of the point at its end
    time: Expression | None  # its length [s]; None where limits decide
    profile: Profile  # how the arm goes
    stops: bool  # whether it stands at the end
    cruise: Expression | None  # trapezoid: top speed as a multiple of distance by time; None for the usual one
    straight: bool  # whether the end effector moves on a line
    through: str  # point of an arc in space; empty for none
    by_hand: bool  # whether the end effector moves on a spline in space, through this point and those beside it
    payload: Payload | None  # what the tool carries
    location: Location  # where it stands in the plan

    @property
    def in_space(self) -> bool:
        """Whether the end effector moves on a line or an arc."""
        return self.straight or bool(self.through)

    @property
    def follows(self) -> bool:
        """Whether the joints follow the end effector."""
        return self.in_space or self.by_hand

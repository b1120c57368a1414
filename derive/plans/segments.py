"""What a plan names, and the segments of a motion with their pieces, peaks and formulas of time, as plain data."""

from dataclasses import dataclass

from sympy import Expr, Float, Poly, Symbol, cos, expand, pi

from derive.errors import Location
from derive.plans.profile import AnyPiece, Cosine, Curve, Profile
from derive.robot.expression import ZERO, Expression

Vector = tuple[Expression, ...]
Joints = tuple[tuple[AnyPiece, ...], ...]  # the pieces of each joint

LOCAL_TIME = Symbol("t")  # since the segment began
DIGITS = 12  # of coefficients that are not exact
ROUNDING = 1e-12  # a coefficient that is less, relative to the largest one, is nothing but rounding


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
    end: str = ""  # of a pose the end of a tree that shall be there; empty for one without a name


@dataclass(frozen=True, slots=True)
class Payload:
    """A body that the tool carries, in the frame of the end effector."""

    mass: Expression = ZERO  # [kg]
    com: Vector = (ZERO, ZERO, ZERO)  # centre of mass [m]
    inertia: Vector = (ZERO, ZERO, ZERO)  # principal moments about it [kg m^2]
    end: str = ""  # the end of a tree that carries it; empty for one without a name


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
    end: str = ""  # the end of a tree on that way; empty for one without a name, or where none is meant

    @property
    def in_space(self) -> bool:
        """Whether the end effector moves on a line or an arc."""
        return self.straight or bool(self.through)

    @property
    def follows(self) -> bool:
        """Whether the joints follow the end effector."""
        return self.in_space or self.by_hand


@dataclass(frozen=True, slots=True)
class Disturbance:
    """What pushes a joint for a time."""

    joint: int  # index of the joint
    torque: Expression  # torque or force [N m or N]
    start: Expression  # when it begins [s]
    end: Expression  # when it ends [s]


@dataclass(frozen=True, slots=True)
class Segment:
    """The way from one point to the next."""

    name: str  # ``rest -> A``
    start: Expr  # [s]
    duration: Expr  # [s]
    joints: Joints

    @property
    def corners(self) -> tuple[float, ...]:
        """Times within it at which a piece of a joint begins, so that accelerations may jump [s]."""
        return tuple(sorted({float(piece.start) for pieces in self.joints for piece in pieces[1:]}))


@dataclass(frozen=True, slots=True)
class Peak:
    """The largest magnitude of a derivative of one joint."""

    value: Expr  # with its sign [rad/s, m/s, rad/s^2 or m/s^2]
    time: Expr  # when [s]; the earliest of equal ones
    is_exact: bool  # whether both are exact; a `Float` otherwise


@dataclass(frozen=True, slots=True)
class Load:
    """What a joint does in a segment."""

    peak: float  # the torque that is largest in magnitude, also between samples [N m or N]
    time: float  # when [s]; the earliest of equal ones
    rms: float  # root of the mean of its square
    power: float  # the largest mechanical power in magnitude [W]
    work: float  # integral of torque by velocity [J]


@dataclass(frozen=True, slots=True)
class SegmentPeaks:
    """The largest values of every joint in a segment."""

    segment: Segment
    speeds: tuple[Peak, ...]  # exact where the profile allows
    accelerations: tuple[Peak, ...]
    loads: tuple[Load, ...]  # torques; empty where the robot has no dynamics
    base: Load | None = None  # power of a base that moves, as the torque at a speed of one; None where it stands

    @property
    def work(self) -> float:
        """Of all joints, the integral of tau qd [J]."""
        return float(sum(load.work for load in self.loads))


def formula(piece: AnyPiece, segment: Segment) -> Expr:
    """The position of a joint as a formula of the time since its segment began."""
    if isinstance(piece, Curve):
        return piece.formulas[0].subs(next(iter(piece.formulas[0].free_symbols), LOCAL_TIME), LOCAL_TIME)
    u = (LOCAL_TIME - piece.start + segment.start) / piece.duration
    if isinstance(piece, Cosine):
        (q0,), (q1,) = piece.values
        return q0 + (q1 - q0) * (1 - cos(pi * u)) / 2
    polynomial = piece.in_unit_time()
    if piece.is_exact:
        return expand(polynomial.as_expr().subs(polynomial.gen, u))
    numbers = [float(c) for c in polynomial.all_coeffs()]
    least = ROUNDING * max(map(abs, numbers))
    kept = Poly([Float(c) if abs(c) > least else 0 for c in numbers], polynomial.gen)
    return expand(kept.as_expr().subs(kept.gen, u.evalf())).evalf(DIGITS)

"""Segments of a motion as plain data: their pieces, the largest values of every joint, and formulas of time."""

from dataclasses import dataclass

from sympy import Expr, Float, Poly, Symbol, cos, expand, pi

from derive.plans.profile import AnyPiece, Cosine, Curve

Joints = tuple[tuple[AnyPiece, ...], ...]  # the pieces of each joint

LOCAL_TIME = Symbol("t")  # since the segment began
DIGITS = 12  # of coefficients that are not exact
ROUNDING = 1e-12  # a coefficient that is less, relative to the largest one, is nothing but rounding


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

"""How far the poses of a table can be from those of the arm that it was made for: a bound that holds everywhere.

Both arms are products of exponentials, exp(S_1 q_1) ... exp(S_n q_n) M (Brockett; Lynch and Park, Modern Robotics,
4.1). Replacing one factor after the other changes the pose by what a turn about a slightly other axis does: axes that
differ by an angle e and a distance h turn a point at a distance r to places at most 2 e r + 2 h apart; slides of s
along them by e s. The sum over all joints is the bound, with what the digits of the table's base lack to a rotation:
by that much it is no rigid motion. It is computed in balls from the numbers of both files.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context

from flint import arb

from derive.errors import ExpressionError, QuantityError
from derive.exchange.arm import Arm
from derive.mechanics.space import Frame, Line, Real, exactly, length, plus, real, times, unit
from derive.mechanics.vectors import dot
from derive.model.identification.exact_scalars import exact_value
from derive.robot.description import Convention, Description, FixedRow, Joint, Matrix
from derive.robot.expression import Expression

EXACT = 1e-30  # a bound below is one of exact numbers


@dataclass(frozen=True, slots=True)
class Certificate:
    """A bound for all angles and for slides within the limits of the URDF, 1 m to either side where it gives none."""

    position: float  # largest distance of both end effectors [m]
    rotation: float  # largest angle between both end effectors [rad]

    def __str__(self) -> str:
        return f"pose error over all limits <= {self.amounts}, proven"

    @property
    def amounts(self) -> str:
        """Distance and angle."""
        return f"{_above(self.position)} m and {_above(self.rotation)} rad"

    @property
    def printed(self) -> Certificate:
        """The bound as it is printed, which is not below."""
        return Certificate(float(_above(self.position)), float(_above(self.rotation)))


def certify(arm: Arm, robot: Description) -> Certificate:
    """The bound."""
    with exactly():
        base = frame_of(robot.base, _numbers(robot))
        # The rigid frame next to the base, whose decimals are no rotation: axes of length 1 that are perpendicular.
        z = unit(base.z)
        rigid = Frame.of(base.origin, unit(plus(base.x, z, -dot(base.x, z))), z)
        axes, end = screws(robot, rigid)
        position = length(plus(arm.end.origin, end.origin, -1))
        rotation = _apart(arm.end, end)
        beyond, place = arb(0), arm.end.origin
        for axis, line in reversed(list(zip(arm.axes, axes, strict=True))):
            # Of two unit vectors that are close, |a - b| <= angle <= pi/2 |a - b|.
            angle = arb.pi() / 2 * length(plus(axis.line.direction, line.direction, -1))
            # Turns about axes that differ by an angle e: |R - R'| <= 2 e, at the distance of what is beyond the pivot;
            # by a distance h: 2 h, there and back.
            if axis.is_revolute:
                pivot = axis.line.foot(place)
                position += 2 * angle * (beyond + length(plus(place, pivot, -1))) + 2 * line.distance(pivot)
                rotation += 2 * angle
                beyond += length(plus(place, pivot, -1))
                place = pivot
            else:
                travel = real(max(map(abs, axis.travel)))
                position += angle * travel
                beyond += travel
        # What the decimals of the base stretch acts on everything that the arm reaches.
        skew, far = _apart(base, rigid), beyond + length(plus(place, base.origin, -1)) + position
        return Certificate(_up(position + skew * far), _up(rotation + 2 * skew))


def screws(robot: Description, base: Frame) -> tuple[list[Line], Frame]:
    """The axes of a table and its end at q = 0, in the world."""
    known, frame, lines, standard = _numbers(robot), base, [], robot.convention is Convention.STANDARD
    for joint in robot.joints:
        along, across = motions(joint, known)
        axis = frame if standard else frame.then(across)
        lines.append(Line(axis.origin, times(axis.z, joint.sign)))
        frame = axis.then(along).then(across) if standard else axis.then(along)
    return lines, frame.then(frame_of(robot.tool, known))


def _numbers(robot: Description) -> dict[str, Real]:
    found: dict[str, Real] = {}
    for name, cell in robot.parameters:
        found[name] = ball(cell, found)
    return found


def ball(cell: Expression, known: Mapping[str, Real] | None = None) -> Real:
    """A cell as a ball."""
    try:
        return arb(exact_value(cell, known or {}))
    except ExpressionError:
        remedy = "give them numbers under parameters:"
        raise QuantityError("a table with symbols has no numeric poses", remedy=remedy) from None


def motions(row: Joint | FixedRow, known: Mapping[str, Real] | None = None) -> tuple[Frame, Frame]:
    """Rot(z, theta) Trans(z, d) and Trans(x, a) Rot(x, alpha) of a row."""
    theta, d, a, alpha = (ball(cell, known) for cell in (row.theta, row.d, row.a, row.alpha))
    (ct, st), (ca, sa) = ((angle.cos(), angle.sin()) for angle in (theta, alpha))
    zero, one = arb(0), arb(1)
    along = Frame((zero, zero, d), (ct, st, zero), (-st, ct, zero), (zero, zero, one))
    return along, Frame((a, zero, zero), (one, zero, zero), (zero, ca, sa), (zero, -sa, ca))


def frame_of(matrix: Matrix, known: Mapping[str, Real] | None = None) -> Frame:
    """A transform of numbers."""
    rows = [[ball(cell, known) for cell in row] for row in matrix[:3]]
    x, y, z, origin = ((rows[0][k], rows[1][k], rows[2][k]) for k in range(4))
    return Frame(origin, x, y, z)


def _apart(a: Frame, b: Frame) -> Real:
    """The Frobenius norm of the difference of two rotations: at least its largest stretch, and the angle up to 2.7."""
    differences = [plus(one, other, -1) for one, other in ((a.x, b.x), (a.y, b.y), (a.z, b.z))]
    square = sum((dot(difference, difference) for difference in differences), arb(0))
    return length((square.abs_upper().sqrt(), arb(0), arb(0)))


def _above(value: float) -> str:
    """Two digits, rounded up; smaller bounds than `EXACT` are not told apart."""
    return f"{float(Context(prec=2, rounding=ROUND_CEILING).create_decimal(repr(max(value, EXACT)))):.2g}"


def _up(value: Real) -> float:
    return float(value.abs_upper()) * (1 + 1e-15)

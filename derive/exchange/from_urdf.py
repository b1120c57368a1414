"""A robot from a URDF: its table by common normals, its links in the frames of the table."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import floor, log10

from flint import arb

from derive.exchange.arm import FRACTIONS, Arm, Axis, Mass, arm_of
from derive.exchange.certificate import Certificate, certify
from derive.exchange.common_normals import Placement, Row, place
from derive.exchange.space import NOTHING, Frame, Point, Real, dot, exactly, plus, real
from derive.exchange.urdf import Urdf
from derive.robot.description import Convention, Description, Inertia, Joint, JointType, Link, Matrix
from derive.robot.expression import ONE, ZERO, Call, Expression, Name, Pi, multiply, number
from derive.robot.robot import Robot
from derive.robot.writer import robot_text

DIGITS = 17
"""Of a number that is none of a few digits."""

DIVISORS = 180
"""Angles that are exact multiples of pi by this are written so."""

TOUCHING = 1e-9
"""Lengths below are zero [m]."""

GRAVITY = Fraction(981, 100)
"""Where a format says nothing [m/s^2]."""


@dataclass(frozen=True, slots=True)
class Imported:
    """A robot and what is known about its making.

    Attributes:
        text: The robot file.
        robot: What it says.
        certificate: How far its poses are from the URDF's.
        notes: What a reader should know, as sentences.
    """

    text: str
    robot: Robot
    certificate: Certificate
    notes: tuple[str, ...]


def import_urdf(
    urdf: Urdf, base: str | None, tip: str | None, convention: Convention, snap: Fraction, name: str | None = None
) -> Imported:
    """The robot of a chain of a URDF.

    Args:
        urdf: The file.
        base: Link that stands; None for the root.
        tip: Last link; None where only one carries no other.
        convention: Of the table.
        snap: Angles closer to simple fractions of pi are taken for them [rad].
        name: Of the robot; None for that of the URDF.

    Returns:
        The robot file with its certificate.

    Raises:
        RobotFileError: There is no such chain, or a joint of it has no place in a table.
    """
    with exactly():
        arm = arm_of(urdf, base, tip, snap)
        placement = place(arm, convention, float(snap))
        description = _description(urdf, arm, placement, snap, name)
        text = robot_text(description)
        robot = Robot.from_text(text, f"{description.name}.yaml")
        certificate = certify(arm_of(urdf, base, tip, Fraction(0)), robot)
        held = (f"held at zero: {', '.join(arm.held)}",) if arm.held else ()
        notes = (*urdf.notes, *held)
        head = [f"{arm.base} to {arm.tip} of {urdf.source}: {', '.join(axis.joint.name for axis in arm.axes)}"]
        text = robot_text(description, [*head, *map(str, certificate.lines), *notes])
    return Imported(text, Robot.from_text(text, f"{description.name}.yaml"), certificate, notes)


def _description(urdf: Urdf, arm: Arm, placement: Placement, snap: Fraction, name: str | None) -> Description:
    joints = tuple(
        _joint(i, axis, row, snap) for i, (axis, row) in enumerate(zip(arm.axes, placement.rows, strict=True), 1)
    )
    links: tuple[Link, ...] = ()
    if any(axis.bodies for axis in arm.axes):
        frames = placement.frames[1:]
        links = tuple(_link(axis, frame) for axis, frame in zip(arm.axes, frames, strict=True))
    return Description(
        name=robot_name(name or urdf.name or "arm"),
        title=f"{urdf.name}: {arm.base} to {arm.tip}",
        convention=placement.convention,
        joints=joints,
        base=_matrix(placement.frames[0]),
        tool=_matrix(placement.tool),
        gravity=(ZERO, ZERO, multiply(number(-1), Name("g"))) if links else None,
        links=links,
        parameters=(("g", number(GRAVITY)),) if links else (),
    )


def robot_name(text: str) -> str:
    """A name of robot files from any text.

    Args:
        text: For instance ``UR5 (cb3)``.
    """
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:60] or "arm"


def _joint(i: int, axis: Axis, row: Row, snap: Fraction) -> Joint:
    """A row of the table; its variable is the joint's own."""
    of_file = axis.joint
    limits = None if of_file.limits is None else (number(of_file.limits[0]), number(of_file.limits[1]))
    speed, torque = (number(most) if most else None for most in (of_file.velocity, of_file.effort))
    return Joint(
        JointType.REVOLUTE if axis.is_revolute else JointType.PRISMATIC,
        f"q{i}",
        1,
        angle(row.theta, snap),
        distance(row.d),
        distance(row.a),
        angle(row.alpha, snap),
        limits,
        speed,
        torque,
    )


def angle(value: Real, snap: Fraction) -> Expression:
    """A cell of an angle: a fraction of pi, or a decimal.

    Args:
        value: [rad].
        snap: How near simple fractions are taken [rad].
    """
    turns = value / arb.pi()
    for divisor in (*FRACTIONS, DIVISORS):
        near = round(float(turns) * divisor)
        within = real(snap) if divisor != DIVISORS else arb(NOTHING)
        if abs(turns * divisor - near) * arb.pi() / divisor <= max(within, arb(NOTHING)):
            return multiply(number(Fraction(near, divisor)), Pi())
    return number(decimal(value))


def distance(value: Real) -> Expression:
    """A cell of a length.

    Args:
        value: [m].
    """
    return ZERO if abs(value) < TOUCHING else number(decimal(value))


def decimal(value: Real) -> Fraction:
    """The nearest number of `DIGITS` digits; zero where there is nothing.

    Args:
        value: Any.
    """
    if not abs(value) > NOTHING:
        return Fraction(0)
    mantissa, exponent = value.mid().man_exp()
    exact = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    places = DIGITS - 1 - floor(log10(abs(exact)))
    return Fraction(round(exact * 10**places), 1) / Fraction(10) ** places


def _matrix(frame: Frame) -> Matrix:
    """A transform as cells."""
    columns = (frame.x, frame.y, frame.z)
    rows = [(*(_turned(column[k]) for column in columns), distance(frame.origin[k])) for k in range(3)]
    return (*rows, (ZERO, ZERO, ZERO, ONE))


def _turned(value: Real) -> Expression:
    """An entry of a rotation: a root where its square is simple, or a decimal."""
    square = value * value
    for divisor in (1, 2, 4):
        near = round(float(square) * divisor)
        if abs(square * divisor - near) < NOTHING:
            root = round(2 * float(value))
            if root * root * divisor == 4 * near:
                return number(Fraction(root, 2))
            sign = number(1 if value > 0 else -1)
            return multiply(sign, Call("sqrt", (number(Fraction(near, divisor)),)))
    return number(decimal(value))


def _link(axis: Axis, frame: Frame) -> Link:
    """What moves with a joint as one body in the frame of its row."""
    mass = sum((body.mass for body in axis.bodies), Fraction(0))
    viscous, coulomb = number(axis.joint.damping), number(axis.joint.friction)
    if mass == 0:
        return Link(viscous=viscous, coulomb=coulomb)
    weighed = [plus((arb(0),) * 3, frame.inside(body.com), real(body.mass)) for body in axis.bodies]
    com = (_mean(weighed, 0, mass), _mean(weighed, 1, mass), _mean(weighed, 2, mass))
    tensor = _tensor(axis.bodies, frame, com)
    x, y, z = (number(decimal(c)) for c in com)
    inertia = Inertia(*(number(decimal(t)) for t in tensor))
    return Link(number(mass), (x, y, z), inertia, viscous=viscous, coulomb=coulomb)


def _mean(weighed: Sequence[Point], k: int, mass: Fraction) -> Real:
    return sum((point[k] for point in weighed), arb(0)) / real(mass)


def _tensor(bodies: Sequence[Mass], frame: Frame, com: Point) -> list[Real]:
    """xx, yy, zz, xy, xz, yz of some bodies about a point of a frame, along its axes (Steiner)."""
    total = [[arb(0)] * 3 for _ in range(3)]
    for body in bodies:
        xx, yy, zz, xy, xz, yz = map(real, body.inertia)
        own = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
        axes = [frame.turned(axis) for axis in (body.axes.x, body.axes.y, body.axes.z)]
        away = plus(frame.inside(body.com), com, -1)
        far = dot(away, away)
        for i in range(3):
            for j in range(3):
                turned = sum((axes[k][i] * own[k][m] * axes[m][j] for k in range(3) for m in range(3)), arb(0))
                steiner = (far if i == j else 0) - away[i] * away[j]
                total[i][j] += turned + real(body.mass) * steiner
    return [total[0][0], total[1][1], total[2][2], total[0][1], total[0][2], total[1][2]]

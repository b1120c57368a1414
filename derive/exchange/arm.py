"""A serial arm as lines in space: its axes, its bodies and its tip, all in the frame of its base at q = 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import pi

from flint import arb

from derive.errors import RobotFileError, near_miss, quoted
from derive.exchange.space import NOTHING, WORLD, Frame, Line, Point, Real, real, unit, vector
from derive.exchange.urdf import MOVING, Origin, Urdf, UrdfBody, UrdfJoint

FRACTIONS = (12, 8)
"""Angles near multiples of pi by one of these are taken for them."""


@dataclass(frozen=True, slots=True)
class Mass:
    """A body, placed.

    Attributes:
        mass: [kg].
        com: Centre of mass.
        axes: Directions in which the tensor is given.
        inertia: xx, yy, zz, xy, xz, yz about the centre of mass, along these.
        link: Name of the link of the file.
    """

    mass: Fraction
    com: Point
    axes: Frame
    inertia: tuple[Fraction, ...]
    link: str


@dataclass(frozen=True, slots=True)
class Axis:
    """A joint, placed.

    Attributes:
        line: About or along which it moves; of a prismatic one only the direction counts.
        joint: Of the file.
        bodies: What moves with it and not with the next one.
    """

    line: Line
    joint: UrdfJoint
    bodies: tuple[Mass, ...]

    @property
    def is_revolute(self) -> bool:
        """Whether its variable is an angle."""
        return MOVING[self.joint.type]


@dataclass(frozen=True, slots=True)
class Arm:
    """An open chain at q = 0.

    Attributes:
        base: Name of the link whose frame is the world.
        tip: Name of the last link.
        axes: From the base on.
        end: Frame of the last link.
        held: Names of joints beside the chain, which are taken as fixed at zero.
    """

    base: str
    tip: str
    axes: tuple[Axis, ...]
    end: Frame
    held: tuple[str, ...]


def snapped(angle: Fraction, snap: Fraction) -> Real:
    """An angle, or the fraction of pi that it was meant for.

    Args:
        angle: As written [rad].
        snap: Largest difference [rad].
    """
    value = real(angle)
    for fraction in FRACTIONS:
        near = arb.pi() * round(float(angle) * fraction / pi) / fraction
        if abs(value - near) <= real(snap):
            return near
    return value


def placed(origin: Origin, snap: Fraction) -> Frame:
    """A frame by its origin and roll, pitch, yaw.

    Args:
        origin: As in the file.
        snap: See `snapped`.
    """
    (cr, sr), (cp, sp), (cy, sy) = (_turn(snapped(angle, snap)) for angle in origin.rpy)
    x = (cy * cp, sy * cp, -sp)
    y = (cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr)
    z = (cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr)
    return Frame(vector(origin.xyz), x, y, z)


def _turn(angle: Real) -> tuple[Real, Real]:
    """Cosine and sine, exact at multiples of pi/2."""
    quarters = angle * 2 / arb.pi()
    whole = round(float(quarters))
    if abs(quarters - whole) < NOTHING:
        zero, one = arb(0), arb(1)
        return ((one, zero), (zero, one), (-one, zero), (zero, -one))[whole % 4]
    return angle.cos(), angle.sin()


def tips(urdf: Urdf) -> tuple[str, ...]:
    """Names of the links that carry no other, in the order of the file.

    Args:
        urdf: The robot.
    """
    parents = {joint.parent for joint in urdf.joints}
    return tuple(name for name in urdf.bodies if name not in parents)


def root(urdf: Urdf) -> str:
    """The link that hangs on no joint.

    Args:
        urdf: The robot.

    Raises:
        RobotFileError: None or several.
    """
    children = {joint.child for joint in urdf.joints}
    found = [name for name in urdf.bodies if name not in children]
    if len(found) != 1:
        said = f"{len(found)} links hang on no joint: {', '.join(found[:8])}" if found else "the joints form a loop"
        raise RobotFileError(f"{urdf.source}: {said}", remedy="give one tree of links, or --chain BASE..TIP")
    return found[0]


def arm_of(urdf: Urdf, base: str | None, tip: str | None, snap: Fraction) -> Arm:
    """The chain from one link to another.

    Args:
        urdf: The robot.
        base: Name of the link that stands; None for the root.
        tip: Name of the last link; None where only one carries no other.
        snap: Angles and directions that are closer to fractions of pi are taken for them [rad].

    Returns:
        Its axes, bodies and end.

    Raises:
        RobotFileError: An unknown link, several tips, a loop, no joint that moves, or one that no table has.
    """
    for name in (base, tip):
        if name is not None and name not in urdf.bodies:
            hint = near_miss(name, urdf.bodies) or f"links: {', '.join(list(urdf.bodies)[:12])}"
            raise RobotFileError(f"{urdf.source}: no link {quoted(name)}", remedy=hint)
    carrying: dict[str, UrdfJoint] = {}
    for joint in urdf.joints:
        if joint.child in carrying:
            found = f"link {quoted(joint.child)} hangs on two joints, {carrying[joint.child].name} and {joint.name}"
            raise RobotFileError(found, remedy="give a tree, without loops", location=joint.location)
        carrying[joint.child] = joint
    start = root(urdf) if base is None else base
    ends = tips(urdf)
    if tip is None and len(ends) != 1:
        raise RobotFileError(
            f"{urdf.source}: {len(ends)} links carry no other", allowed=", ".join(ends[:24]), remedy="write --tip LINK"
        )
    end = ends[0] if tip is None else tip
    chain: list[UrdfJoint] = []
    name = end
    while name != start:
        if name not in carrying or len(chain) > len(carrying):
            found = f"{urdf.source}: {quoted(end)} does not hang on {quoted(start)}"
            raise RobotFileError(found, remedy="write --tip LINK")
        chain.append(carrying[name])
        name = carrying[name].parent
    return _placed_chain(urdf, start, end, chain[::-1], snap)


def _placed_chain(urdf: Urdf, start: str, end: str, chain: Sequence[UrdfJoint], snap: Fraction) -> Arm:
    children: dict[str, list[UrdfJoint]] = {}
    for joint in urdf.joints:
        children.setdefault(joint.parent, []).append(joint)
    on_chain = {joint.name for joint in chain}
    held: list[str] = []

    def _carried(link: str, frame: Frame) -> list[Mass]:
        """The bodies of a link and of what hangs on it beside the chain."""
        body = urdf.bodies[link]
        found = [_mass(body, frame, link, snap)] if body is not None else []
        for joint in children.get(link, ()):
            if joint.name not in on_chain:
                if joint.type != "fixed":
                    held.append(joint.name)
                found += _carried(joint.child, frame.then(placed(joint.origin, snap)))
        return found

    frame, axes = WORLD, []
    groups = [_carried(start, WORLD)]
    lines = []
    for joint in chain:
        frame = frame.then(placed(joint.origin, snap))
        if joint.type != "fixed":
            _check_kind(joint)
            lines.append((Line(frame.origin, frame.direction(_direction(joint, snap))), joint))
            groups.append([])
        groups[-1] += _carried(joint.child, frame)
    if not lines:
        raise RobotFileError(f"{urdf.source}: no joint moves between {quoted(start)} and {quoted(end)}")
    axes = [Axis(line, joint, tuple(group)) for (line, joint), group in zip(lines, groups[1:], strict=True)]
    return Arm(start, end, tuple(axes), frame, tuple(held))


def _check_kind(joint: UrdfJoint) -> None:
    if joint.type not in MOVING:
        found = f"joint {quoted(joint.name)} is {joint.type}"
        remedy = "choose another --tip or --chain"
        allowed = "allowed: revolute, continuous, prismatic, fixed"
        raise RobotFileError(found, allowed=allowed, remedy=remedy, location=joint.location)
    if joint.mimics:
        found = f"joint {quoted(joint.name)} follows {quoted(joint.mimics)}: it has no variable of its own"
        raise RobotFileError(found, remedy="choose a chain without it", location=joint.location)


def _direction(joint: UrdfJoint, snap: Fraction) -> Point:
    """Of the axis, with components that were meant for zero as zero."""
    direction = unit(vector(joint.axis))
    clean = [c if abs(c) > real(snap) else arb(0) for c in direction]
    return unit((clean[0], clean[1], clean[2]))


def _mass(body: UrdfBody, frame: Frame, link: str, snap: Fraction) -> Mass:
    axes = frame.then(placed(body.origin, snap))
    return Mass(body.mass, axes.origin, axes, body.inertia, link)

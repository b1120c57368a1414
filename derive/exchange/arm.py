"""A serial arm as lines in space: its axes, its bodies and its tip, all in the frame of its base at q = 0.

The way from base to tip may go up the tree of links first: a joint that is passed from child to parent moves the other
way round.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import pi

from flint import arb

from derive.errors import RobotFileError, near_miss, quoted
from derive.exchange.reading.elements import MOVING, UNLIMITED, ZEROS, Origin, Triple, Urdf, UrdfJoint
from derive.mechanics import space
from derive.mechanics.space import NOTHING, WORLD, Frame, Line, Point, Real, exactly, length, plus, real, unit, vector
from derive.mechanics.vectors import cross
from derive.robot.reading.size_limits import FILE_LIMITS

FRACTIONS = (12, 8)  # angles near multiples of pi by one of these are taken for them
TRAVEL = Fraction(1)  # of a slide without limits, to either side [m]
# Joints that are not part of a chain by the links beside them, and whether they are passed from child to parent there.
Beside = dict[str, list[tuple[UrdfJoint, bool]]]


@dataclass(frozen=True, slots=True)
class Mass:
    """A body, placed."""

    mass: Fraction  # [kg]
    axes: Frame  # at its centre of mass, with the directions in which the tensor is given
    inertia: tuple[Fraction, ...]  # xx, yy, zz, xy, xz, yz about the centre of mass, along these
    link: str  # name of the link of the file


@dataclass(frozen=True, slots=True)
class Axis:
    """A joint, placed."""

    line: Line  # about or along which it moves; of a prismatic one only the direction counts
    joint: UrdfJoint  # of the file
    bodies: tuple[Mass, ...]  # what moves with it and not with the next one

    @property
    def is_revolute(self) -> bool:
        """Whether its variable is an angle."""
        return MOVING[self.joint.type]

    @property
    def limits(self) -> tuple[Fraction, Fraction] | None:
        """Of its variable; None where the file gives none that leave room [rad or m]."""
        limits = self.joint.limits
        return limits if limits is not None and -UNLIMITED < limits[0] < limits[1] < UNLIMITED else None

    @property
    def travel(self) -> tuple[Fraction, Fraction]:
        """How far a slide goes, `TRAVEL` to either side where it has no limits; of a turn nothing [m]."""
        return (ZEROS[0], ZEROS[0]) if self.is_revolute else self.limits or (-TRAVEL, TRAVEL)


@dataclass(frozen=True)
class Arm:
    """An open chain at q = 0."""

    base: str  # name of the link whose frame is the world
    tip: str  # name of the last link
    axes: tuple[Axis, ...]  # from the base on
    end: Frame  # frame of the last link
    up: Point  # z axis of the link that hangs on no joint: against gravity
    held: tuple[str, ...]  # joints beside the chain that carry something on it, taken as fixed at zero
    snaps: tuple[float, ...]  # how far angles and directions of the chain were changed, where they were [rad]

    @property
    def reach(self) -> float:
        """How far the tip can get from the base, by the way through all joints [m]."""
        return self.way[0]

    @cached_property
    def way(self) -> tuple[float, ...]:
        """The way to the tip from the base, from the first axis, and so on, as far as limits say [m]."""
        stations = [WORLD.origin, *(axis.line.point for axis in self.axes), self.end.origin]
        steps = [float(length(plus(b, a, -1))) for a, b in pairwise(stations)]
        slides = [0.0, *(float(max(map(abs, axis.travel))) if axis.limits else 0.0 for axis in self.axes)]
        return tuple(sum(steps[k:]) + sum(slides[k:]) for k in range(len(steps)))


def _snapped(angle: Real, snap: Fraction) -> Real:
    """An angle, or the fraction of pi that it was meant for [rad]."""
    for fraction in FRACTIONS:
        near = arb.pi() * round(float(angle) * fraction / pi) / fraction
        if abs(angle - near) <= real(snap):
            return near
    return angle


def snapped(rpy: Triple, snap: Fraction) -> Point:
    """Roll, pitch and yaw, or the fractions of pi that they were meant for."""
    roll, pitch, yaw = (_snapped(real(angle), snap) for angle in rpy)
    if abs(abs(pitch) - arb.pi() / 2) < NOTHING:  # roll and yaw are about one axis
        sign = 1 if pitch > 0 else -1
        roll = _snapped(roll - sign * yaw, snap) + sign * yaw
    return (roll, pitch, yaw)


def frame_at(origin: Origin, snap: Fraction) -> Frame:
    """A frame by its origin and roll, pitch, yaw."""
    (cr, sr), (cp, sp), (cy, sy) = map(space.cosine_sine, snapped(origin.rpy, snap))
    # Columns of Rz(yaw) Ry(pitch) Rx(roll).
    x = (cy * cp, sy * cp, -sp)
    y = (cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr)
    z = (cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr)
    return Frame(vector(origin.xyz), x, y, z)


def moving_tips(urdf: Urdf) -> tuple[str, ...]:
    """Names of the links that carry no other, with a joint between them and the root that is not fixed."""
    carrying, parents = carrying_joints(urdf), {joint.parent for joint in urdf.joints}
    ways = ((link, _ancestry(carrying, link)) for link in urdf.bodies if link not in parents)
    return tuple(link for link, way in ways if any(joint.type != "fixed" for joint in way))


def carrying_joints(urdf: Urdf) -> dict[str, UrdfJoint]:
    """The joint on which each link hangs."""
    carrying: dict[str, UrdfJoint] = {}
    for joint in urdf.joints:
        if joint.child in carrying:
            found = f"link {quoted(joint.child)} hangs on two joints, {carrying[joint.child].name} and {joint.name}"
            raise RobotFileError(found, remedy="give a tree, without loops", location=joint.location)
        carrying[joint.child] = joint
    return carrying


def _ancestry(carrying: Mapping[str, UrdfJoint], link: str) -> list[UrdfJoint]:
    """The joints from a link up to the one that hangs on none."""
    way: list[UrdfJoint] = []
    while link in carrying:
        joint = carrying[link]
        if len(way) == len(carrying):
            found = f"the joints around {quoted(link)} form a loop"
            raise RobotFileError(found, remedy="give a tree, without loops", location=joint.location)
        way.append(joint)
        link = joint.parent
    return way


def arm_of(urdf: Urdf, base: str | None, tip: str | None, snap: Fraction) -> Arm:
    """The chain from a base, None for the root that the tip hangs on, to a tip, None for the only link that is one.

    Angles and directions that are closer to fractions of pi than the snap are taken for them [rad].
    """
    for name in (base, tip):
        if name is not None and name not in urdf.bodies:
            hint = near_miss(name, urdf.bodies) or f"links: {some(list(urdf.bodies))}"
            raise RobotFileError(f"{urdf.source}: no link {quoted(name)}", remedy=hint)
    carrying = carrying_joints(urdf)
    if tip is None:
        if not (ends := moving_tips(urdf)):
            _ancestry(carrying, next(iter(urdf.bodies)))  # raises where every link carries another
            raise RobotFileError(f"{urdf.source}: no joint moves", remedy="give a robot with a joint that moves")
        if len(ends) > 1:
            found = f"{urdf.source}: the URDF has {len(ends)} end links: {some(ends)}"
            raise RobotFileError(found, remedy="choose one with --tip LINK, or import all with --all")
    end = ends[0] if tip is None else tip
    down = _ancestry(carrying, end)
    start = base if base is not None else (down[-1].parent if down else end)
    up = _ancestry(carrying, start)
    # What both ways to the root share is on neither side: they meet at the lowest link that carries both.
    while up and down and up[-1] is down[-1]:
        up, down = up[:-1], down[:-1]
    meeting = {joints[-1].parent if joints else link for joints, link in ((up, start), (down, end))}
    if len(meeting) > 1:
        found = f"{urdf.source}: no joints lead from {quoted(start)} to {quoted(end)}"
        raise RobotFileError(found, remedy="choose links of one tree")
    steps = [*((joint, True) for joint in up), *((joint, False) for joint in reversed(down))]
    with exactly(len(urdf.joints)):
        return _placed_chain(urdf, carrying, (start, end), steps, snap)


def joints_between(urdf: Urdf, one: str, other: str) -> list[UrdfJoint]:
    """The joints on the way from one link of a tree to another."""
    carrying = carrying_joints(urdf)
    ways = [_ancestry(carrying, link) for link in (one, other)]
    names = [{joint.name for joint in way} for way in ways]
    return [joint for way in ways for joint in way if joint.name in names[0] ^ names[1]]


def some(names: Sequence[str], most: int = 24) -> str:
    """The first of some names."""
    return ", ".join(quoted(name)[1:-1] for name in names[:most]) + (", ..." if len(names) > most else "")


def _placed_chain(
    urdf: Urdf,
    carrying: Mapping[str, UrdfJoint],
    ends: tuple[str, str],
    steps: Sequence[tuple[UrdfJoint, bool]],
    snap: Fraction,
) -> Arm:
    """Axes and bodies along steps, each a joint and whether it is passed from child to parent."""
    passed = {joint.name for joint, _ in steps}
    beside: Beside = {}
    for joint in urdf.joints:
        if joint.name not in passed:
            beside.setdefault(joint.parent, []).append((joint, False))
            beside.setdefault(joint.child, []).append((joint, True))
    frame = WORLD
    found: list[tuple[Line, UrdfJoint, list[Mass]]] = []
    held: list[str] = []
    for joint, upwards in steps:
        if not upwards:
            frame = frame.then(frame_at(joint.origin, snap))
        if joint.type != "fixed":
            check_kind(joint)
            direction = frame.direction(direction_of(joint, snap))
            found.append((Line(frame.origin, space.times(direction, -1) if upwards else direction), joint, []))
        if upwards:
            frame = frame.then(WORLD.seen_from(frame_at(joint.origin, snap)))
        if found:  # what moves with the base stands
            bodies, fixed = _around(urdf, beside, joint.parent if upwards else joint.child, frame, snap)
            found[-1][2].extend(bodies)
            held += fixed
    if not found:
        start, end = map(quoted, ends)
        raise RobotFileError(f"{urdf.source}: no joint moves between {start} and {end}", remedy="choose other links")
    if len(found) > FILE_LIMITS.joints:
        said, allowed = f"{urdf.source}: {len(found)} joints move", f"allowed: at most {FILE_LIMITS.joints}"
        raise RobotFileError(said, allowed=allowed, remedy="choose a shorter chain")
    axes = tuple(Axis(line, joint, tuple(group)) for line, joint, group in found)
    snaps = [change for joint, _ in steps for change in changes_of(joint, snap)]
    base = WORLD  # seen from the root
    for joint in reversed(_ancestry(carrying, ends[0])):
        base = base.then(frame_at(joint.origin, snap))
    return Arm(*ends, axes, frame, base.turned(WORLD.z), tuple(held), tuple(snaps))


def _around(urdf: Urdf, beside: Beside, link: str, frame: Frame, snap: Fraction) -> tuple[list[Mass], list[str]]:
    """What moves with a link, joints beside the chain at zero."""
    found: list[Mass] = []
    held: list[str] = []
    seen, waiting = {link}, [(link, frame)]
    while waiting:
        name, at = waiting.pop()
        if (body := urdf.bodies[name]) is not None:
            found.append(Mass(body.mass, at.then(frame_at(body.origin, snap)), body.inertia, name))
        for joint, upwards in beside.get(name, ()):
            other = joint.parent if upwards else joint.child
            if other not in seen:
                seen.add(other)
                held += [joint.name] if joint.type != "fixed" else []
                step = frame_at(joint.origin, snap)
                waiting.append((other, at.then(WORLD.seen_from(step) if upwards else step)))
    return found, held


def changes_of(joint: UrdfJoint, snap: Fraction) -> list[float]:
    """How far the angles and the direction of a joint are changed, where they are [rad]."""
    pairs = zip(snapped(joint.origin.rpy, snap), joint.origin.rpy, strict=True)
    turned = [float(abs(angle - real(written))) for angle, written in pairs if written]
    if joint.type in MOVING:
        turned.append(float(length(cross(unit(vector(joint.axis)), direction_of(joint, snap))).abs_upper()))
    return [change for change in turned if change > NOTHING]


def check_kind(joint: UrdfJoint, remedy: str = "choose another --tip or --chain", *, may_follow: bool = False) -> None:
    """Refuse a joint that no row is, and one that follows another unless it may."""
    found, allowed = joint.fault, ""
    remedy = f"correct it, or {remedy}" if found else remedy
    if joint.type not in MOVING:
        found, allowed = found or f"joint {quoted(joint.name)} is {joint.type}", f"allowed: {', '.join(MOVING)}, fixed"
    elif joint.mimics is not None and not may_follow:
        found = f"joint {quoted(joint.name)} follows {quoted(joint.mimics)}: it has no variable of its own"
        remedy = "choose a chain without it, or import all joints by --tree"
    if found:
        raise RobotFileError(found, allowed=allowed, remedy=remedy, location=joint.location)


def direction_of(joint: UrdfJoint, snap: Fraction) -> Point:
    """Of the axis, with components that were meant for zero as zero."""
    x, y, z = (c if abs(c) > real(snap) else arb(0) for c in unit(vector(joint.axis)))
    return unit((x, y, z))

"""An arm as a robot file has it: cells, links in the frames of the table, and the table that a URDF carries."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import floor, log10

from flint import arb

from derive.errors import DeriveError, RobotFileError, quoted
from derive.exchange.arm import FRACTIONS, Arm, Axis
from derive.exchange.body_chain import NO_INERTIA, RigidBody, body_chain
from derive.exchange.certificate import ball, certify, frame_of, motions
from derive.exchange.common_normals import DHRow, Placement
from derive.exchange.numeric import text
from derive.exchange.reading.elements import SLIDE, UNLIMITED, Urdf
from derive.mechanics.space import NOTHING, WORLD, Frame, Real, decimal, exactly, plus, real
from derive.mechanics.vectors import Symmetric
from derive.robot.description import INERTIA, Convention, Description, Inertia, Joint, JointType, Link, Matrix
from derive.robot.expression import ONE, ZERO, Call, Expression, Name, Pi, multiply, number
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.robot import Robot
from derive.robot.writer import robot_text

DIVISORS = 180  # angles that are exact multiples of pi by this are written so
# Lengths that are so close to a whole number of micrometres are it, or closer than the snap where that is less [m].
TOUCHING = Fraction(1, 10**9)
# What a number of 17 digits may lose when it is turned there and back, of the largest beside it.
NOISE = Fraction(1, 10**15)
SHORT = 12  # digits of numbers that are as good without noise
PLACES = 6  # of decimals that a length has where it is one of few digits
GRAVITY = Fraction(981, 100)  # where a format says nothing [m/s^2]


def robot_of_arm(arm: Arm, placement: Placement, snap: Fraction, name: str, title: str) -> Description:
    """What a robot file says of an arm; angles closer to simple fractions of pi than the snap are these [rad]."""
    joints = []
    for i, (axis, row) in enumerate(zip(arm.axes, placement.rows, strict=True), 1):
        cells = (angle(row.theta, snap), distance(row.d, snap), distance(row.a, snap), angle(row.alpha, snap))
        joints.append(row_of(axis, f"q{i}", cells))
    links: tuple[Link, ...] = ()
    if any(axis.bodies for axis in arm.axes):
        links = tuple(link_of(axis, frame, snap) for axis, frame in zip(arm.axes, placement.frames[1:], strict=True))
    down = (multiply(number(-1), turned(component), Name("g")) for component in arm.up)
    return Description(
        name=name,
        title=title[: FILE_LIMITS.title_length],
        convention=placement.convention,
        joints=tuple(joints),
        base=matrix_of(placement.frames[0], snap),
        tool=matrix_of(placement.tool, snap),
        gravity=(next(down), next(down), next(down)) if links else None,
        links=links,
        parameters=(("g", number(GRAVITY)),) if links else (),
    )


def row_of(axis: Axis, variable: str, cells: tuple[Expression, ...] = (ZERO,) * 4) -> Joint:
    """The row of a joint with its bounds and its name."""
    limits = axis.limits and (number(rounded(axis.limits[0])), number(rounded(axis.limits[1])))
    largest = (axis.joint.velocity, axis.joint.effort)
    speed, torque = (number(rounded(most)) if most and 0 < most < UNLIMITED else None for most in largest)
    kind, label = JointType.REVOLUTE if axis.is_revolute else JointType.PRISMATIC, label_of(axis.joint.name)
    theta, d, a, alpha = cells
    return Joint(kind, variable, 1, theta, d, a, alpha, limits, speed, torque, "" if label == variable else label)


def label_of(name: str) -> str:
    """A name of a file as a robot file may have it: on one line, and not too long."""
    return (name if name.isprintable() else quoted(name, len(name))[1:-1])[: FILE_LIMITS.title_length]


def angle(value: Real, snap: Fraction) -> Expression:
    """A cell of an angle: a fraction of pi, where a simple one is as near as the snap [rad], or a decimal."""
    turns = value / arb.pi()
    for divisor in (*FRACTIONS, DIVISORS):
        near = round(float(turns) * divisor)
        within = real(snap) if divisor != DIVISORS else arb(NOTHING)
        if abs(turns * divisor - near) * arb.pi() / divisor <= max(within, arb(NOTHING)):
            return multiply(number(Fraction(near, divisor)), Pi())
    return number(decimal(value))


def distance(value: Real, snap: Fraction) -> Expression:
    """A cell of a length."""
    short = Fraction(round(float(value) * 10**PLACES), 10**PLACES)
    return number(short if abs(value - real(short)) <= real(min(TOUCHING, snap)) else decimal(value))


def rounded(value: Fraction) -> Fraction:
    """A number of a URDF with at most `DIGITS` digits."""
    return decimal(real(value))


def matrix_of(frame: Frame, snap: Fraction) -> Matrix:
    """A frame as the cells of a transform."""
    columns = (frame.x, frame.y, frame.z)
    rows = [(*(turned(column[k]) for column in columns), distance(frame.origin[k], snap)) for k in range(3)]
    return (*rows, (ZERO, ZERO, ZERO, ONE))


def turned(value: Real) -> Expression:
    """An entry of a rotation: a root where its square is simple, or a decimal."""
    square = value * value
    for divisor in (1, 2, 4):
        near = round(float(square) * divisor)
        if abs(square * divisor - near) < NOTHING:
            root = round(2 * float(value))
            if root * root * divisor == 4 * near:
                return number(Fraction(root, 2))
            return multiply(number(1 if value > 0 else -1), Call("sqrt", (number(Fraction(near, divisor)),)))
    return number(decimal(value))


def _written(values: Sequence[Real], snap: Fraction, size: Real | None = None) -> list[Expression]:
    """Numbers beside each other; those that are short but for noise are, unless decimals are taken as they stand."""
    size = max(map(abs, values), key=float) if size is None else size
    if not (snap and size > NOTHING):
        return [number(decimal(value)) for value in values]
    unit = real(Fraction(10) ** (floor(log10(float(size))) - SHORT))
    cells: list[Expression] = []
    for value in values:
        short = unit * round(float(value / unit))
        cells.append(number(decimal(short if abs(value - short) <= real(NOISE) * size else value)))
    return cells


def link_of(axis: Axis, frame: Frame, snap: Fraction) -> Link:
    """What moves with a joint as one body in the frame of its row."""
    mass = sum((body.mass for body in axis.bodies), Fraction(0))
    cells = (axis.joint.armature, axis.joint.damping, axis.joint.friction)
    armature, viscous, coulomb = (number(rounded(cell)) for cell in cells)
    if not mass and (heavy := next((body.link for body in axis.bodies if body.mass), "")):
        found = f"link {quoted(heavy)}: its mass and those of what it carries add up to nothing"
        raise RobotFileError(found, remedy="correct the masses", location=axis.joint.location)
    com = (arb(0), arb(0), arb(0))
    for body in axis.bodies if mass else ():
        com = plus(com, frame.inside(body.axes.origin), real(body.mass) / real(mass))
    tensor = NO_INERTIA
    for body in axis.bodies:
        own = RigidBody(real(body.mass), WORLD.origin, Symmetric(*map(real, body.inertia)))
        tensor = tensor + own.moved(body.axes.seen_from(frame)).about(com)
    inertia = Inertia(*_written([getattr(tensor, key) for key in INERTIA], snap))
    x, y, z = _written(com, snap, arb(1))
    return Link(number(rounded(mass)), (x, y, z), inertia, None, armature, viscous, coulomb)


# -- the table that a URDF of `derive export` carries: of the many that are right for an arm, that it was made from

SAME = 1e-9  # poses that differ by less are the same: a URDF's numbers have 17 digits [m, rad]


def carried_table(urdf: Urdf, arm: Arm, convention: Convention | None) -> Robot | None:
    """The table of numbers that a URDF carries; None without one, of the other convention, or of another arm."""
    if not urdf.table:
        return None
    try:
        table = Robot.from_text(urdf.table, f"{urdf.source}, dh_table")
        kinds = [(joint.is_revolute, joint.label) for joint in table.joints]
        if convention not in (None, table.convention) or kinds != [(a.is_revolute, a.joint.name) for a in arm.axes]:
            return None
        certificate = certify(arm, table)
        return table if certificate.position < SAME and certificate.rotation < SAME else None
    except DeriveError:
        return None


def placement_of(table: Robot) -> Placement:
    """Where the frames of a table are at q = 0."""
    with exactly():
        frames, rows = [frame_of(table.base)], []
        for joint in table.joints:
            along, across = motions(joint)
            standard = table.convention is Convention.STANDARD
            frames.append(frames[-1].then(along.then(across) if standard else across.then(along)))
            rows.append(DHRow(*(ball(cell) for cell in (joint.theta, joint.d, joint.a, joint.alpha))))
        return Placement(table.convention, tuple(frames), tuple(rows), frame_of(table.tool), ())


def table_text(robot: Robot) -> str:
    """A robot file of what a URDF has no words for: table, slides without limits, gravity, motors, uneven friction."""
    joints = tuple(replace(joint, speed=None, torque=None) for joint in robot.joints)
    ways = [(link, link.coulomb if isinstance(link.coulomb, tuple) else ZERO) for link in robot.links]
    links = tuple(Link(armature=link.armature, motor=link.motor, coulomb=coulomb) for link, coulomb in ways)
    ends = (robot.base, robot.tool, robot.gravity)
    return robot_text(Description(robot.name, "", robot.convention, joints, *ends, links))


def with_table(robot: Description, table: Robot) -> Description:
    """A robot with the cells of a table to the letter, and with its gravity, motors and friction by direction."""
    cells = ("variable", "name", "sign", "theta", "d", "a", "alpha")
    joints = []
    for joint, row in zip(robot.joints, table.joints, strict=True):
        # Limits of the table, where the URDF has them, or its stand-in for a slide without; else those of the URDF.
        limits, written = joint.limits, row.limits or (None if row.is_revolute else (number(-SLIDE), number(SLIDE)))
        if limits and written and [text(ball(cell)) for cell in limits] == [text(ball(cell)) for cell in written]:
            limits = row.limits
        joints.append(replace(joint, limits=limits, **{cell: getattr(row, cell) for cell in cells}))
    robot = replace(robot, joints=tuple(joints), base=table.base, tool=table.tool)
    if not (robot.links and table.links):
        return robot
    links = []
    for link, own in zip(robot.links, table.links, strict=True):
        # Coulomb friction by direction where the table has it and its mean is that of the URDF
        has_ways = isinstance(own.coulomb, tuple) and text(ball(own.signed[0])) == text(ball(link.signed[0]))
        coulomb = own.coulomb if has_ways else link.coulomb
        links.append(replace(link, armature=own.armature, motor=own.motor, coulomb=coulomb))
    robot = replace(robot, links=tuple(links), gravity=table.gravity, parameters=())
    segments = body_chain(Robot.of(robot)).segments
    bodies = [segment.body for segment in segments]
    # Links of the URDF hold the rotors that they carry: these are taken out again.
    for i, (segment, following) in enumerate(pairwise(segments)):
        if (spun := following.rotor) is not None and segment.body is not None:
            rotor = (spun.body + RigidBody.spinning(spun.axis, spun.inertia)).moved(WORLD.seen_from(segment.dh))
            bodies[i] = segment.body + RigidBody(-rotor.mass, rotor.com, Symmetric(*(-part for part in rotor.entries)))
    return replace(robot, links=tuple(b.link(own) if b else own for b, own in zip(bodies, links, strict=True)))

"""A robot from a URDF: its table by common normals, its links in the frames of the table.

Two axes that 1.57 and -1.5708 turn are not parallel, and have a common normal: some hundred metres away. Such angles,
rounded to a few decimals, are read as the fractions of pi that they were meant for where the arm hardly moves by that.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from decimal import ROUND_CEILING, Context, Decimal, InvalidOperation
from fractions import Fraction
from math import pi
from pathlib import Path
from typing import TypedDict

from flint import arb

from derive.errors import DeriveError, RobotFileError, quoted
from derive.exchange.arm import FRACTIONS, Arm, arm_of, joints_between
from derive.exchange.certificate import Certificate, certify
from derive.exchange.common_normals import ALIKE, FAR, TURNED, Placement, place
from derive.exchange.convert import convention_named
from derive.exchange.reading.elements import Origin, Urdf, UrdfJoint
from derive.exchange.reading.source import ChainSource
from derive.exchange.robot_of_arm import carried_table, placement_of, robot_of_arm, with_table
from derive.mechanics.space import DIGITS, decimal, exactly, length, plus
from derive.mechanics.vectors import cross
from derive.model.identification.possible import wants_possible, with_chosen_bodies
from derive.robot.description import Convention, Description
from derive.robot.expression import ZERO, Name, is_constant
from derive.robot.load import is_robot_name
from derive.robot.names import robot_symbols
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.robot import Robot
from derive.robot.validate import missing_moment
from derive.robot.writer import robot_text

MOST_MOVED = 0.01  # of the arm's reach: a table whose poses may be farther from the URDF's is refused
ROUNDED = 1e-7  # what poses may move of any arm, as cells are rounded [m]
MOST_SNAP = Fraction(1, 10)  # larger angles are no slips [rad]
PLACES = range(2, 13)  # so many decimals has an angle that somebody cut off
MOST_NAMED = 8  # so many of them are named
CutOff = Sequence[tuple[UrdfJoint, Fraction]]  # angles that are almost fractions of pi, with their joints
SNAP = "1e-6"  # how near an angle is to a simple fraction of pi that it is taken for [rad]


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportOptions:
    """How an arm of a URDF is wanted."""

    # ``standard`` or ``modified``; None for that of the table that the URDF carries, else standard.
    convention: str | None = None
    snap: str | float | Fraction = SNAP  # angles closer to simple fractions of pi are taken for them [rad]
    name: str | None = None  # of the robot, or what the names of all arms begin with; None for that of the URDF
    inertia: str = "given"  # ``given``, or ``possible``: the nearest physically consistent ones
    symbols: bool = False  # whether lengths are named, d1, a2, ..., with their numbers as parameters
    packages: Sequence[str | Path] = ()  # folders in which xacro looks for packages, or ``NAME=DIR``
    arguments: Mapping[str, str] = field(default_factory=dict)  # of xacro
    folder: str | Path = "."  # where the robot file will be: it names the URDF from there


AS_USUAL = ImportOptions()


class ImportKeywords(TypedDict, total=False):
    """`ImportOptions` as keywords of a function."""

    convention: str | None
    snap: str | float
    name: str | None
    inertia: str
    symbols: bool
    packages: Sequence[str | Path]
    arguments: Mapping[str, str]
    folder: str | Path


@dataclass(frozen=True, slots=True)
class Imported:
    """A robot and what is known about its making."""

    text: str  # the robot file
    robot: Robot  # what it says
    certificate: Certificate  # how far its poses are from the URDF's
    links: tuple[str, str]  # names of the links at both ends
    joints: tuple[str, ...]  # names of the joints in the URDF
    notes: tuple[str, ...]  # what a reader should know, as sentences
    changes: tuple[float, ...]  # by how much angles were changed to exact values, where they were [rad]

    @property
    def report(self) -> tuple[str, ...]:
        """What was made, in lines."""
        kinds = "".join("R" if joint.is_revolute else "P" for joint in self.robot.joints)
        count = f"{self.robot.n} joint{'s' * (self.robot.n > 1)}"
        head = f"{count} ({kinds}), {self.robot.convention.value}, {' to '.join(self.links)}; base and tool constant"
        snapped = "no angles rounded"
        if n := len(self.changes):
            snapped = f"{n} angle{'s' * (n > 1)} rounded, largest change {max(self.changes):.2g} rad"
        return (head, f"{snapped}; {self.certificate}", *self.notes)

    def as_dict(self) -> dict[str, object]:
        """The report as plain data."""
        errors = {f"{name}_error": getattr(self.certificate, name) for name in ("position", "rotation")}
        who = {"robot": self.robot.name, "base": self.links[0], "tip": self.links[1], "joints": list(self.joints)}
        return who | {"convention": self.robot.convention.value} | errors | {"notes": list(self.notes)}


def import_urdf(
    urdf: Urdf, base: str | None, tip: str | None, options: ImportOptions = AS_USUAL, source: ChainSource | None = None
) -> Imported:
    """The robot of a chain of a URDF, from its root and to the only link that carries no other where these are None."""
    convention = None if options.convention is None else convention_named(options.convention)
    snap = snap_of(options.snap)
    with exactly():
        written = arm_of(urdf, base, tip, Fraction(0))
        if not wants_possible(options.inertia):
            for axis in written.axes:  # a robot file has no link that weighs less than nothing
                if (mass := sum(body.mass for body in axis.bodies)) < 0:
                    found = f"link {quoted(axis.bodies[0].link)} and what it carries weigh {float(mass):g} kg"
                    remedy = "correct the masses, or write --inertia possible"
                    raise RobotFileError(found, remedy=remedy, location=axis.joint.location)
        table, remarks = _Chain(urdf, written, convention, options.name).understood(snap)
        notes = [plain_text(note) for note in (*remarks, *notes_on(urdf, table.arm))]
    robot = Robot.of(table.description)
    if robot.links:
        robot, changes = with_chosen_bodies(robot, options.inertia)
        notes += changes
    arm, description = table.arm, with_named_lengths(robot) if options.symbols else robot
    names = tuple(plain_text(axis.joint.name) for axis in arm.axes)
    first = [replace(source, base=arm.base, tip=arm.tip).line] if source else []
    text = robot_text(description, [*first, f"joints: {', '.join(names)}", str(table.certificate), *notes])
    made = read_back(text, robot.name, urdf.source)
    ends = (plain_text(arm.base), plain_text(arm.tip))
    return Imported(text, made, table.certificate, ends, names, tuple(notes), table.changes)


def read_back(text: str, name: str, source: str) -> Robot:
    """A robot file as others read it; what the robot has against it is said of the file that it comes from."""
    try:
        return Robot.from_text(text, f"{name}.yaml")
    except DeriveError as error:
        raise RobotFileError(f"{source}: {error.found}", allowed=error.allowed, remedy=error.remedy) from error


def snap_of(snap: str | float | Fraction) -> Fraction:
    """A distance of angles, such as ``1e-6``, exactly, from 0 to 0.1 [rad]."""
    if isinstance(snap, Fraction) and 0 <= snap <= MOST_SNAP:
        return snap
    with suppress(InvalidOperation):
        value = Decimal(str(snap))
        if value.is_finite() and 0 <= value <= 1 and abs(value.adjusted()) < 100 and Fraction(value) <= MOST_SNAP:
            return Fraction(value)
    raise DeriveError(f"--snap {quoted(str(snap))}", allowed="allowed: a number from 0 to 0.1", remedy=f"write {SNAP}")


@dataclass(frozen=True, slots=True)
class _Table:
    arm: Arm  # with angles as they were understood
    placement: Placement  # the frames
    description: Description  # the robot
    certificate: Certificate  # how far its poses are from the arm as written
    changes: tuple[float, ...] = ()  # by how much angles were changed, where they were [rad]

    @property
    def moves_far(self) -> bool:
        """Whether poses may be farther from the URDF's than anybody wants."""
        return self.certificate.position > max(MOST_MOVED * self.arm.reach, ROUNDED)

    @property
    def is_far(self) -> bool:
        """Whether a cell is beyond everything that the arm reaches."""
        sizes = (abs(cell) for row in self.placement.rows for cell in (row.d, row.a))
        return max(map(float, sizes)) > FAR * self.arm.reach + ALIKE


@dataclass(frozen=True, slots=True)
class _Chain:
    urdf: Urdf  # the file
    written: Arm  # the chain with all angles as they are written
    convention: Convention | None  # of the tables; None for that of the table which the URDF carries, else standard
    name: str | None  # of the robot; None for that of the URDF

    def understood(self, snap: Fraction) -> tuple[_Table, list[str]]:
        """The table that the URDF carries with it, else one by common normals; where axes meet far away as meant."""
        if (carried := carried_table(self.urdf, self.written, self.convention)) is not None:
            arm, placement = arm_of(self.urdf, self.written.base, self.written.tip, snap), placement_of(carried)
            description = with_table(self._described(arm, placement, snap), carried)
            remarks = ["the table is the one that the URDF carries with it"]
            return _Table(arm, placement, description, certify(self.written, description)), remarks
        plain = self._table(snap)
        far = plain.placement.far
        cut = cut_off(self.urdf, self.written.base, self.written.tip, snap)
        is_slanting = any(slant(self.written, i) > ALIKE for i, _ in far)
        other = self._table(snap, cut) if is_slanting and cut and snap else plain
        worth = MOST_MOVED * other.arm.reach if plain.is_far else TURNED
        table = plain if other.is_far or other.certificate.position > worth else other
        if table.moves_far:
            most, moved = MOST_MOVED * table.arm.reach, table.certificate.position
            found = f"{self.urdf.source}: --snap {float(snap):g} would move a pose by up to {moved:.2g} m"
            allowed = f"allowed: at most {MOST_MOVED:.0%} of the reach, {most:.2g} m"
            remedy = f"write --snap {float(snap) * most / moved / 2:.0e}" if snap else ""
            raise RobotFileError(found, allowed=allowed, remedy=remedy)
        on_slants = self._remarks_on_slants(table, far, cut if is_slanting else (), table is not plain)
        return table, [*on_slants, *self._remarks_on_cut(table, cut if snap and not is_slanting else ())]

    def _table(self, snap: Fraction, cut: CutOff = ()) -> _Table:
        """By common normals; where angles are cut off, all such angles of the robot are read as they were meant."""
        arm = arm_of(as_meant(self.urdf) if cut else self.urdf, self.written.base, self.written.tip, snap)
        placement = place(arm, self.convention or Convention.STANDARD, float(snap))
        description = self._described(arm, placement, snap)
        changes = (*arm.snaps, *placement.turned, *(float(abs(meant(angle) - angle)) for _, angle in cut))
        return _Table(arm, placement, description, certify(self.written, description), changes)

    def _described(self, arm: Arm, placement: Placement, snap: Fraction) -> Description:
        title = plain_text(" ".join(f"{self.urdf.name}: {arm.base} to {arm.tip}".split()))
        return robot_of_arm(arm, placement, snap, robot_name(self.name or self.urdf.name or "arm"), title)

    def _remarks_on_slants(
        self, table: _Table, far: Sequence[tuple[int, bool]], cut: CutOff, taken: bool
    ) -> Iterator[str]:
        """What was done with axes that are almost parallel, and which snap makes them so at what cost."""
        told = [(i, slant(self.written, i), parallel or not table.is_far) for i, parallel in far]
        for i, sine, parallel in told:
            if not parallel or sine > ALIKE:
                before, axis = self.written.axes[i - 1 : i + 1]
                away = float(length(plus(before.line.nearest(axis.line), before.line.point, -1)))
                joints = f"joints {before.joint.name} and {axis.joint.name} (line {axis.joint.location.line})"
                said = f"{joints} are {sine:.2g} rad from parallel, their common normal {float(f'{away:.3g}'):g} m away"
                yield f"{said}: {'taken as parallel' if parallel else 'kept'}"
        if cut:
            yield named(cut, taken)
        kept = [sine for _, sine, parallel in told if not parallel]
        if kept and (wider := snap_for(max(kept))) <= MOST_SNAP:
            with suppress(RobotFileError):
                other = self._table(wider)
                if not other.is_far:
                    refused = f"; refused, being more than {MOST_MOVED:.0%} of the reach" if other.moves_far else ""
                    moved = f"poses by up to {other.certificate.amounts}"
                    yield f"--snap {float(wider):g} would take them as parallel and move {moved}{refused}"

    def _remarks_on_cut(self, table: _Table, cut: CutOff) -> Iterator[str]:
        """Which angles such as 1.5708 stay so, and which snap takes them for pi/2 at what cost."""
        if cut and (wider := snap_for(max(float(abs(meant(angle) - angle)) for _, angle in cut))) <= MOST_SNAP:
            with suppress(RobotFileError):
                other = self._table(wider)
                ours, theirs = (made.description for made in (table, other))
                same = (ours.joints, ours.base, ours.tool) == (theirs.joints, theirs.base, theirs.tool)
                if not (same or other.moves_far):
                    price = f"--snap {float(wider):g} would take them for these and move poses by up to"
                    yield f"{named(cut, False)}; {price} {other.certificate.amounts}"


def with_named_lengths(robot: Description) -> Description:
    """A robot of numbers with d_i and a_i by name, as books have them, and their numbers as parameters."""
    taken = {*robot_symbols(robot), *(joint.variable for joint in robot.joints)}
    rows = list(enumerate(robot.joints, 1))
    cells = {f"{key}{i}": getattr(joint, key) for i, joint in rows for key in ("d", "a")}
    values = {name: cell for name, cell in cells.items() if cell != ZERO and is_constant(cell) and name not in taken}
    named = {name: Name(name) if name in values else cell for name, cell in cells.items()}
    joints = tuple(replace(joint, d=named[f"d{i}"], a=named[f"a{i}"]) for i, joint in rows)
    return replace(robot, joints=joints, parameters=(*values.items(), *robot.parameters))


def plain_text(text: str) -> str:
    """A text of a URDF as it may stand in a comment, on one line."""
    return quoted(text, 1000)[1:-1]


def notes_on(urdf: Urdf, arm: Arm, *, proven: bool = True) -> Iterator[str]:
    """What a reader should know of an arm, as sentences."""
    yield from urdf.notes
    if not (bodies := [body for axis in arm.axes for body in axis.bodies]):
        yield "no masses: kinematics only"
    for body in bodies:
        if body.mass < 0:
            yield f"link {body.link}: negative mass {float(body.mass):g} kg"
        xx, yy, zz, xy, xz, yz = body.inertia
        if lack := missing_moment((xx, yy, zz, xy, xz, yz)):
            yield f"link {body.link}: physically inconsistent inertia (A + B < C by {lack:.2g} kg m^2)"
    for axis in arm.axes:
        joint = axis.joint
        if joint.limits is not None and axis.limits is None:
            lower, upper = map(float, joint.limits)
            yield f"joint {joint.name}: limits {lower:g} to {upper:g} are taken as none"
        for kind, value in (("damping", joint.damping), ("friction", joint.friction)):
            if value < 0:
                yield f"joint {joint.name}: negative {kind} {float(value):g}"
        if proven and not axis.is_revolute and axis.limits is None:
            yield f"joint {joint.name}: a slide without limits, proven for 1 m to either side"
    for key in ("effort", "velocity"):
        bounds = [(axis.joint.name, getattr(axis.joint, key)) for axis in arm.axes]
        if none := [name for name, most in bounds if most is not None and most <= 0]:
            yield f"joint {', '.join(none)}: {key} of 0 or less is taken as none"
    if arm.held:
        yield f"held at zero: {', '.join(arm.held)}"
    if urdf.unread:
        yield f"not read: {', '.join(urdf.unread)}"


def robot_name(text: str) -> str:
    """A name of robot files from any text."""
    if is_robot_name(text):
        return text
    name = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[: FILE_LIMITS.name_length - 6].strip("-") or "arm"
    return name if is_robot_name(name) else f"{name}-robot"


def meant(angle: Fraction) -> Fraction:
    """The fraction of pi, to many digits, of which an angle has the first decimals, the last one rounded or not."""
    ulp = next((Fraction(1, 10**places) for places in PLACES if angle * 10**places % 1 == 0), Fraction(0))
    for fraction in FRACTIONS if angle else ():
        near = decimal(arb.pi() * round(float(angle) * fraction / pi) / fraction, 3 * DIGITS)
        # Rounded to its last decimal, or cut off after it.
        if 2 * abs(angle - near) <= ulp or 0 < abs(near) - abs(angle) < ulp:
            return near
    return angle


def as_meant(urdf: Urdf) -> Urdf:
    """A robot with fractions of pi where joints have their first decimals; see `meant`."""
    joints = []
    for joint in urdf.joints:
        roll, pitch, yaw = map(meant, joint.origin.rpy)
        joints.append(replace(joint, origin=Origin(joint.origin.xyz, (roll, pitch, yaw))))
    return replace(urdf, joints=tuple(joints))


def cut_off(urdf: Urdf, one: str, other: str, snap: Fraction) -> CutOff:
    """Angles between two links, with their joints, that are first decimals of fractions of pi beyond the snap [rad]."""
    angles = [(joint, angle) for joint in joints_between(urdf, one, other) for angle in joint.origin.rpy]
    return [(joint, angle) for joint, angle in angles if abs(meant(angle) - angle) > snap]


def snap_for(widest: float) -> Fraction:
    """The least snap of two digits that takes angles of some difference for each other [rad]."""
    return Fraction(Context(prec=2, rounding=ROUND_CEILING).create_decimal(repr(widest * (1 + ALIKE))))


def slant(arm: Arm, i: int) -> float:
    """Sine of the angle between an axis and the one before."""
    return float(length(cross(arm.axes[i - 1].line.direction, arm.axes[i].line.direction)))


def named(cut: CutOff, taken: bool) -> str:
    """What was done with angles that somebody cut off, as a sentence."""
    told = [f"{float(angle):.12g} (joint {at.name}, line {at.location.line})" for at, angle in cut[:MOST_NAMED]]
    more = ", ..." if len(cut) > MOST_NAMED else ""
    return f"{', '.join(told)}{more}: {'taken for' if taken else 'almost'} fractions of pi"

"""A robot from a URDF: its table by common normals, its links in the frames of the table."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, Context
from fractions import Fraction

from derive.errors import DeriveError, RobotFileError, quoted
from derive.exchange.arm import Arm, arm_of
from derive.exchange.carried_table import carried_table, placement_of, with_table
from derive.exchange.certificate import Certificate, certify
from derive.exchange.common_normals import ALIKE, FAR, TURNED, Placement, place
from derive.exchange.robot_of_arm import robot_of_arm
from derive.exchange.slanted import as_meant, cut_off, meant, named, slant, slanted
from derive.exchange.space import exactly
from derive.exchange.urdf import Urdf, UrdfJoint
from derive.robot.body_remarks import missing_moment
from derive.robot.description import Convention, Description
from derive.robot.load import is_robot_name
from derive.robot.robot import Robot
from derive.robot.size_limits import FILE_LIMITS
from derive.robot.writer import robot_text

MOST_MOVED = 0.01
"""Of the arm's reach: a table whose poses may be farther from the URDF's is refused."""

ROUNDED = 1e-7
"""What poses may move of any arm, as cells are rounded [m]."""

MOST_SNAP = Fraction(1, 10)
"""Larger angles are no slips [rad]."""


@dataclass(frozen=True, slots=True)
class Imported:
    """A robot and what is known about its making.

    Attributes:
        text: The robot file.
        robot: What it says.
        certificate: How far its poses are from the URDF's.
        links: Names of the links at both ends.
        joints: Names of the joints in the URDF.
        notes: What a reader should know, as sentences.
        snapped: What was changed to exact values, as a sentence.
    """

    text: str
    robot: Robot
    certificate: Certificate
    links: tuple[str, str]
    joints: tuple[str, ...]
    notes: tuple[str, ...]
    snapped: str

    @property
    def report(self) -> tuple[str, ...]:
        """What was made, in lines."""
        kinds = "".join("R" if joint.is_revolute else "P" for joint in self.robot.joints)
        ends = " to ".join(self.links)
        count = f"{self.robot.n} joint{'s' * (self.robot.n > 1)}"
        head = f"{count} ({kinds}), {self.robot.convention.value}, {ends}; base and tool constant"
        return (head, f"{self.snapped}; {self.certificate}", *self.notes)

    def as_dict(self) -> dict[str, object]:
        """The report as plain data."""
        return {
            "robot": self.robot.name,
            "base": self.links[0],
            "tip": self.links[1],
            "joints": list(self.joints),
            "convention": self.robot.convention.value,
            "position_error": self.certificate.position,
            "rotation_error": self.certificate.rotation,
            "notes": list(self.notes),
        }


def import_urdf(
    urdf: Urdf,
    base: str | None,
    tip: str | None,
    convention: Convention,
    snap: Fraction,
    name: str | None = None,
    head: Callable[[str, str], str] | None = None,
) -> Imported:
    """The robot of a chain of a URDF.

    Args:
        urdf: The file.
        base: Link that stands; None for the root.
        tip: Last link; None where only one carries no other.
        convention: Of the table.
        snap: Angles closer to simple fractions of pi are taken for them [rad].
        name: Of the robot; None for that of the URDF.
        head: Gives the first line of the robot file, from the names of the links at both ends.

    Returns:
        The robot file with its certificate.

    Raises:
        RobotFileError: There is no such chain, a joint of it has no place in a table, or poses would move too far.
    """
    with exactly():
        made = _made(urdf, base, tip, convention, snap, name)
        if made.moves_far:
            most, moved = MOST_MOVED * made.arm.reach, made.certificate.position
            raise RobotFileError(
                f"{urdf.source}: --snap {float(snap):g} would move a pose by up to {moved:.2g} m",
                allowed=f"allowed: at most {MOST_MOVED:.0%} of the reach, {most:.2g} m",
                remedy=f"write --snap {float(snap) * most / moved / 2:.0e}" if snap else "",
            )
        slants = tuple(_slants(urdf, made))
    arm = made.arm
    first = [head(arm.base, arm.tip)] if head else []
    names = tuple(_plain(axis.joint.name) for axis in arm.axes)
    carried = ("the table is the one that the URDF carries with it",) if made.carried else ()
    notes = (*carried, *map(_plain, (*slants, *_notes(urdf, arm))))
    ends = (_plain(arm.base), _plain(arm.tip))
    text = robot_text(made.description, [*first, f"joints: {', '.join(names)}", str(made.certificate), *notes])
    robot = _loaded(urdf, text, made.description.name)
    return Imported(text, robot, made.certificate, ends, names, notes, _snapped(made.changes))


@dataclass(frozen=True, slots=True)
class _Made:
    """A table and what it was made of.

    Attributes:
        as_written: Not snapped.
        arm: Snapped.
        placement: The frames.
        description: The robot.
        certificate: How far its poses are from the arm as written.
        changes: By how much angles were changed, where they were [rad].
        far: See `Placement`.
        carried: Whether the file had the table with it.
        cut: Angles that are almost fractions of pi, with their joints, where axes meet far away.
        meant: Whether they were taken for these.
    """

    as_written: Arm
    arm: Arm
    placement: Placement
    description: Description
    certificate: Certificate
    changes: tuple[float, ...]
    far: tuple[tuple[int, bool], ...]
    carried: bool = False
    cut: tuple[tuple[UrdfJoint, Fraction], ...] = ()
    meant: bool = False

    @property
    def moves_far(self) -> bool:
        """Whether poses may be farther from the URDF's than anybody wants."""
        return self.certificate.position > max(MOST_MOVED * self.arm.reach, ROUNDED)

    @property
    def is_far(self) -> bool:
        """Whether a cell is beyond everything that the arm reaches."""
        sizes = (abs(cell) for row in self.placement.rows for cell in (row.d, row.a))
        return max(map(float, sizes)) > FAR * self.arm.reach + ALIKE


def _made(
    urdf: Urdf, base: str | None, tip: str | None, convention: Convention, snap: Fraction, name: str | None
) -> _Made:
    """See `import_urdf`; where axes meet far away, angles are read as they were meant."""
    as_written = arm_of(urdf, base, tip, Fraction(0))
    table = carried_table(urdf, as_written, convention)
    if table is not None:
        arm, placement = arm_of(urdf, base, tip, snap), placement_of(table)
        description = with_table(_described(urdf, arm, placement, snap, name), table)
        return _Made(as_written, arm, placement, description, certify(as_written, description), (), (), carried=True)

    def _by(robot: Urdf, changes: Sequence[float]) -> _Made:
        arm = arm_of(robot, base, tip, snap)
        placement = place(arm, convention, float(snap))
        description = _described(robot, arm, placement, snap, name)
        found = certify(as_written, description)
        changed = (*arm.snaps, *placement.turned, *changes)
        return _Made(as_written, arm, placement, description, found, changed, placement.far)

    plain = _by(urdf, ())
    slanting = any(slant(as_written, i) > ALIKE for i, _ in plain.placement.far)
    cut = cut_off(urdf, as_written.base, as_written.tip, snap) if slanting else []
    other = _by(as_meant(urdf), [float(abs(meant(angle) - angle)) for _, angle in cut]) if cut and snap else plain
    worth = MOST_MOVED * other.arm.reach if plain.is_far else TURNED
    if other.is_far or other.certificate.position > worth:
        return replace(plain, cut=tuple(cut))
    return replace(other, far=plain.far, cut=tuple(cut), meant=other is not plain)


def _described(urdf: Urdf, arm: Arm, placement: Placement, snap: Fraction, name: str | None) -> Description:
    """The robot with its name and title."""
    title = _plain(" ".join(f"{urdf.name}: {arm.base} to {arm.tip}".split()))
    return robot_of_arm(arm, placement, snap, robot_name(name or urdf.name or "arm"), title)


def _slants(urdf: Urdf, made: _Made) -> Iterator[str]:
    """What was done with axes that are almost parallel, and which snap makes them so at what cost, as sentences."""
    arm, far = made.as_written, [(i, taken or not made.is_far) for i, taken in made.far]
    yield from (slanted(arm, i, taken) for i, taken in far if not taken or slant(arm, i) > ALIKE)
    if made.cut:
        yield named(made.cut, made.meant)
    widest = max((slant(arm, i) for i, taken in far if not taken), default=1.0) * (1 + ALIKE)
    wider = Fraction(Context(prec=2, rounding=ROUND_CEILING).create_decimal(repr(widest)))
    with suppress(RobotFileError):
        other = _made(urdf, arm.base, arm.tip, made.placement.convention, wider, None) if wider <= MOST_SNAP else made
        if not other.is_far and other is not made:
            refused = f"; refused, being more than {MOST_MOVED:.0%} of the reach" if other.moves_far else ""
            moved = f"poses by up to {other.certificate.position:.2g} m"
            yield f"--snap {float(wider):g} would take them as parallel and move {moved}{refused}"


def _loaded(urdf: Urdf, text: str, name: str) -> Robot:
    """The robot of a text; what it has against it is said of the URDF."""
    try:
        return Robot.from_text(text, f"{name}.yaml")
    except DeriveError as error:
        raise RobotFileError(f"{urdf.source}: {error.found}", allowed=error.allowed, remedy=error.remedy) from error


def _plain(text: str) -> str:
    """A text of a URDF as it may stand in a comment, on one line."""
    return quoted(text, 1000)[1:-1]


def _snapped(changes: Sequence[float]) -> str:
    """What was changed to exact values."""
    if not changes:
        return "nothing snapped"
    return f"snapped: {len(changes)} angle{'s' * (len(changes) > 1)}, largest change {max(changes):.2g} rad"


def _notes(urdf: Urdf, arm: Arm) -> Iterator[str]:
    """What a reader should know, as sentences."""
    yield from urdf.notes
    bodies = [body for axis in arm.axes for body in axis.bodies]
    if not bodies:
        yield "no masses: kinematics only"
    for body in bodies:
        if body.mass < 0:
            yield f"link {body.link}: negative mass {float(body.mass):g} kg"
        xx, yy, zz, xy, xz, yz = body.inertia
        if lack := missing_moment((xx, yy, zz, xy, xz, yz)):
            yield f"link {body.link}: no body has its inertia (A + B < C by {lack:.2g} kg m^2)"
    for axis in arm.axes:
        joint = axis.joint
        if joint.limits is not None and axis.limits is None:
            lower, upper = map(float, joint.limits)
            yield f"joint {joint.name}: limits {lower:g} to {upper:g} are taken as none"
        for kind, value in (("damping", joint.damping), ("friction", joint.friction)):
            if value < 0:
                yield f"joint {joint.name}: negative {kind} {float(value):g}"
        if not axis.is_revolute and axis.limits is None:
            yield f"joint {joint.name}: a slide without limits, proven for 1 m to either side"
    if arm.held:
        yield f"held at zero: {', '.join(arm.held)}"
    if urdf.unread:
        yield f"not read: {', '.join(urdf.unread)}"


def robot_name(text: str) -> str:
    """A name of robot files from any text.

    Args:
        text: For instance ``UR5 (cb3)``; what is such a name already stays.
    """
    if is_robot_name(text):
        return text
    name = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[: FILE_LIMITS.name_length - 6].strip("-") or "arm"
    return name if is_robot_name(name) else f"{name}-robot"

"""The elements of a URDF that an arm is made of: joints with their frames, and what links weigh, in exact fractions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from derive.errors import Location, quoted

UNLIMITED = 10**6
"""Limits, efforts and speeds from here on are none: URDF wants numbers [rad or m, N m or N, rad/s or m/s]."""

SLIDE = 10
"""Limits of a slide that has none, which URDF does not allow: so far to either side [m]."""

Triple = tuple[Fraction, Fraction, Fraction]
"""Three decimals, exactly as written."""

ZEROS: Triple = (Fraction(0), Fraction(0), Fraction(0))

STILL = ("fixed", "floating", "planar")
"""The other types that URDF has."""

MOVING = {"revolute": True, "continuous": True, "prismatic": False}
"""Types of joints with one variable, and whether it is an angle."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a frame is in another: translation, then Rz(yaw) Ry(pitch) Rx(roll).

    Attributes:
        xyz: [m].
        rpy: [rad].
    """

    xyz: Triple = ZEROS
    rpy: Triple = ZEROS


@dataclass(frozen=True, slots=True)
class UrdfJoint:
    """A joint.

    Attributes:
        name: As in the file.
        type: One of `MOVING` or `STILL`, or what URDF does not have.
        parent: Name of the link that carries it.
        child: Name of the link that it moves.
        origin: Of the child's frame in the parent's at zero.
        axis: In the child's frame, of any length.
        limits: Lower and upper, where there are some [rad or m].
        effort: Largest torque or force [N m or N], where it says one.
        velocity: Largest speed [rad/s or m/s], where it says one.
        damping: Viscous friction.
        friction: Dry friction.
        mimics: Name of the joint that it follows, where it follows one.
        location: Its place in the file.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Origin
    axis: Triple
    limits: tuple[Fraction, Fraction] | None
    effort: Fraction | None
    velocity: Fraction | None
    damping: Fraction
    friction: Fraction
    mimics: str | None
    location: Location

    @property
    def fault(self) -> str:
        """Why no chain may lead through it whatever tables have, in words; empty where some may."""
        if self.type not in (*MOVING, *STILL):
            return f"joint {quoted(self.name)} of type {quoted(self.type)}"
        return "" if self.type in STILL or any(self.axis) else f"joint {quoted(self.name)}: an axis of length 0"


@dataclass(frozen=True, slots=True)
class UrdfBody:
    """What a link weighs.

    Attributes:
        mass: [kg].
        origin: Of the frame at its centre of mass in the link's frame.
        inertia: xx, yy, zz, xy, xz, yz in that frame [kg m^2].
        location: Its place in the file.
        is_point: Whether the file gives no inertia.
    """

    mass: Fraction
    origin: Origin
    inertia: tuple[Fraction, ...]
    location: Location
    is_point: bool = False


@dataclass(frozen=True, slots=True)
class Urdf:
    """A robot of links and joints.

    Attributes:
        name: As in the file.
        bodies: By the name of each link; None of one without ``inertial``.
        joints: In the order of the file.
        notes: What was read though it is not in order, as sentences.
        unread: Kinds of elements that were not read, such as ``visual``.
        source: File name for messages.
        table: Robot file with the table that the URDF was written from; empty in those of other programs.
    """

    name: str
    bodies: Mapping[str, UrdfBody | None]
    joints: tuple[UrdfJoint, ...]
    notes: tuple[str, ...] = field(default=())
    unread: tuple[str, ...] = field(default=())
    source: str = "<urdf>"
    table: str = ""

"""The elements of a URDF that an arm is made of: joints with their frames, and what links weigh, in exact fractions.

What else stands in a file is not read: it is told, or refused where it could change the arm.
"""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.errors import Location, near_miss, quoted

if TYPE_CHECKING:
    from lxml import etree

# Limits, efforts and speeds from here on are none: URDF wants numbers [rad or m, N m or N, rad/s or m/s].
UNLIMITED = 10**6
SLIDE = 10  # limits of a slide that has none, which URDF does not allow: so far to either side [m]
Triple = tuple[Fraction, Fraction, Fraction]  # three decimals, exactly as written
ZEROS: Triple = (Fraction(0), Fraction(0), Fraction(0))

STILL = ("fixed", "floating", "planar")  # the other types that URDF has
# Types of joints with one variable, and whether it is an angle.
MOVING = {"revolute": True, "continuous": True, "prismatic": False}

# The attributes and the elements within each element that an arm is made of, as urdfdom reads them up to URDF 1.2.
READ: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "robot": (("name", "version"), ("link", "joint", "dh_table")),
    "link": (("name",), ("inertial",)),
    "inertial": ((), ("origin", "mass", "inertia")),
    "mass": (("value",), ()),
    "inertia": (("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), ()),
    "joint": (("name", "type"), ("parent", "child", "origin", "axis", "limit", "dynamics", "mimic")),
    "parent": (("link",), ()),
    "child": (("link",), ()),
    "origin": (("xyz", "rpy", "quat_xyzw"), ()),
    "axis": (("xyz",), ()),
    "limit": (("lower", "upper", "effort", "velocity"), ()),
    "dynamics": (("damping", "friction"), ()),
    "mimic": (("joint", "multiplier", "offset"), ()),
}
# Elements that say where something is or what it weighs: what else stands in one may change that.
SHAPING = ("inertial", "mass", "inertia", "parent", "child", "origin", "axis")
# Words of names by which robots, links and joints would say such a thing, too.
WORDS = re.compile(
    r"(?<![a-z])(axis|child|com|density|frame|inertial?|length|mass|offset|orientation|origin|parent|pose|position|quat|"
    r"quaternion|rotation|rpy|scale|transform|translation|units?|xyz)(?![a-z])"
)
PASSED = ("link", "origin")  # a slip that is known and that no program reads: a link has no frame but its joint's


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a frame is in another: translation, then Rz(yaw) Ry(pitch) Rx(roll)."""

    xyz: Triple = ZEROS  # [m]
    rpy: Triple = ZEROS  # [rad]


@dataclass(frozen=True, slots=True)
class UrdfJoint:
    """A joint."""

    name: str  # as in the file
    type: str  # one of `MOVING` or `STILL`, or what URDF does not have
    parent: str  # name of the link that carries it
    child: str  # name of the link that it moves
    origin: Origin  # of the child's frame in the parent's at zero
    axis: Triple  # in the child's frame, of any length
    limits: tuple[Fraction, Fraction] | None  # lower and upper, where there are some [rad or m]
    effort: Fraction | None  # largest torque or force [N m or N], where it says one
    velocity: Fraction | None  # largest speed [rad/s or m/s], where it says one
    damping: Fraction  # viscous friction
    friction: Fraction  # dry friction
    mimics: str | None  # name of the joint that it follows, where it follows one
    location: Location  # its place in the file
    armature: Fraction = Fraction(0)  # inertia of what drives it, which MJCF says [kg m^2 or kg]
    multiplier: Fraction = Fraction(1)  # positions per unit of the joint that it follows
    offset: Fraction = Fraction(0)  # and what is added [rad or m]

    @property
    def fault(self) -> str:
        """Why no chain may lead through it whatever tables have, in words; empty where some may."""
        if self.type not in (*MOVING, *STILL):
            return f"joint {quoted(self.name)} of type {quoted(self.type)}"
        return "" if self.type in STILL or any(self.axis) else f"joint {quoted(self.name)}: an axis of length 0"


@dataclass(frozen=True, slots=True)
class UrdfBody:
    """What a link weighs."""

    mass: Fraction  # [kg]
    origin: Origin  # of the frame at its centre of mass in the link's frame
    inertia: tuple[Fraction, ...]  # xx, yy, zz, xy, xz, yz in that frame [kg m^2]
    location: Location  # its place in the file
    is_point: bool = False  # whether the file gives no inertia


@dataclass(frozen=True, slots=True)
class Urdf:
    """A robot of links and joints."""

    name: str  # as in the file
    bodies: Mapping[str, UrdfBody | None]  # by the name of each link; None of one without ``inertial``
    joints: tuple[UrdfJoint, ...]  # in the order of the file
    notes: tuple[str, ...] = field(default=())  # what was read though it is not in order, as sentences
    unread: tuple[str, ...] = field(default=())  # kinds of elements that were not read, such as ``visual``
    source: str = "<urdf>"  # file name for messages
    table: str = ""  # robot file with the table that the URDF was written from; empty in those of other programs
    gravity: Triple | None = None  # as MJCF says it, in the frame of the root [m/s^2]
    root: str = ""  # how its root moves where the file says so, as that of a robot file: ``floating``


def free_name(name: str, taken: Collection[str]) -> str:
    """A name that nothing else has."""
    while name in taken:
        name += "_"
    return name


def look(
    element: etree._Element,
    unread: Counter[str],
    note: Callable[[etree._Element, str], None],
    refused: Callable[[etree._Element, str, str, str], Exception],
) -> None:
    """Look at an element and at what is read within it; joints and links of a robot are looked at one by one."""
    tag, (attributes, elements) = str(element.tag), READ[str(element.tag)]
    if tag == "limit" and element.getparent().get("type", "").strip() == "continuous":
        attributes = ("effort", "velocity")
    # Names in an element that nothing reads, and texts, with what might stand in their place.
    unknown: list[tuple[str, Sequence[str]]] = []
    unknown += ((str(name), attributes) for name in element.attrib if name not in attributes)
    unknown += ((str(child.tag), elements) for child in element if child.tag not in elements)
    texts = (element.text, *(child.tail for child in element))
    unknown += ((text.strip(), ()) for text in texts if text and text.strip())
    for name, known in unknown:
        # Whether it could say where something is or what it weighs; no name of a namespace and no label does.
        harmless = ":" in name or "{" in name or name in ("name", "id", "comment") or (tag, name) == PASSED
        meant = WORDS.search(name.lower()) or difflib.get_close_matches(name.lower(), SHAPING, 1, 0.8)
        if not harmless and (tag in SHAPING or (tag in ("robot", "link", "joint") and meant)):
            remedy = near_miss(name, known) or "correct it, or leave it out where it changes nothing"
            found, allowed = f"{tag}: {quoted(name)} is not known, and could change the arm", ", ".join(known)
            raise refused(element, found, remedy, allowed and f"allowed: {allowed}")
        unread[quoted(name)[1:-1] + ("" if known is elements else f" of {tag}")] += 1
    within = Counter(child.tag for child in element)
    for child in () if tag == "robot" else [child for child in elements if child in within]:
        if within[child] > 1:
            note(element, f"{within[child]} elements {child} in one {tag}: the first is taken")
        look(element.find(child), unread, note, refused)

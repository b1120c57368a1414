"""The elements of a URDF that an arm is made of: joints with their frames, and what links weigh, in exact fractions."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from derive.errors import Location, quoted

# Limits, efforts and speeds from here on are none: URDF wants numbers [rad or m, N m or N, rad/s or m/s].
UNLIMITED = 10**6
SLIDE = 10  # limits of a slide that has none, which URDF does not allow: so far to either side [m]
Triple = tuple[Fraction, Fraction, Fraction]  # three decimals, exactly as written
ZEROS: Triple = (Fraction(0), Fraction(0), Fraction(0))

STILL = ("fixed", "floating", "planar")  # the other types that URDF has
# Types of joints with one variable, and whether it is an angle.
MOVING = {"revolute": True, "continuous": True, "prismatic": False}


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
    location: Location  # its place in the file
    limits: tuple[Fraction, Fraction] | None = None  # lower and upper, where there are some [rad or m]
    effort: Fraction | None = None  # largest torque or force [N m or N], where it says one
    velocity: Fraction | None = None  # largest speed [rad/s or m/s], where it says one
    damping: Fraction = Fraction(0)  # viscous friction
    friction: Fraction = Fraction(0)  # dry friction
    mimics: str | None = None  # name of the joint that it follows, where it follows one
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
class Held:
    """Two frames that are held together, as MJCF says it."""

    links: tuple[str, str]
    origins: tuple[Origin, Origin]  # of the frames in the links
    is_weld: bool  # whether they coincide, or their origins alone


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
    closures: tuple[Held, ...] = ()  # that close loops
    driven: frozenset[str] = frozenset()  # names of the joints that have motors, as MJCF says it
    postures: tuple[Mapping[str, float], ...] = ()  # positions of joints in configurations that the file names
    root: str = ""  # how its root moves where the file says so, as that of a robot file: ``floating``


def free_name(name: str, taken: Collection[str]) -> str:
    """A name that nothing else has."""
    while name in taken:
        name += "_"
    return name

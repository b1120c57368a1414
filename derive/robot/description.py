"""What a robot file says: the rows of the table, the links, and what is around them; exact, in SI units and radians."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import Any

from derive.errors import Location
from derive.robot.expression import ONE, ZERO, Expression, Name, add, multiply, negate, number, to_text
from derive.robot.options.handout import FigureOptions, HandoutOptions
from derive.robot.options.inverse import InverseOptions
from derive.robot.options.style import Style

INERTIA = ("xx", "yy", "zz", "xy", "xz", "yz")  # entries of a tensor, in the order in which everything lists them
Vector = tuple[Expression, Expression, Expression]  # three cells: a point, or a vector in space
Ways = tuple[Expression, Expression]  # one magnitude for each way in which a joint moves, qd > 0 and qd < 0
Matrix = tuple[tuple[Expression, ...], ...]  # rows of cells; a homogeneous transform has four of four
# The transform that changes nothing.
IDENTITY: Matrix = tuple(tuple(ONE if i == j else ZERO for j in range(4)) for i in range(4))
BASE = "base"  # what rows of a tree that stand on the base, or on a root that moves, are said to follow
FIXED = "fixed"  # the type of rows without motion


class Convention(StrEnum):
    """Which Denavit-Hartenberg table it is."""

    STANDARD = "standard"
    MODIFIED = "modified"


class JointType(StrEnum):
    """What the joint's variable is."""

    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"


@dataclass(frozen=True, slots=True)
class FileUnits:
    """Units of plain numbers in a file; the robot itself is always in radians and metres."""

    degrees: bool = False  # whether plain numbers in angle cells are degrees
    millimetres: bool = False  # whether plain numbers in length cells are millimetres
    parameters: bool = False  # whether numbers of symbols are in the units of the cells that these stand in, too


def pair_text(cell: Expression | Ways, write: Callable[[Expression], str] = to_text) -> str:
    """A cell, or two as a list."""
    return f"[{', '.join(map(write, cell))}]" if isinstance(cell, tuple) else write(cell)


def _cells_text(**cells: Expression | Ways) -> str:
    """Cells that are not zero as text: ``d=d1, alpha=pi/2``."""
    return ", ".join(f"{name}={pair_text(cell)}" for name, cell in cells.items() if cell != ZERO)


class RootType(StrEnum):
    """How the root of a tree moves."""

    PLANAR = "planar"
    FLOATING = "floating"


@dataclass(frozen=True, slots=True)
class Stand:
    """Where a row of a tree stands: behind which row, and what is constant between that and its own cells."""

    after: str  # label of the row that it follows, or `BASE`
    mount: Matrix = IDENTITY  # constant 4x4 transform before all else of the row
    # Angle [rad] and offset [m] about and along z of the row that it follows, behind the mount; modified convention
    # (Khalil and Kleinfinger 1986).
    gamma: Expression = ZERO
    b: Expression = ZERO


@dataclass(frozen=True, slots=True, repr=False)
class Joint:
    """One row of the table.

    For a revolute joint the angle is ``sign*q + theta`` and ``d`` is constant; for a prismatic joint the offset is
    ``sign*q + d`` and ``theta`` is constant. No other cell contains a joint variable. In the modified convention
    ``a`` and ``alpha`` are a_{i-1} and alpha_{i-1}.
    """

    type: JointType  # revolute or prismatic
    variable: str  # name of the joint variable, for instance ``q1``
    sign: int  # +1 or -1, the factor of the variable in its cell
    theta: Expression  # constant part of the angle [rad]
    d: Expression  # constant part of the offset along z [m]
    a: Expression  # link length [m]
    alpha: Expression  # link twist [rad]
    limits: tuple[Expression, Expression] | None = None  # lower and upper limit of the variable [rad or m], or None
    speed: Expression | None = None  # largest speed of the variable, either way [rad/s or m/s], or None
    torque: Expression | None = None  # largest torque or force, either way [N m or N], or None
    # Free text by which others know the joint, such as ``shoulder_pan``; inert in every output; or empty.
    name: str = ""
    stand: Stand | None = None  # None where it follows the joint of the row above with nothing between
    # Variables of a coupled joint with their factors: its cell is the sum of factor*variable and the constant part, and
    # ``variable`` is a name of its own that stands for the sum; empty where the joint has its variable for itself.
    drive: tuple[tuple[str, Expression], ...] = ()
    # Of a passive joint the variables that its loops let it follow, with the names of its own variable's derivatives by
    # them, G_q3_q1 for d q3/d q1; empty of others.
    follows: tuple[tuple[str, Name], ...] = ()
    # What the variable of a passive joint is that parallelograms make linear, in those of `drive`; None of others.
    meant: Expression | None = None

    @property
    def label(self) -> str:
        """What the joint is called: its name, else that of its variable."""
        return self.name or self.variable

    @property
    def is_revolute(self) -> bool:
        """Whether the variable is an angle."""
        return self.type is JointType.REVOLUTE

    @property
    def row(self) -> dict[str, str]:
        """The cells theta, d, a, alpha as text, the variable in its own: ``{"theta": "-q1 + pi/2", ...}``."""
        return self.written(to_text)

    def written(self, write: Callable[[Expression], str]) -> dict[str, str]:
        """The cells as `row` has them, their constant parts written otherwise."""
        moving = "theta" if self.is_revolute else "d"
        cells = {"theta": self.theta, "d": self.d, "a": self.a, "alpha": self.alpha}
        row = {name: write(cell) for name, cell in cells.items()}
        variable, constant = to_text(position(self)), row[moving]
        rest = f" - {constant[1:]}" if constant.startswith("-") else f" + {constant}"
        return row | {moving: variable if constant == "0" else variable + rest}

    def __repr__(self) -> str:
        cells = ", ".join(f"{name}={text}" for name, text in self.row.items() if text != "0")
        limits = f", limits=[{', '.join(map(to_text, self.limits))}]" if self.limits else ""
        return f"Joint({self.type.value}, {cells}{limits})"


@dataclass(frozen=True, slots=True, repr=False)
class Motor:
    """A rotor on the axis of joint i, carried by link i-1, spinning at ``ratio * qd_i``.

    It sits at o_{i-1} and spins about z_{i-1} (standard), or sits at o_i and spins about z_i (modified; for a
    prismatic joint at its place for q_i = 0).
    """

    mass: Expression = ZERO  # rotor mass [kg]
    inertia: Expression = ZERO  # moment of inertia about the spin axis [kg m^2]
    ratio: Expression = ZERO  # Gear ratio k_r

    def __repr__(self) -> str:
        return f"Motor({_cells_text(mass=self.mass, inertia=self.inertia, ratio=self.ratio)})"


@dataclass(frozen=True, slots=True, repr=False)
class Inertia:
    """Inertia tensor about the centre of mass, axes of link frame i [kg m^2]; ``xy`` is the matrix entry I[1,2]."""

    xx: Expression = ZERO
    yy: Expression = ZERO
    zz: Expression = ZERO
    xy: Expression = ZERO
    xz: Expression = ZERO
    yz: Expression = ZERO

    def __repr__(self) -> str:
        return f"Inertia({_cells_text(**{key: getattr(self, key) for key in INERTIA})})"


@dataclass(frozen=True, slots=True, repr=False)
class Link:
    """Inertial parameters of one link, in its own DH frame i."""

    mass: Expression = ZERO  # mass [kg]
    com: Vector = (ZERO, ZERO, ZERO)  # centre of mass in frame i [m]
    inertia: Inertia = field(default_factory=Inertia)  # tensor about the centre of mass, axes of frame i [kg m^2]
    motor: Motor | None = None  # rotor that drives joint i, or None
    armature: Expression = ZERO  # reflected rotor inertia, added to B[i,i] only [kg m^2 or kg]
    viscous: Expression = ZERO  # joint-side viscous coefficient b of ``b*qd``
    # Joint-side Coulomb coefficient f of ``f*sign(qd)``, or that of either way: f_plus for qd > 0, -f_minus for qd < 0.
    coulomb: Expression | Ways = ZERO

    @property
    def dry(self) -> Ways:
        """Coulomb friction for qd > 0, and against that for qd < 0, (f_plus, f_minus) [N m or N]."""
        return self.coulomb if isinstance(self.coulomb, tuple) else (self.coulomb, self.coulomb)

    @property
    def signed(self) -> Ways:
        """Factors of sign(qd) and sign(qd)^2 in it: (f_plus + f_minus)/2 and (f_plus - f_minus)/2 [N m or N]."""
        if not isinstance(self.coulomb, tuple):
            return self.coulomb, ZERO
        half, (ahead, back) = number(Fraction(1, 2)), self.coulomb
        return multiply(half, add(ahead, back)), multiply(half, add(ahead, negate(back)))

    def __repr__(self) -> str:
        parts = [f"com=[{', '.join(map(to_text, self.com))}]"] if any(cell != ZERO for cell in self.com) else []
        parts += [repr(self.inertia)] if self.inertia != Inertia() else []
        parts += [repr(self.motor)] if self.motor is not None else []
        rest = _cells_text(armature=self.armature, viscous=self.viscous, coulomb=self.coulomb)
        return f"Link({', '.join([f'mass={to_text(self.mass)}', *parts, *([rest] if rest else [])])})"


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of coupled joints."""

    variable: str  # its name
    type: JointType  # whether it is an angle or a length
    limits: tuple[Expression, Expression] | None = None  # lower and upper limit [rad or m], or None
    speed: Expression | None = None  # largest speed, either way [rad/s or m/s], or None
    torque: Expression | None = None  # largest torque or force, either way [N m or N], or None
    name: str = ""  # it has no other name

    @property
    def label(self) -> str:
        """What it is called."""
        return self.variable

    @property
    def is_revolute(self) -> bool:
        """Whether it is an angle."""
        return self.type is JointType.REVOLUTE


class Joining(StrEnum):
    """What joins two frames where a loop closes."""

    REVOLUTE = "revolute"  # their origins and z axes coincide
    PRISMATIC = "prismatic"  # their axes are parallel and one origin is on the other's z axis
    SPHERICAL = "spherical"  # their origins coincide
    FIXED = "fixed"  # they coincide
    DISTANCE = "distance"  # a rod between two ball joints keeps the distance of their origins


@dataclass(frozen=True, slots=True)
class Loop:
    """A closed loop of a tree: two of its frames are joined."""

    join: tuple[str, str]  # labels of the rows whose frames are joined, or `BASE`
    by: Joining  # what joins them
    branch: str = ""  # a sign for each choice of the assembly, "+" or "-"; empty for all "+"
    length: Expression = ZERO  # of a rod [m]
    location: Location | None = field(default=None, compare=False, repr=False)  # in the file, for messages


@dataclass(frozen=True, slots=True)
class FixedRow:
    """A row of a tree without motion: a constant transform, and perhaps a body."""

    name: str  # by which rows and ends follow it
    stand: Stand  # where it stands
    theta: Expression = ZERO  # angle about z [rad]
    d: Expression = ZERO  # offset along z [m]
    a: Expression = ZERO  # link length [m]
    alpha: Expression = ZERO  # link twist [rad]
    link: Link | None = None  # its body, in its own frame; None without dynamics
    row: int | None = None  # its place in the table of the file, from 0; None of a root that moves

    @property
    def label(self) -> str:
        """What the row is called, as a joint is."""
        return self.name

    def written(self, write: Callable[[Expression], str]) -> dict[str, str]:
        """The cells as a joint has them."""
        return {key: write(getattr(self, key)) for key in ("theta", "d", "a", "alpha")}


@dataclass(frozen=True, slots=True)
class End:
    """An end of a tree."""

    name: str  # ``[A-Za-z][A-Za-z0-9_]*``; empty where there is one end without a name
    after: str  # label of the row on which it is
    tool: Matrix = IDENTITY  # constant 4x4 transform from that row's frame to the end


@dataclass(frozen=True, slots=True)
class Root:
    """A root that moves: x, y and an angle about z, or x, y, z and the angles of Rot(z) Rot(y) Rot(x), in frame 0."""

    type: RootType  # planar or floating
    variables: tuple[str, ...]  # three or six, which come first in q
    link: Link | None = None  # its body, in its own frame; None without dynamics


@dataclass(frozen=True, slots=True)
class Remark:
    """Something in a robot file that is allowed, and hardly meant."""

    location: Location  # file, line and column of the cell
    found: str  # the cell and what it says, as read
    remedy: str  # what to write if something else was meant
    is_of_bodies: bool = False  # whether it matters to dynamics alone

    def __str__(self) -> str:
        return f"{self.location}: {self.found}; {self.remedy}"

    def as_dict(self) -> dict[str, str | int]:
        """The remark as plain data."""
        file, line, column = self.location.source, self.location.line, self.location.column
        return {"file": file, "line": line, "column": column, "found": self.found, "remedy": self.remedy}


@dataclass(frozen=True, slots=True)
class Description:
    """An arm or a tree as its file describes it: the DH table, the frames around it and, if given, its dynamics."""

    name: str  # ``[a-z0-9-]+``
    title: str  # free text; inert in every output
    convention: Convention  # standard or modified
    joints: tuple[Joint, ...]  # one row per joint, those of a root that moves first
    # Constant 4x4 transform from the world frame to frame 0.
    base: Matrix = field(default_factory=lambda: IDENTITY)  # a factory, so that help() shows no tree
    tool: Matrix = field(default_factory=lambda: IDENTITY)  # constant 4x4 transform from frame n to the end effector
    gravity: Vector | None = None  # acceleration of gravity in the world frame [m/s^2]; None where the file gives none
    links: tuple[Link, ...] = ()  # one per joint, or empty when the file has no dynamics
    # Numbers of symbols (exact; a value may contain pi or sqrt), in the file's order.
    parameters: tuple[tuple[str, Expression], ...] = ()
    runtime: tuple[str, ...] = ()  # names that stay free in generated code though they have a number
    wrench: tuple[str, ...] = ()  # axes, "world" or "end", of a wrench that generated dynamics take as an argument
    style: Style = field(default_factory=Style)  # how expressions are grouped in print
    handout: HandoutOptions = field(default_factory=HandoutOptions)  # what the handout shows and how
    figure: FigureOptions = field(default_factory=FigureOptions)  # which configuration is drawn
    inverse: InverseOptions = field(default_factory=InverseOptions)  # what inverse kinematics is asked for
    # Units of plain numbers in the file; needed only for numbers that a user types beside it.
    units: FileUnits = FileUnits()
    digest: str = ""  # SHA-256 of the robot file's bytes, hexadecimal
    source: str = ""  # file name or catalogue name, for messages only; never written to an output
    fixed: tuple[FixedRow, ...] = ()  # rows without motion, in the order of the file
    ends: tuple[End, ...] = ()  # the ends by name; empty for one end behind the last row
    coupled: tuple[Variable, ...] = ()  # the variables, where some joint is coupled; else each joint has its own
    root: Root | None = None  # how the root moves, None where it stands; its rows are the first of ``joints``
    loops: tuple[Loop, ...] = ()  # in the order in which they are closed
    # What the file says and hardly means, such as 90 rad.
    remarks: tuple[Remark, ...] = field(default=(), compare=False)
    # Comments before the first line of the file, such as whence the robot is.
    comments: tuple[str, ...] = field(default=(), compare=False, repr=False)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joints)

    @property
    def variables(self) -> tuple[Joint | Variable, ...]:
        """What q consists of: the variables of coupled joints, or each joint with its own."""
        return self.coupled or self.joints

    @property
    def movers(self) -> tuple[Joint | Variable, ...]:
        """What has a position by name: the variables, and the passive joints of closed loops."""
        return (*self.variables, *self.passive)

    @property
    def passive(self) -> tuple[Joint, ...]:
        """The joints that closed loops move, whose variables are no part of q."""
        return tuple(joint for joint in self.joints if joint.follows)

    @property
    def dof(self) -> int:
        """Number of variables."""
        return len(self.variables)

    @property
    def has_dynamics(self) -> bool:
        """Whether the file gives link parameters."""
        return bool(self.links)

    @property
    def is_tree(self) -> bool:
        """Whether it is more than one chain of rows of the table, each behind the one above with its own variable."""
        return bool(self.fixed or self.ends or self.coupled) or any(joint.stand for joint in self.joints)


# -- how the joints follow the variables: positions of joints are S q and constants, S a constant matrix. Rows of S that
# belong to passive joints of closed loops are not constant: they stand for the derivatives of their positions.


def drives(joint: Joint) -> tuple[tuple[str, Expression], ...]:
    """The variables of a joint with their factors in its cell."""
    return joint.drive or ((joint.variable, ONE if joint.sign > 0 else negate(ONE)),)


def position(joint: Joint) -> Expression:
    """What is variable of a joint's cell."""
    return add(*(multiply(factor, Name(variable)) for variable, factor in drives(joint)))


def second_derivative(joint: Joint, one: str, other: str) -> Name:
    """The name of the second derivative of a passive joint's variable by two variables that it follows."""
    first, second = (name for name, _ in joint.follows if name in (one, other)) if one != other else (one, one)
    return Name(f"H_{joint.variable}_{first}_{second}")


def derivatives(robot: Description) -> dict[tuple[str, ...], Name]:
    """The names of first and second derivatives by passive joint and variables: of (q3, q1) G_q3_q1."""
    found: dict[tuple[str, ...], Name] = {}
    found |= {(joint.variable, name): factor for joint in robot.passive for name, factor in joint.follows}
    for joint in robot.passive:
        for pair in combinations_with_replacement([name for name, _ in joint.follows], 2):
            found[joint.variable, *pair] = second_derivative(joint, *pair)
    return found


def coupling(robot: Description, scalar: Callable[[Expression], Any] = lambda factor: factor) -> list[list[Any]]:
    """S, a row for each joint and a column for each variable."""
    rows = (dict(joint.drive or joint.follows) or {joint.variable: ONE} for joint in robot.joints)
    return [[scalar(row.get(variable.variable, ZERO)) for variable in robot.variables] for row in rows]


def projected(values: Sequence[Any], matrix: Sequence[Sequence[Any]], zero: Any) -> list[Any]:
    """S^T v: what joints feel, as the variables feel it."""
    pairs = list(zip(matrix, values, strict=True))
    return [sum((row[k] * value for row, value in pairs if row[k]), zero) for k in range(len(matrix[0]))]

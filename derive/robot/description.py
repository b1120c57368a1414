"""What a robot file says: the rows of the table, the links, and what is around them; exact, in SI units and radians."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from derive.robot.expression import ONE, ZERO, Expression
from derive.robot.handout import FigureOptions, HandoutOptions
from derive.robot.style import Contraction, Style

Vector = tuple[Expression, Expression, Expression]
Matrix = tuple[tuple[Expression, ...], ...]

IDENTITY: Matrix = tuple(tuple(ONE if i == j else ZERO for j in range(4)) for i in range(4))


class Convention(StrEnum):
    """Which Denavit-Hartenberg table it is."""

    STANDARD = "standard"
    MODIFIED = "modified"


class JointType(StrEnum):
    """What the joint's variable is."""

    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"


@dataclass(frozen=True, slots=True)
class Joint:
    """One row of the table.

    For a revolute joint the angle is ``sign*q + theta`` and ``d`` is constant; for a prismatic joint the offset is
    ``sign*q + d`` and ``theta`` is constant. No other cell contains a joint variable. In the modified convention
    ``a`` and ``alpha`` are a_{i-1} and alpha_{i-1}.

    Attributes:
        type: Revolute or prismatic.
        variable: Name of the joint variable, for instance ``q1``.
        sign: +1 or -1, the factor of the variable in its cell.
        theta: Constant part of the angle [rad].
        d: Constant part of the offset along z [m].
        a: Link length [m].
        alpha: Link twist [rad].
        limits: Lower and upper limit of the variable [rad or m], or None.
    """

    type: JointType
    variable: str
    sign: int
    theta: Expression
    d: Expression
    a: Expression
    alpha: Expression
    limits: tuple[Expression, Expression] | None = None

    @property
    def is_revolute(self) -> bool:
        """Whether the variable is an angle."""
        return self.type is JointType.REVOLUTE


@dataclass(frozen=True, slots=True)
class Motor:
    """A rotor on the axis of joint i, carried by link i-1, spinning at ``ratio * qd_i``.

    It sits at o_{i-1} and spins about z_{i-1} (standard), or sits at o_i and spins about z_i (modified; for a
    prismatic joint at its place for q_i = 0).

    Attributes:
        mass: Rotor mass [kg].
        inertia: Moment of inertia about the spin axis [kg m^2].
        ratio: Gear ratio k_r.
    """

    mass: Expression = ZERO
    inertia: Expression = ZERO
    ratio: Expression = ZERO


@dataclass(frozen=True, slots=True)
class Inertia:
    """Inertia tensor about the centre of mass, axes of link frame i [kg m^2]."""

    xx: Expression = ZERO
    yy: Expression = ZERO
    zz: Expression = ZERO
    xy: Expression = ZERO
    xz: Expression = ZERO
    yz: Expression = ZERO


@dataclass(frozen=True, slots=True)
class Link:
    """Inertial parameters of one link, in its own DH frame i.

    Attributes:
        mass: Mass [kg].
        com: Centre of mass in frame i [m].
        inertia: Tensor about the centre of mass, axes of frame i [kg m^2].
        motor: Rotor that drives joint i, or None.
        armature: Reflected rotor inertia, added to B[i,i] only [kg m^2 or kg].
        viscous: Joint-side viscous coefficient b of ``b*qd``.
        coulomb: Joint-side Coulomb coefficient f of ``f*sign(qd)``.
    """

    mass: Expression = ZERO
    com: Vector = (ZERO, ZERO, ZERO)
    inertia: Inertia = field(default_factory=Inertia)
    motor: Motor | None = None
    armature: Expression = ZERO
    viscous: Expression = ZERO
    coulomb: Expression = ZERO


@dataclass(frozen=True, slots=True)
class Description:
    """A serial arm as its file describes it: the DH table, the frames around it and, if given, its dynamics.

    Attributes:
        name: ``[a-z0-9-]+``.
        title: Free text; inert in every output.
        convention: Standard or modified.
        joints: One row per joint.
        base: Constant 4x4 transform from the world frame to frame 0.
        tool: Constant 4x4 transform from frame n to the end effector.
        gravity: Acceleration of gravity in the world frame [m/s^2]; None where the file gives none.
        links: One per joint, or empty when the file has no dynamics.
        parameters: Numbers of symbols (exact; a value may contain pi or sqrt), in the file's order.
        runtime: Names that stay free in generated code though they have a number.
        style: How expressions are grouped in print, see `derive.robot.style`.
        contraction: Which sums of angles are contracted in print.
        handout: What the handout shows and how, see `derive.robot.handout`.
        figure: Which configuration is drawn.
        digest: SHA-256 of the robot file's bytes, hexadecimal.
        source: File name or catalogue name, for messages only; never written to an output.
    """

    name: str
    title: str
    convention: Convention
    joints: tuple[Joint, ...]
    base: Matrix = IDENTITY
    tool: Matrix = IDENTITY
    gravity: Vector | None = None
    links: tuple[Link, ...] = ()
    parameters: tuple[tuple[str, Expression], ...] = ()
    runtime: tuple[str, ...] = ()
    style: Style = Style.COMPACT
    contraction: Contraction = Contraction.ALIGNED
    handout: HandoutOptions = field(default_factory=HandoutOptions)
    figure: FigureOptions = field(default_factory=FigureOptions)
    digest: str = ""
    source: str = ""

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joints)

    @property
    def has_dynamics(self) -> bool:
        """Whether the file gives link parameters."""
        return bool(self.links)

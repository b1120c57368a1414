"""What some notes print about a robot: quantities entry by entry, each formula with its place in the file."""

from __future__ import annotations

from dataclasses import dataclass

from derive.errors import Location
from derive.robot.expression import Expression
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Printed:
    """One printed formula.

    Attributes:
        row: Row of the entry, from 1.
        column: Column of the entry, from 1.
        text: As it is printed.
        formula: What it says, in the robot's own names.
        location: Where it stands.
    """

    row: int
    column: int
    text: str
    formula: Expression
    location: Location


@dataclass(frozen=True, slots=True)
class PrintedQuantity:
    """One printed matrix, vector or scalar, or some entries of it.

    Attributes:
        quantity: Its name, for instance ``A[1]`` or ``christoffel[1,1,2]``.
        location: Where the item begins.
        entries: The printed entries.
        shape: Rows and columns where the whole matrix is printed.
        abbreviated: The same entries once more, with the abbreviations of the notes.
        corrections: Right formulas for wrong entries.
        rest_zero: Whether all other entries are printed as zero.
        status: ``ok``, or ``erratum`` where the notes are known to be wrong.
        kind: ``error``, or what else makes it an erratum: ``convention``, ``notation``.
        duplicate: Whether another file counts it.
        implied: Whether it is only implied by the text.
    """

    quantity: str
    location: Location
    entries: tuple[Printed, ...]
    shape: tuple[int, int] | None = None
    abbreviated: tuple[Printed, ...] = ()
    corrections: tuple[Printed, ...] = ()
    rest_zero: bool = False
    status: str = "ok"
    kind: str = "error"
    duplicate: bool = False
    implied: bool = False


@dataclass(frozen=True, slots=True)
class Identity:
    """A printed identity between two formulas.

    Attributes:
        left: Its left-hand side.
        right: Its right-hand side.
        status: ``ok`` or ``erratum``.
    """

    left: Printed
    right: Printed
    status: str = "ok"


@dataclass(frozen=True, slots=True)
class Factorisation:
    """A printed product of matrices.

    Attributes:
        of: The quantity on the left-hand side.
        factors: The quantities whose product it is.
        location: Where it stands.
    """

    of: str
    factors: tuple[str, ...]
    location: Location


@dataclass(frozen=True, slots=True)
class CorpusFile:
    """A robot and what is printed about it.

    Attributes:
        source: Name of the file as given.
        robot: The robot.
        expected: Printed quantities.
        identities: Printed identities.
        factorisation: A printed product, or None.
        unread: Blocks that hold printed results of other kinds.
    """

    source: str
    robot: Robot
    expected: tuple[PrintedQuantity, ...]
    identities: tuple[Identity, ...] = ()
    factorisation: Factorisation | None = None
    unread: tuple[str, ...] = ()

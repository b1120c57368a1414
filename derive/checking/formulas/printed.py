"""What some notes print about a robot: quantities entry by entry, each formula with its place in the file."""

from __future__ import annotations

from dataclasses import dataclass

from derive.errors import Location, UnknownNameError
from derive.robot.expression import Expression
from derive.robot.options.inverse import Task
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Citation:
    """Where something is printed.

    Attributes:
        title: The document.
        section: Its section, page or equation.
    """

    title: str = ""
    section: str = ""


NO_CITATION = Citation()


@dataclass(frozen=True, slots=True, eq=False)
class Remark:
    """What a file says about one printed item; remarks on two items are never the same, though they say the same.

    Attributes:
        note: Why it is an erratum, how it was verified.
        kind: What makes it one: ``error``, ``convention``, ``notation``.
        duplicate: Whether another file counts it.
        document: Where it is printed, if not where the rest of the file is.
    """

    note: str = ""
    kind: str = "error"
    duplicate: bool = False
    document: Citation = NO_CITATION


NO_REMARK = Remark()


@dataclass(frozen=True, slots=True)
class Printed:
    """One printed formula.

    Attributes:
        row: Row of the entry, from 1.
        column: Column of the entry, from 1.
        text: As it is printed.
        formula: What it says, in the robot's own names; zero where that is unknown.
        location: Where it stands.
        unknown: The name that the robot does not know, if there is one.
    """

    row: int
    column: int
    text: str
    formula: Expression
    location: Location
    unknown: UnknownNameError | None = None


@dataclass(frozen=True, slots=True)
class PrintedText:
    """LaTeX in a file.

    Attributes:
        text: As it is printed.
        location: Where its first character stands.
        verbatim: Whether it stands in the file character by character, so that offsets are exact.
    """

    text: str
    location: Location
    verbatim: bool = True


@dataclass(frozen=True, slots=True)
class PrintedQuantity:
    """One printed matrix, vector or scalar, or some entries of it.

    Attributes:
        quantity: Its name, for instance ``A[1]`` or ``christoffel[1,1,2]``; may be empty of LaTeX with left sides.
        location: Where the item begins.
        entries: The printed entries.
        shape: Rows and columns where the whole matrix is printed.
        abbreviated: The same entries once more, with the abbreviations of the notes.
        corrections: Right formulas for wrong entries.
        rest_zero: Whether all other entries are printed as zero.
        status: ``ok``, or ``erratum`` where the notes are known to be wrong.
        remark: What the file says about it.
        implied: Whether it is only implied by the text.
        latex: What is printed as LaTeX, in the place of entries.
    """

    quantity: str
    location: Location
    entries: tuple[Printed, ...]
    shape: tuple[int, int] | None = None
    abbreviated: tuple[Printed, ...] = ()
    corrections: tuple[Printed, ...] = ()
    rest_zero: bool = False
    status: str = "ok"
    remark: Remark = NO_REMARK
    implied: bool = False
    latex: PrintedText | None = None


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
class Solution:
    """A printed formula of inverse kinematics: an unknown from the entries of T.

    Attributes:
        unknown: Its name, for messages.
        value: What it is, in the joint variables.
        printed: The formula; its names ox, r11, ... are kept.
        is_angle: Whether it is right up to full turns.
        correction: The right formula, where the printed one is known to be wrong.
        status: ``ok`` or ``erratum``.
        remark: What the file says about it.
    """

    unknown: str
    value: Expression
    printed: Printed
    is_angle: bool = False
    correction: Printed | None = None
    status: str = "ok"
    remark: Remark = NO_REMARK


@dataclass(frozen=True, slots=True)
class Asked:
    """What is said beside the lines of a printed solution.

    Attributes:
        location: Where it stands.
        task: The rows of its task; None where the names that it uses say it.
        cosine_first: Whether the first argument of its atan2 is the cosine; None where the text decides.
    """

    location: Location
    task: Task | None = None
    cosine_first: bool | None = None


@dataclass(frozen=True, slots=True)
class InverseText:
    """A printed solution as it is given.

    Attributes:
        parts: Its text in one or several pieces.
        asked: What is said beside it, and where it begins.
        latex: Whether it is LaTeX.
        document: Whether it is a LaTeX document, whose displays are read.
        status: ``ok``, or ``erratum`` where it is known to be wrong.
        remark: What the file says about it.
    """

    parts: tuple[PrintedText, ...]
    asked: Asked
    latex: bool = False
    document: bool = False
    status: str = "ok"
    remark: Remark = NO_REMARK


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
        solutions: Printed inverse kinematics.
        document: Where all this is printed.
        inverse: Printed solutions of the inverse kinematics, all lines together.
    """

    source: str
    robot: Robot
    expected: tuple[PrintedQuantity, ...]
    identities: tuple[Identity, ...] = ()
    factorisation: Factorisation | None = None
    unread: tuple[str, ...] = ()
    solutions: tuple[Solution, ...] = ()
    document: Citation = NO_CITATION
    inverse: tuple[InverseText, ...] = ()

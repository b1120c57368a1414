"""What some notes print about a robot: quantities entry by entry, each formula with its place in the file."""

from dataclasses import dataclass

from derive.errors import Location, UnknownNameError
from derive.robot.expression import Expression
from derive.robot.options.inverse import Task
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Citation:
    """Where something is printed."""

    title: str = ""  # the document
    section: str = ""  # section, page or equation


NO_CITATION = Citation()


@dataclass(frozen=True, slots=True, eq=False)
class Remark:
    """What a file says about one printed item; remarks on two items are never the same, though they say the same."""

    note: str = ""  # why it is an erratum, how it was verified
    kind: str = "error"  # what makes it one: ``error``, ``convention``, ``notation``
    duplicate: bool = False  # whether another file counts it
    document: Citation = NO_CITATION  # where it is printed, if not where the rest of the file is


NO_REMARK = Remark()


@dataclass(frozen=True, slots=True)
class Printed:
    """One printed formula."""

    row: int  # row of the entry, from 1
    column: int  # column of the entry, from 1
    text: str  # as it is printed
    formula: Expression  # what it says, in the robot's own names; zero where that is unknown
    location: Location  # where it stands
    unknown: UnknownNameError | None = None  # the name that the robot does not know, if there is one


@dataclass(frozen=True, slots=True)
class PrintedText:
    """LaTeX in a file."""

    text: str  # as it is printed
    location: Location  # where its first character stands
    verbatim: bool = True  # whether it stands in the file character by character, so that offsets are exact


@dataclass(frozen=True, slots=True)
class PrintedQuantity:
    """One printed matrix, vector or scalar, or some entries of it."""

    quantity: str  # its name, for instance ``A[1]`` or ``christoffel[1,1,2]``; may be empty of LaTeX with left sides
    location: Location  # where the item begins
    entries: tuple[Printed, ...]  # the printed entries
    shape: tuple[int, int] | None = None  # rows and columns where the whole matrix is printed
    abbreviated: tuple[Printed, ...] = ()  # the same entries once more, with the abbreviations of the notes
    corrections: tuple[Printed, ...] = ()  # right formulas for wrong entries
    rest_zero: bool = False  # whether all other entries are printed as zero
    status: str = "ok"  # ``ok``, or ``erratum`` where the notes are known to be wrong
    remark: Remark = NO_REMARK  # what the file says about it
    implied: bool = False  # whether it is only implied by the text
    latex: PrintedText | None = None  # what is printed as LaTeX, in the place of entries


@dataclass(frozen=True, slots=True)
class Identity:
    """A printed identity between two formulas."""

    left: Printed  # its left-hand side
    right: Printed  # its right-hand side
    status: str = "ok"  # ``ok`` or ``erratum``


@dataclass(frozen=True, slots=True)
class Factorisation:
    """A printed product of matrices."""

    of: str  # the quantity on the left-hand side
    factors: tuple[str, ...]  # the quantities whose product it is
    location: Location  # where it stands


@dataclass(frozen=True, slots=True)
class Solution:
    """A printed formula of inverse kinematics: an unknown from the entries of T."""

    unknown: str  # its name, for messages
    value: Expression  # what it is, in the joint variables
    printed: Printed  # the formula; its names ox, r11, ... are kept
    is_angle: bool = False  # whether it is right up to full turns
    correction: Printed | None = None  # the right formula, where the printed one is known to be wrong
    status: str = "ok"  # ``ok`` or ``erratum``
    remark: Remark = NO_REMARK  # what the file says about it


@dataclass(frozen=True, slots=True)
class InverseText:
    """A printed solution as it is given."""

    parts: tuple[PrintedText, ...]  # its text in one or several pieces
    location: Location  # where it begins
    task: Task | None = None  # the rows of its task; None where the names that it uses say it
    cosine_first: bool | None = None  # whether its atan2 takes the cosine first; None where the text decides
    latex: bool = False  # whether it is LaTeX
    document: bool = False  # whether it is a LaTeX document, whose displays are read
    status: str = "ok"  # ``ok``, or ``erratum`` where it is known to be wrong
    remark: Remark = NO_REMARK  # what the file says about it


@dataclass(frozen=True, slots=True)
class CorpusFile:
    """A robot and what is printed about it."""

    source: str  # name of the file as given
    robot: Robot
    expected: tuple[PrintedQuantity, ...]
    identities: tuple[Identity, ...] = ()
    factorisation: Factorisation | None = None  # a printed product, or None
    unread: tuple[str, ...] = ()  # blocks that hold printed results of other kinds
    solutions: tuple[Solution, ...] = ()  # printed inverse kinematics
    document: Citation = NO_CITATION  # where all this is printed
    inverse: tuple[InverseText, ...] = ()  # printed solutions of the inverse kinematics, all lines together

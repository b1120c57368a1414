"""Comparisons of printed formulas with derived ones, as data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from derive.checking.diagnosis import Question, Repair
from derive.checking.printed import NO_CITATION, NO_REMARK, Citation, Remark
from derive.errors import DeriveError, Location, UnknownNameError
from derive.lecture.to_sympy import Expr
from derive.model.equality import Verdict, compare
from derive.robot.expression import Expression
from derive.robot.robot import Robot

NOTHING_KNOWN = Verdict(equal=False, exact=True)
"""Stands where no verdict is possible."""


class Role(Enum):
    """What a compared formula is in its file."""

    PRINTED = "printed"
    ABBREVIATED = "abbreviated"
    REST = "rest"
    CORRECTION = "correction"
    IDENTITY = "identity"
    FACTORISATION = "factorisation"
    SOLUTION = "solution"
    PRODUCT = "product"
    EQUATION = "equation"


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """One comparison.

    Attributes:
        quantity: What the formula is printed for, without the place of the entry.
        row: Row of the entry, from 1; 0 where the whole is one formula.
        column: Column of the entry, from 1; 0 where the whole is a vector or one formula.
        role: What the formula is in its file.
        text: The formula as printed.
        verdict: Whether it is right; `NOTHING_KNOWN` where that cannot be decided.
        right: The derived formula.
        location: Where it stands.
        erratum: Whether the file marks it as wrong.
        question: What a search for the slip starts from; None where the formula is no single tree.
        repair: What repairs it, where that was found with the comparison.
        remark: What the file says about it.
        unknown: The name that the robot does not know, where the formula has one: nothing can be decided.
    """

    quantity: str
    row: int
    column: int
    role: Role
    text: str
    verdict: Verdict
    right: Expr
    location: Location
    erratum: bool = False
    question: Question | None = None
    repair: Repair | None = None
    remark: Remark = NO_REMARK
    unknown: UnknownNameError | None = None

    @property
    def entry(self) -> str:
        """The quantity with its place: ``B[1,2]``, ``A[1][2,4]``, ``g[3]``."""
        indices = ",".join(str(i) for i in (self.row, self.column) if i)
        bracket = "[]" if self.quantity == "T" else ""
        return f"{self.quantity}{bracket}[{indices}]" if indices else self.quantity


def verdict_at(where: Location, robot: Robot, right: Expression, printed: Expression) -> Verdict:
    """Whether a printed formula is right.

    Args:
        where: Where it stands.
        robot: Whose formula it is.
        right: The derived formula.
        printed: The printed one.

    Raises:
        CheckError: It has no value; placed where it stands.
    """
    try:
        return compare(robot, right, printed)
    except DeriveError as error:
        raise error.at(where) from None


def undecidable(
    quantity: str,
    place: tuple[int, int],
    role: Role,
    text: str,
    unknown: UnknownNameError,
    erratum: bool,
    remark: Remark = NO_REMARK,
) -> Finding:
    """A formula with an unknown name; it is placed at that name.

    Args:
        quantity: What it is printed for.
        place: Row and column of the entry, 0 where it has none.
        role: What the formula is in its file.
        text: The formula as printed.
        unknown: The name, with its place and the nearest known ones.
        erratum: Whether the file marks it as wrong.
        remark: What the file says about it.

    Returns:
        A finding without a verdict.
    """
    where = unknown.location or Location("")
    return Finding(quantity, *place, role, text, NOTHING_KNOWN, "", where, erratum, remark=remark, unknown=unknown)


@dataclass(frozen=True, slots=True)
class FileReport:
    """Everything that was compared in one file.

    Attributes:
        source: Name of the file.
        robot: Name of its robot.
        findings: One for each comparison, in the order of the file.
        unread: Blocks that were not compared.
        document: Where all this is printed.
    """

    source: str
    robot: str
    findings: tuple[Finding, ...]
    unread: tuple[str, ...] = ()
    document: Citation = NO_CITATION

    @property
    def wrong(self) -> tuple[Finding, ...]:
        """The comparisons that found a difference."""
        return tuple(f for f in self.findings if f.unknown is None and not f.verdict.equal)

    @property
    def undecidable(self) -> tuple[Finding, ...]:
        """The formulas about which nothing can be said, because of a name that the robot does not know."""
        return tuple(f for f in self.findings if f.unknown is not None)

    @property
    def equal(self) -> int:
        """How many formulas are right as printed."""
        return len(self.findings) - len(self.wrong) - len(self.undecidable)

    @property
    def passed(self) -> bool:
        """Whether everything is right as printed."""
        return not self.wrong and not self.undecidable

"""Comparisons of printed formulas with derived ones, as data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

from derive.check.diagnosis import Question, Repair
from derive.check.printed import NO_DOCUMENT, NO_REMARK, Document, Remark
from derive.errors import Location
from derive.mechanics.equality import Verdict

Expr = Any


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
        verdict: Whether it is right.
        right: The derived formula.
        location: Where it stands.
        erratum: Whether the file marks it as wrong.
        question: What a search for the slip starts from; None where the formula is no single tree.
        repair: What repairs it, where that was found with the comparison.
        remark: What the file says about it.
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

    @property
    def entry(self) -> str:
        """The quantity with its place: ``B[1,2]``, ``A[1][2,4]``, ``g[3]``."""
        indices = ",".join(str(i) for i in (self.row, self.column) if i)
        bracket = "[]" if self.quantity == "T" else ""
        return f"{self.quantity}{bracket}[{indices}]" if indices else self.quantity


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
    document: Document = NO_DOCUMENT

    @property
    def wrong(self) -> tuple[Finding, ...]:
        """The comparisons that found a difference."""
        return tuple(finding for finding in self.findings if not finding.verdict.equal)

    @property
    def passed(self) -> bool:
        """Whether everything is right as printed."""
        return not self.wrong

"""Printed formulas against derived ones, from Python: of a file, or one alone."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from derive.api.robots import RobotLike, load, with_remarks
from derive.checking.comparison import check_expression
from derive.checking.files import check_path
from derive.checking.findings import FileReport, Finding, judge
from derive.checking.report import Printout, difference_text, finding_lines, report_lines, right_text, what
from derive.handouts.notation.text import TextPrinter
from derive.model.model import Model
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class FormulaVerdict:
    """What is said about one printed formula; as text, what ``derive check`` prints.

    Attributes:
        quantity: What it is printed for, such as ``B[1,2]``.
        outcome: ``same form``, ``equal``, ``wrong``, or ``undecidable name`` where the robot does not know a name.
        printed: The formula as printed.
        right: The derived one in the notation of the robot.
        change: The smallest change that repairs it; empty where it is right or none was found.
        difference: Printed minus right; empty where it is right or has many terms.
        place: File, line and column of the formula.
        report: All this in words.
    """

    quantity: str
    outcome: str
    printed: str
    right: str
    change: str
    difference: str
    place: str
    report: str = field(repr=False)

    @property
    def equal(self) -> bool:
        """Whether it is right, whatever its form."""
        return self.outcome in ("same form", "equal")

    def __str__(self) -> str:
        return self.report


@dataclass(frozen=True, slots=True)
class CheckedFile:
    """What is said about a file of printed formulas; as text, what ``derive check`` prints.

    Attributes:
        file: Name of the file.
        robot: Name of its robot.
        verdicts: One for each formula, in the order of the file.
        passed: Whether everything is right as printed.
        report: What is wrong, in words, and how much is right.
    """

    file: str
    robot: str
    verdicts: tuple[FormulaVerdict, ...]
    passed: bool
    report: str = field(repr=False)

    def __str__(self) -> str:
        return self.report


def check(file: str | Path) -> CheckedFile:
    """Compare the formulas that a file prints with derived ones, as ``derive check FILE`` does.

    Args:
        file: A corpus file: a robot and a list of printed formulas.

    Returns:
        The verdict on each formula, decided exactly.

    Raises:
        RobotFileError: The file cannot be read.
        CheckError: A formula cannot be read.
    """
    checked = checked_file(file)
    report, printer = checked.report, checked.printer
    verdicts = tuple(_verdict(finding, checked) for finding in report.findings)
    text = "\n".join(report_lines(report, printer))
    return CheckedFile(report.source, report.robot, verdicts, report.passed, text)


def check_formula(robot: RobotLike, quantity: str, formula: str, *, latex: bool = False) -> FormulaVerdict:
    """Compare one formula with the derived one, as ``derive check ROBOT --quantity Q --expression E`` does.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        quantity: A scalar such as ``T[1,4]`` or ``B[2,2]``.
        formula: What is printed; the shorthand of notes such as c12 and qd1 is understood.
        latex: Whether the formula is LaTeX.

    Returns:
        The verdict, decided exactly.

    Raises:
        CheckError: The formula cannot be read.
        UnknownNameError: A name in it that the robot does not know.
        QuantityError: There is no such quantity, or it is no scalar.
    """
    chosen = load(robot)
    finding = formula_finding(chosen, quantity, formula, latex=latex)
    return _verdict(finding, printout(chosen, finding))


def checked_file(file: str | Path) -> Printout:
    """The comparisons of a file as they are reported.

    Args:
        file: A corpus file.

    Returns:
        The comparisons, and how derived formulas are printed.

    Raises:
        RobotFileError: The file cannot be read.
        CheckError: A formula cannot be read.
    """
    report, robot = check_path(str(file))
    with_remarks(robot)
    return Printout(report, TextPrinter(robot).doprint, robot.remarks)


def formula_finding(robot: Robot, quantity: str, formula: str, *, latex: bool = False) -> Finding:
    """The comparison of one formula; see `check_formula`.

    Args:
        robot: The robot.
        quantity: A scalar.
        formula: What is printed.
        latex: Whether the formula is LaTeX.

    Returns:
        The comparison.

    Raises:
        CheckError: The formula cannot be read.
    """
    return check_expression(Model(robot), quantity, formula, latex)


def printout(robot: Robot, finding: Finding) -> Printout:
    """One comparison as it is reported.

    Args:
        robot: The robot.
        finding: The comparison.

    Returns:
        The comparison as the only one of a report on the robot.
    """
    return Printout(FileReport(robot.name, robot.name, (finding,)), TextPrinter(robot).doprint)


def _verdict(finding: Finding, reported: Printout) -> FormulaVerdict:
    verdict, printer = judge(finding), reported.printer
    return FormulaVerdict(
        quantity=what(finding),
        outcome=verdict.outcome.value,
        printed=finding.text,
        right="" if finding.unknown else right_text(finding, printer),
        change=verdict.repair.text if verdict.repair else "",
        difference=difference_text(verdict, printer),
        place=str(finding.location),
        report="\n".join(finding_lines(finding, printer)),
    )

"""Printed formulas against derived ones, from Python: of a file, or one alone."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from derive.api.robots import RobotLike, load, tell
from derive.checking import report as reporting
from derive.checking.files import document_named, file_printout, formula_lines, formula_printout
from derive.checking.formulas.findings import Finding, judge
from derive.checking.report import Printout
from derive.errors import CheckError


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
    checked = file_printout(file)
    tell(checked.robot.remarks)
    return _checked(checked, reporting.report_lines(checked))


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
    reported = formula_printout(load(robot, remarks_on_bodies=False), quantity, formula, latex=latex)
    finding, *others = reported.report.findings
    if others:
        raise CheckError(f"{len(others) + 1} formulas", allowed="allowed: one", remedy="use derive.check_latex")
    return _verdict(finding, reported)


def check_latex(
    robot: RobotLike, latex: str | Path, quantity: str = "", *, lines: tuple[int, int] | None = None, section: str = ""
) -> CheckedFile:
    """Compare LaTeX with what follows from a robot's table, as ``derive check ROBOT --latex L`` does.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        latex: Equations, displays, matrices; or the path of a document (``.tex``, ``.md``, ``.ipynb``, ``.txt``), of
            which displays and mathematics inside a line are read.
        quantity: What they are printed for; may be left out where left sides such as ``T_3^0 =`` say it.
        lines: First and last line of a document to read; None for all.
        section: Words of the heading of the only section to read.

    Returns:
        The verdict on each formula and each entry of a matrix, decided exactly.

    Raises:
        CheckError: The LaTeX cannot be read, or its left side names another quantity.
        QuantityError: There is no such quantity.
    """
    formula = document_named(str(latex), lines, section) or str(latex)
    reported = formula_printout(load(robot, remarks_on_bodies=False), quantity, formula, latex=True)
    return _checked(reported, formula_lines(reported))


def check_inverse(robot: RobotLike, solution: str | Path, *, latex: bool = False, task: str = "") -> CheckedFile:
    """Compare a printed inverse solution with an arm, as ``derive check ROBOT --quantity inverse`` does.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        solution: Its lines, ``theta2 = atan2(+-sqrt(1 - D**2), D)``; of LaTeX also the path of a document.
        latex: Whether it is LaTeX.
        task: Rows of the task such as ``x,y,phi``; without it the names in the lines and the robot file say it.

    Returns:
        The verdict on each line that gives a joint variable or something of it, and on all branches.

    Raises:
        CheckError: The lines cannot be read, or need each other.
        QuantityError: An unknown row.
    """
    formula = (document_named(str(solution)) if latex else None) or str(solution)
    reported = formula_printout(load(robot, remarks_on_bodies=False), "inverse", formula, latex=latex, task=task)
    return _checked(reported, formula_lines(reported))


def _checked(reported: Printout, lines: Iterable[str]) -> CheckedFile:
    report = reported.report
    verdicts = tuple(_verdict(finding, reported) for finding in report.findings)
    return CheckedFile(report.source, report.robot, verdicts, report.passed, "\n".join(lines))


def _verdict(finding: Finding, reported: Printout) -> FormulaVerdict:
    verdict, printer = judge(finding), reported.exact
    return FormulaVerdict(
        quantity=reporting.what(finding),
        outcome=verdict.outcome.value,
        printed=finding.text,
        right="" if finding.unknown else reporting.right_text(finding, printer),
        change=verdict.repair.text if verdict.repair else "",
        difference=reporting.difference_text(verdict, printer),
        place=str(finding.location),
        report="\n".join(reporting.finding_lines(finding, reported)),
    )

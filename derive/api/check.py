"""Printed formulas against derived ones, from Python: of a file, or one alone."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from derive.api.robots import RobotLike, load, tell
from derive.checking import report as reporting
from derive.checking.comparison import check_expression, divided
from derive.checking.documents import KINDS, Manuscript, document_of, is_document, read_document
from derive.checking.files import check_path
from derive.checking.formulas.findings import FileReport, Finding, judge
from derive.checking.formulas.printed import Asked
from derive.checking.inverse.check import check_inverse as compare_inverse
from derive.checking.inverse.check import inverse_text, names_inverse
from derive.checking.inverse.reading import gives_joints
from derive.checking.latex.check import LatexReport
from derive.checking.latex.check import check_latex as compare_latex
from derive.checking.report import Printout
from derive.errors import CheckError, Location, quoted
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.text import TextPrinter, loses_digits
from derive.model.model import Model
from derive.robot.description import Remark
from derive.robot.load import is_there
from derive.robot.options.inverse import chosen_task
from derive.robot.robot import Robot
from derive.robot.rounding import DIGITS
from derive.robot.tree import require_chain


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
    tell(robot.remarks)
    return printout_of(report, robot, robot.remarks)


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


def formula_printout(
    robot: Robot, quantity: str, formula: str | Manuscript, *, latex: bool = False, task: str = ""
) -> Printout:
    """The comparison of what is given without a corpus file; see `check_formula` and `check_latex`.

    Args:
        robot: The robot.
        quantity: A scalar; of LaTeX a matrix too, or none.
        formula: What is printed, or the document that prints it.
        latex: Whether it is LaTeX.
        task: Rows of the task of a printed inverse solution.

    Returns:
        The comparisons as those of a file.

    Raises:
        CheckError: The formula cannot be read.
    """
    require_chain(robot, "a check of formulas")
    model, source = Model(robot), "--latex" if latex else "--expression"
    if isinstance(formula, Manuscript):
        report = _compared(model, formula, quantity, task, alone=True)
        return printout_of(_placed(report, formula, robot, formula.name), robot)
    if names_inverse(model, quantity) or (latex and not quantity and gives_joints(formula, robot)):
        asked = Asked(Location(source), _task(model, task))
        report = LatexReport(*compare_inverse(model, inverse_text(formula, asked, latex=latex)))
    elif latex:
        report = compare_latex(model, formula, quantity, Location(source))
    else:
        report, source = LatexReport((check_expression(model, quantity, formula),)), robot.name
    return printout_of(_placed(report, None, robot, source), robot)


def document_printouts(robots: Sequence[Robot], document: Manuscript) -> list[Printout]:
    """The comparison of a document about several robots: for each of them the formulas that are about it.

    Args:
        robots: The robots.
        document: What is printed.

    Returns:
        One list of comparisons for each robot, in the same order.

    Raises:
        CheckError: Two robots have the same name, or nothing in the document can be checked.
    """
    names, found = [robot.name for robot in robots], []
    if len(set(names)) < len(names):
        raise CheckError(f"two robots are called {quoted(max(names, key=names.count))}", remedy="change one name")
    refused = None
    for robot in robots:
        require_chain(robot, "a check of formulas")
        try:
            found.append((robot, _compared(Model(robot), document)))
        except CheckError as error:
            refused = error
    if refused is not None and not found:
        raise refused
    sections = [document.section_at(place) for place in found[0][1].equations]
    parts = divided([robot.name for robot, _ in found], [report for _, report in found], sections)
    return [
        printout_of(_placed(part, document, robot, f"{document.name} ({robot.name})"), robot)
        for (robot, _), part in zip(found, parts, strict=True)
    ]


def _compared(
    model: Model, document: Manuscript, quantity: str = "", task: str = "", *, alone: bool = False
) -> LatexReport:
    try:
        if names_inverse(model, quantity):
            asked = Asked(Location(document.name), _task(model, task))
            return LatexReport(*compare_inverse(model, inverse_text(document.text, asked, latex=True, document=True)))
        return compare_latex(model, document.text, quantity, Location(document.name), document=True, alone=alone)
    except CheckError as error:
        raise document.moved(error) from None


def _placed(report: LatexReport, document: Manuscript | None, robot: Robot, source: str) -> FileReport:
    """Comparisons as those of a file, at their places in the document if there is one."""
    placed, found = document.placed if document else lambda where: where, report.findings
    findings = tuple(replace(f, location=placed(f.location)) for f in found) if document else found
    unread = tuple(f"{placed(one.location)}: {one.reason}" for one in report.skipped)
    return FileReport(source, robot.name, findings, unread, readings=report.readings)


def _task(model: Model, task: str) -> tuple[str, ...] | None:
    return chosen_task(task.replace(",", " ").split(), model.n) if task else None


def printout_of(report: FileReport, robot: Robot, remarks: tuple[Remark, ...] = ()) -> Printout:
    """Comparisons with what writes derived formulas in the notation of their robot.

    Args:
        report: The comparisons.
        robot: The robot.
        remarks: What its file says and hardly means.

    Returns:
        What is reported.
    """
    notation = Notation.of(robot)
    printers = TextPrinter(robot, notation).doprint, TextPrinter(robot).doprint
    is_rounded = partial(loses_digits, decimals=notation.decimals, digits=DIGITS)
    return Printout(report, *printers, lambda right: is_rounded([right]), remarks)


def document_named(text: str, lines: tuple[int, int] | None = None, section: str = "") -> Manuscript | None:
    """The document that is meant, or the part of it; None where a text is a formula itself.

    Args:
        text: The path of a document, or what came from standard input.
        lines: First and last line to read; None for all.
        section: Words of the heading of the only section to read.

    Returns:
        The document.

    Raises:
        CheckError: It cannot be read, or has no such section.
    """
    document = None
    if "\n" not in text.strip() and not re.search(r"[\\{}=$]", text):
        looks_like_path = re.fullmatch(r"[\w./ ~-]+\.[A-Za-z]{3,5}", text) is not None
        is_path = looks_like_path or Path(text).suffix.lower() in KINDS or (len(text) < 4096 and is_there(Path(text)))
        document = read_document(text) if is_path else None
    elif is_document(text):
        document = document_of(text, "standard input")
    if document is None and (lines or section):
        raise CheckError("--lines and --section choose a part of a document", remedy="give a file")
    return document.within(lines, section) if document else None


def formula_lines(reported: Printout) -> list[str]:
    """The verdicts on what is given without a corpus file, right ones included; the count of several at the end.

    Args:
        reported: The comparisons.

    Returns:
        Lines without ends.
    """
    report = reported.report
    lines = [f"{report.source}: {reading}" for reading in report.readings]
    lines += reporting.all_lines(reported)
    lines += [f"{place}: not compared: {reason}" for place, reason in (note.split(": ", 1) for note in report.unread)]
    if len(report.findings) > 1 or report.unread:
        counts = reporting.summary(replace(report, unread=()))
        counts += f"; {len(report.unread)} not compared" if report.unread else ""
        lines.append(f"{report.source}: {counts}")
    return lines


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

"""What is checked, as it is reported: a corpus file, a formula, or a document about one or several robots."""

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from derive.checking import report as reporting
from derive.checking.comparison import check_expression, divided
from derive.checking.documents import KINDS, Manuscript, document_of, is_document, read_document
from derive.checking.files import check_path
from derive.checking.formulas.findings import FileReport
from derive.checking.formulas.printed import Asked
from derive.checking.inverse.check import check_inverse, inverse_text, names_inverse
from derive.checking.inverse.reading import gives_joints
from derive.checking.latex.check import LatexReport, check_latex
from derive.checking.report import Printout
from derive.errors import CheckError, Location, quoted
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import TextPrinter, loses_digits
from derive.model.model import Model
from derive.robot.description import Remark
from derive.robot.load import is_there
from derive.robot.options.inverse import chosen_task
from derive.robot.robot import Robot
from derive.robot.rounding import DIGITS


def file_printout(file: str | Path) -> Printout:
    """The comparisons of a corpus file."""
    report, robot = check_path(str(file))
    return printout_of(report, robot, robot.remarks)


def formula_printout(
    robot: Robot, quantity: str, formula: str | Manuscript, *, latex: bool = False, task: str = ""
) -> Printout:
    """The comparison of a formula or document with one robot; of LaTeX the quantity may be a matrix, or none."""
    model, source = Model(robot), "--latex" if latex else "--expression"
    robot = model.robot  # whose parallelograms are coupled joints
    if isinstance(formula, Manuscript):
        report = _compared(model, formula, quantity, task, alone=True)
        return printout_of(_placed(report, formula, robot, formula.name), robot)
    if names_inverse(model, quantity) or (latex and not (quantity or robot.is_tree) and gives_joints(formula, robot)):
        asked = Asked(Location(source), _task(model, task))
        report = LatexReport(*check_inverse(model, inverse_text(formula, asked, latex=latex)))
    elif latex:
        report = check_latex(model, formula, quantity, Location(source))
    else:
        report, source = LatexReport((check_expression(model, quantity, formula),)), robot.name
    return printout_of(_placed(report, None, robot, source), robot)


def document_printouts(robots: Sequence[Robot], document: Manuscript) -> list[Printout]:
    """The comparisons of a document about several robots: for each of them, in their order, the formulas about it."""
    names, found = [robot.name for robot in robots], []
    if len(set(names)) < len(names):
        raise CheckError(f"two robots are called {quoted(max(names, key=names.count))}", remedy="change one name")
    refused = None
    for robot in robots:
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
            return LatexReport(*check_inverse(model, inverse_text(document.text, asked, latex=True, document=True)))
        return check_latex(model, document.text, quantity, Location(document.name), document=True, alone=alone)
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
    """Comparisons with what writes derived formulas in the notation of their robot."""
    notation = Notation.of(robot)
    printers = TextPrinter(robot, notation).doprint, TextPrinter(robot).doprint
    is_rounded = partial(loses_digits, decimals=notation.decimals, digits=DIGITS)
    return Printout(report, *printers, lambda right: is_rounded([right]), remarks)


def document_named(text: str, lines: tuple[int, int] | None = None, section: str = "") -> Manuscript | None:
    """The document, or part of it, by its path or its text; None where a text is a formula itself."""
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
    """The verdicts on what is given without a corpus file, right ones included; the count of several at the end."""
    report = reported.report
    lines = [f"{report.source}: {reading}" for reading in report.readings]
    lines += reporting.all_lines(reported)
    lines += [f"{place}: not compared: {reason}" for place, reason in (note.split(": ", 1) for note in report.unread)]
    if len(report.findings) > 1 or report.unread:
        counts = reporting.summary(replace(report, unread=()))
        counts += f"; {len(report.unread)} not compared" if report.unread else ""
        lines.append(f"{report.source}: {counts}")
    return lines

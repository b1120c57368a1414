"""``derive check``: printed formulas against derived ones.

How ``derive check`` prints: a table for people at a terminal, plain lines otherwise.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from derive.cli.terminal import one_line
from derive.errors import CheckError, OutputError, UnknownNameError

if TYPE_CHECKING:
    from derive.check.errata import Printout
    from derive.check.findings import FileReport, Finding
    from derive.robot.robot import Robot


SUMMARY = "compare printed formulas with derived ones"
DESCRIPTION = """\
Read corpus files (a block `robot:` and a list `expected:` of printed quantities) and say for each printed entry whether
it has the same form as the derived one, is equal to it, or is wrong. Equality is decided exactly; what is wrong is
shown with the right expression, the smallest change that repairs it, and numbers at which the two differ. What a file
marks as an erratum is checked as printed, and its correction too. Printed products of frames (a list `items:`) and
Newton-Euler equations are read as well. Of an entry with a name that the robot does not know nothing can be said; the
other entries of its file are compared all the same.

One formula can be checked without a file, as plain text or as LaTeX:

  derive check scara-perugia --quantity 'T[1,4]' --expression 'a1*c1 + a2*c12'
  derive check scara-perugia --quantity 'T[1,4]' --latex 'a_1 c_1 + a_2 c_{12}'

Formulas may use the shorthand of lecture notes: c12 is cos(q1 + q2), qd1 and qdd1 are velocity and acceleration of q1.
Exit status 0 all equal, 1 something wrong, 2 a file or formula that cannot be read, an unknown name among them.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The files, or one formula, and the form of the output."""
    add = parser.add_argument
    add("files", metavar="FILE", nargs="+", help="corpus file: a robot and its printed formulas")
    add("--quantity", metavar="Q", help="a scalar of the one robot named instead of FILE, such as 'T[1,4]'")
    formula = parser.add_mutually_exclusive_group()
    formula.add_argument("--expression", metavar="E", help="the formula to compare it with")
    formula.add_argument("--latex", metavar="L", help="the formula in LaTeX, as lecture notes print it")
    add("--report", metavar="MD", help="write what is wrong as a Markdown page: document, place, printed, right, why")
    add("--json", action="store_true", help="machine-readable output")


def run(arguments: argparse.Namespace) -> int:
    """Check every file, or the one formula."""
    formulas = [text for text in (arguments.expression, arguments.latex) if text is not None]
    if arguments.quantity is None and not formulas:
        return _files(arguments)
    if arguments.quantity is None or not formulas or len(arguments.files) != 1:
        raise CheckError(
            "--quantity and --expression or --latex belong together, with one robot",
            remedy="write: derive check ROBOT --quantity 'T[1,4]' --expression '...'",
        )
    return _formula(arguments)


def _files(arguments: argparse.Namespace) -> int:
    from derive.check.files import check_path
    from derive.check.report import as_dict
    from derive.cli.terminal import print_json

    checked = [_printout(*check_path(path)) for path in arguments.files]
    _write_report(arguments.report, checked)
    if arguments.json:
        print_json([as_dict(printout.report, printout.printer) for printout in checked])
    else:
        print_reports(checked)
    if any(printout.report.undecidable for printout in checked):
        return 2
    return 0 if all(printout.report.passed for printout in checked) else 1


def _formula(arguments: argparse.Namespace) -> int:
    from derive.check.findings import FileReport
    from derive.check.report import finding_dict
    from derive.cli.terminal import print_json
    from derive.robot.robot import Robot

    robot = Robot.load(arguments.files[0])
    finding = _finding(arguments, robot)
    printout = _printout(FileReport(robot.name, robot.name, (finding,)), robot)
    _write_report(arguments.report, [printout])
    if arguments.json:
        print_json(finding_dict(finding, printout.printer))
    else:
        print_finding(finding, printout)
    return 0 if finding.verdict.equal else 1


def _finding(arguments: argparse.Namespace, robot: Robot) -> Finding:
    """The comparison; an unknown name is a verdict too where a program reads it."""
    from derive.check.comparison import check_expression
    from derive.check.verdicts import Outcome
    from derive.cli.terminal import print_json
    from derive.model.model import Model

    latex = arguments.latex is not None
    text = arguments.latex if latex else arguments.expression
    try:
        return check_expression(Model(robot), arguments.quantity, text, latex)
    except UnknownNameError as error:
        if arguments.json:
            verdict = Outcome.UNDECIDABLE.value
            print_json({"quantity": arguments.quantity, "printed": text, "verdict": verdict, "reason": str(error)})
        raise


def _printout(report: FileReport, robot: Robot) -> Printout:
    from derive.check.errata import Printout
    from derive.handout.notation.text import TextPrinter

    return Printout(report, TextPrinter(robot).doprint)


def _write_report(path: str | None, printouts: list[Printout]) -> None:
    if path is None:
        return
    from derive.check.errata import errata_report

    try:
        Path(path).write_text(errata_report(printouts), encoding="utf-8")
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise OutputError(f"report {path!r} cannot be written: {reason}", remedy="choose another place") from None


LONGEST_CELL = 160


def print_reports(printouts: Sequence[Printout]) -> None:
    """What is wrong in some files, and how much is right."""
    from derive.check.report import report_lines

    if sys.stdout.isatty():
        for printout in printouts:
            _print_table(printout)
        return
    lines = (line for p in printouts for line in report_lines(p.report, p.printer))
    print("\n".join(one_line(line) for line in lines))


def _print_table(printout: Printout) -> None:
    from rich.console import Console
    from rich.table import Table

    from derive.check.report import summary

    report, console = printout.report, Console()
    if report.wrong or report.undecidable:
        table = Table("place", "formula", "printed", "right", "change", show_lines=True)
        for row in _rows(printout):
            table.add_row(*(_cell(text) for text in row))
        console.print(table)
    console.print(one_line(f"{report.source}: {summary(report)}"), markup=False, highlight=False, soft_wrap=True)


def _rows(printout: Printout) -> Iterator[tuple[str, ...]]:
    from derive.check.report import difference_text, right_text, unknown_name, what
    from derive.check.verdicts import judge

    for finding in printout.report.wrong:
        verdict = judge(finding)
        change = verdict.repair.text if verdict.repair else _difference(difference_text(verdict, printout.printer))
        place = f"{finding.location.line}:{finding.location.column}"
        yield place, what(finding), finding.text, right_text(finding, printout.printer), change
    for finding in printout.report.undecidable:
        place = f"{finding.location.line}:{finding.location.column}"
        yield place, what(finding), finding.text, judge(finding).outcome, unknown_name(finding)


def _difference(text: str) -> str:
    return f"printed - right: {text}" if text else ""


def _cell(text: str) -> str:
    from rich.markup import escape

    shown = one_line(text)
    return escape(shown if len(shown) <= LONGEST_CELL else f"{shown[: LONGEST_CELL - 3]}...")


def print_finding(finding: Finding, printout: Printout) -> None:
    """The verdict on one formula."""
    from derive.check.report import finding_lines

    print("\n".join(one_line(line) for line in finding_lines(finding, printout.printer)))

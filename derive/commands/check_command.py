"""``derive check``: printed formulas against derived ones."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

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
    from derive.commands.check_output import print_reports
    from derive.commands.terminal import print_json

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
    from derive.commands.check_output import print_finding
    from derive.commands.terminal import print_json
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
    from derive.commands.terminal import print_json
    from derive.mechanics.model import Model

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
    from derive.emit.text_printer import TextPrinter

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

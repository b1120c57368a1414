"""``derive check``: printed formulas against derived ones."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from derive.errors import CheckError

if TYPE_CHECKING:
    from derive.robot.robot import Robot

SUMMARY = "compare printed formulas with derived ones"
DESCRIPTION = """\
Read corpus files (a block `robot:` and a list `expected:` of printed quantities) and say for each printed entry whether
it equals the derived one. Equality is decided exactly; what is wrong is shown with the right expression and a
numeric counter-example. What a file marks as an erratum is checked as printed, and its correction too.

One formula can be checked without a file:

  derive check scara-perugia --quantity 'T[1,4]' --expression 'a1*c1 + a2*c12'

Formulas may use the shorthand of lecture notes: c12 is cos(q1 + q2), qd1 and qdd1 are velocity and acceleration of q1.
Exit status 1 if anything is wrong.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The files, or one formula, and the form of the output."""
    add = parser.add_argument
    add("files", metavar="FILE", nargs="+", help="corpus file: a robot and its printed formulas")
    add("--quantity", metavar="Q", help="a scalar of the one robot named instead of FILE, such as 'T[1,4]'")
    add("--expression", metavar="E", help="the formula to compare it with")
    add("--json", action="store_true", help="machine-readable output")


def run(arguments: argparse.Namespace) -> int:
    """Check every file, or the one formula."""
    if arguments.quantity is None and arguments.expression is None:
        return _files(arguments.files, arguments.json)
    if arguments.quantity is None or arguments.expression is None or len(arguments.files) != 1:
        raise CheckError(
            "--quantity and --expression belong together, with one robot",
            remedy="write: derive check ROBOT --quantity 'T[1,4]' --expression '...'",
        )
    return _formula(arguments)


def _files(paths: list[str], as_json: bool) -> int:
    from derive.check.comparison import check_file
    from derive.check.corpus_file import read_corpus_file
    from derive.check.report import as_dict, report_lines
    from derive.commands.terminal import one_line, print_json

    checked = [(check_file(file), _printer(file.robot)) for file in map(read_corpus_file, paths)]
    if as_json:
        print_json([as_dict(report, printer) for report, printer in checked])
    else:
        print("\n".join(one_line(line) for report, printer in checked for line in report_lines(report, printer)))
    return 0 if all(report.passed for report, _ in checked) else 1


def _formula(arguments: argparse.Namespace) -> int:
    from derive.check.comparison import check_expression
    from derive.check.report import finding_dict, finding_lines
    from derive.commands.terminal import one_line, print_json
    from derive.mechanics.model import Model
    from derive.robot.robot import Robot

    robot = Robot.load(arguments.files[0])
    finding = check_expression(Model(robot), arguments.quantity, arguments.expression)
    if arguments.json:
        print_json(finding_dict(finding, _printer(robot)))
    elif finding.verdict.equal:
        print(one_line(f"{finding.entry}: equal" + ("" if finding.verdict.exact else ", at random points")))
    else:
        print("\n".join(one_line(line) for line in finding_lines(finding, _printer(robot))))
    return 0 if finding.verdict.equal else 1


def _printer(robot: Robot) -> Callable[[Any], str]:
    from derive.emit.text_printer import TextPrinter

    printer: Callable[[Any], str] = TextPrinter(robot).doprint
    return printer

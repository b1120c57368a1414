"""``derive check``: printed formulas against derived ones; a table for people at a terminal, plain lines otherwise."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from derive.cli.terminal import STDOUT, add_shared, line_range, one_line, print_error, print_json
from derive.errors import CheckError, UnknownNameError

if TYPE_CHECKING:
    from derive.checking.report import Printout

DESCRIPTION = """\
Read corpus files (a block `robot:` and a list `expected:` of printed quantities) and say for each printed entry whether
it has the same form as the derived one, is equal to it, or is wrong. Equality is decided exactly; what is wrong is
shown with the right expression, the smallest change that repairs it, and numbers at which the two differ. A known
erratum is checked as printed, and so is its correction. Printed products of frames (a list `items:`) and Newton-Euler
equations are read as well. Entries with unknown names are skipped
(exit status 2); the rest is checked.

One formula can be checked without a file, as plain text or as LaTeX. LaTeX may hold several equations and matrices,
each entry with its own verdict; --quantity is not needed where the left sides name the quantity. Of a
document (.tex, .md, .ipynb, .txt, or - for standard input) displays and mathematics inside a line are read, and the
author's macros; what is not understood is listed as not compared. How transforms are written is decided by all of them.
A document about several robots is checked with all of them: derive check ONE TWO --latex notes.md.

A printed inverse kinematics is checked as a whole with --quantity inverse: its lines as text separated by semicolons,
or as LaTeX. The verdict says whether all branches are given, some, or which line is wrong and what repairs it.

Formulas may use the shorthand of lecture notes: c12 is cos(q1 + q2), qd1 and qdd1 are velocity and acceleration of q1.
Exit status: 0 all equal, 1 something is wrong, 2 a file, formula or name cannot be read, 3 nothing is wrong, but not
everything in a document could be compared.

  derive check notes.yaml
  derive check scara-perugia --quantity 'T[1,4]' --expression 'a1*c1 + a2*c12'
  derive check scara-perugia --quantity 'T[1,4]' --latex 'a_1 c_1 + a_2 c_{12}'
  derive check scara-perugia --latex 'x = a_1 c_1 + a_2 c_{12} \\\\ y = a_1 s_1 + a_2 s_{12}'
  derive check scara-perugia --latex homework.tex
  derive check planar-2r-perugia --quantity inverse --expression 'D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2);
    theta2 = atan2(+-sqrt(1 - D**2), D); theta1 = atan2(y, x) - atan2(a2*s2, a1 + a2*c2)'
"""

UNREAD = 3  # exit status where nothing is wrong and something was not compared
LONGEST_CELL = 160  # characters of a formula in the table; longer ones are cut


def configure(parser: argparse.ArgumentParser) -> None:
    """The files, or one formula, and the form of the output."""
    add = parser.add_argument
    files = "corpus file: a robot and its printed formulas; none for the table that the document of --latex prints"
    add("files", metavar="FILE", nargs="*", help=files)
    quantity = "a quantity of the one robot named instead of FILE, such as 'T[1,4]'; a scalar for E"
    add("--quantity", metavar="QUANTITY", help=quantity)
    formula = parser.add_mutually_exclusive_group()
    formula.add_argument("--expression", metavar="E", help="the formula to compare it with")
    latex = "LaTeX: a formula or equations; or a .tex, .md, .ipynb or .txt file; or -"
    formula.add_argument("--latex", metavar="L", help=latex)
    add("--lines", metavar="A-B", type=line_range, help="read only these lines of the document")
    add("--section", metavar="TITLE", default="", help="read only the section with these words in its heading")
    add("--allow-unread", action="store_true", help="exit status 0 even if some formulas are not compared")
    add_shared(parser, "task", help="task of a printed inverse solution: pose, position, or rows such as x,y,phi")
    report = "write what is wrong as a Markdown page, - prints it; FILE.html: all verdicts on LaTeX as a web page"
    add_shared(parser, "out", type=Path, help=report)
    add_shared(parser, "force", "quiet", "json")


def run(arguments: argparse.Namespace) -> int:
    """Check every file, or the one formula."""
    if arguments.out == STDOUT and arguments.json:
        raise CheckError(f"--json with -o {STDOUT}", remedy="name a file with -o")
    if arguments.out is not None and arguments.out.suffix == ".html" and arguments.latex is None:
        raise CheckError("a web page of formulas that are no LaTeX", remedy="give --latex, or name a .md file")
    if arguments.out not in (None, STDOUT):
        from derive.publish.atomic_folder import refuse_taken

        refuse_taken([arguments.out], force=arguments.force)
    formulas = [text for text in (arguments.expression, arguments.latex) if text is not None]
    if not arguments.files and arguments.latex is None:
        raise CheckError("no file", remedy="name a corpus file, or a robot and a formula: derive check --help")
    if arguments.quantity is None and not formulas:
        from derive.api.robots import tell
        from derive.checking.files import file_printout
        from derive.checking.report import as_dict, report_lines

        checked = []
        for path in arguments.files:
            checked.append(file_printout(path))
            tell(checked[-1].robot.remarks)
        written = (as_dict(x) | {"remarks": x.robot.remarks_as_dicts} for x in checked)
        status = _told(arguments, checked, lambda: list(written), None if sys.stdout.isatty() else report_lines)
        return 0 if status == UNREAD else status  # a file of its own kind may have blocks that are not compared
    is_named, is_latex = arguments.quantity is not None, arguments.latex is not None
    if not formulas or not (is_named or is_latex) or (len(arguments.files) > 1 and (is_named or not is_latex)):
        remedy = "write: derive check ROBOT --quantity 'T[1,4]' --expression '...'"
        raise CheckError("--quantity and --expression or --latex belong together, with one robot", remedy=remedy)
    return _formula(arguments, formulas[0])


def _formula(arguments: argparse.Namespace, text: str) -> int:
    """What is given without a file, of each robot of a document; an unknown name is a verdict where a program reads."""
    from derive.api.robots import Robot, load
    from derive.checking.files import document_named, document_printouts, formula_lines, formula_printout
    from derive.checking.formulas.findings import Outcome
    from derive.checking.report import as_dict, finding_dict

    quantity, latex, where = arguments.quantity or "", arguments.latex is not None, None
    if text == "-" and (latex or quantity == "inverse"):
        text = sys.stdin.read()
    formula = document_named(text, arguments.lines, arguments.section) if latex else None
    if len(arguments.files) > 1:
        if formula is None:
            raise CheckError("several robots for one formula", remedy="give a document with --latex, or name one robot")
        robots = [load(path, remarks_on_bodies=False) for path in arguments.files]
        printouts = document_printouts(robots, formula)
        return _told(arguments, printouts, lambda: list(map(as_dict, printouts)), formula_lines)
    if arguments.files:
        robot = load(arguments.files[0], remarks_on_bodies=False)
    elif formula is None:
        raise CheckError("no robot for a formula", remedy="name a robot before --latex")
    else:
        from derive.checking.table import robot_of_table

        table, where = robot_of_table(formula, "table")
        robot = Robot.from_text(table)
    try:
        reported = formula_printout(robot, quantity, formula or text, latex=latex, task=arguments.task or "")
    except UnknownNameError as error:
        if not arguments.json:
            raise
        print_json({"quantity": quantity, "printed": text, "verdict": Outcome.UNDECIDABLE.value, "reason": str(error)})
        print_error(error)
        return error.exit_status
    if where is not None:
        said = (f"the robot is that of the table at {where}", *reported.report.readings)
        reported = replace(reported, report=replace(reported.report, readings=said))
    findings, unread = reported.report.findings, reported.report.unread
    is_single = len(findings) == 1 and not unread
    data = partial(finding_dict, findings[0], reported.exact) if is_single else partial(as_dict, reported)
    return _told(arguments, [reported], data, formula_lines)


def _told(
    arguments: argparse.Namespace,
    printouts: Sequence[Printout],
    data: Callable[[], Any],
    lines_of: Callable[[Printout], list[str]] | None,
) -> int:
    """Write the page where it is asked for, print data or lines (None for a table), and tell the exit status."""
    from derive.checking.report import errata_report

    if arguments.out == STDOUT:
        print(errata_report(printouts), end="")
    elif arguments.out is not None:
        from derive.checking.page import verdict_page
        from derive.publish.atomic_folder import write_files

        page = (verdict_page if arguments.out.suffix == ".html" else errata_report)(printouts)
        write_files({arguments.out: page.encode()}, force=arguments.force)
    if arguments.json:
        print_json(data())
    elif lines_of is not None and not arguments.quiet and arguments.out != STDOUT:
        print("\n".join(one_line(line) for printout in printouts for line in lines_of(printout)))
    elif not arguments.quiet and arguments.out != STDOUT:
        for printout in printouts:
            _print_table(printout)
    if any(printout.report.undecidable for printout in printouts):
        return 2
    if not all(printout.report.passed for printout in printouts):
        return 1
    return UNREAD if any(printout.report.unread for printout in printouts) and not arguments.allow_unread else 0


def _print_table(printout: Printout) -> None:
    """What is wrong in a file, then what is undecidable, one row each, and the count."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from derive.checking.formulas.findings import judge
    from derive.checking.report import difference_text, right_text, summary, unknown_name, what

    report, console = printout.report, Console()
    table = Table("place", "formula", "printed", "right", "change", show_lines=True)
    for finding in (*report.wrong, *report.undecidable):
        verdict = judge(finding)
        right, change = str(verdict.outcome), unknown_name(finding)
        if finding.unknown is None:
            right, difference = right_text(finding, printout.printer), difference_text(verdict, printout.printer)
            change = f"printed - right: {difference}" if difference else ""
            change = verdict.repair.text if verdict.repair else change or "; ".join(f"no {m}" for m in finding.missing)
        place = f"{finding.location.line}:{finding.location.column}"
        cells = map(one_line, (place, what(finding), finding.text, right, change))
        table.add_row(*(escape(t if len(t) <= LONGEST_CELL else f"{t[: LONGEST_CELL - 3]}...") for t in cells))
    if table.row_count:
        console.print(table)
    console.print(one_line(f"{report.source}: {summary(report)}"), markup=False, highlight=False, soft_wrap=True)

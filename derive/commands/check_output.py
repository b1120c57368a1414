"""How ``derive check`` prints: a table for people at a terminal, plain lines otherwise."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from derive.commands.terminal import one_line

if TYPE_CHECKING:
    from derive.check.errata import Printout
    from derive.check.findings import Finding

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

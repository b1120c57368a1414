"""Comparisons as text and as plain data."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from derive.check.comparison import FileReport, Finding, Role
from derive.mechanics.points import CounterExample

Printer = Callable[[Any], str]
"""Writes a derived formula in the notation of the file's robot."""

LONGEST = 400
"""Characters of a formula in a report; longer ones are cut."""


def report_lines(report: FileReport, printer: Printer) -> list[str]:
    """The report of one file: what is wrong, each with the right formula and a counter-example, then the count.

    Args:
        report: The comparisons.
        printer: Writes derived formulas.
    """
    corrections = {f.entry: f for f in report.findings if f.role is Role.CORRECTION and f.verdict.equal}
    lines: list[str] = []
    for finding in report.wrong:
        lines += finding_lines(finding, printer)
        if finding.erratum and finding.entry in corrections:
            lines.append(f"  its correction is right: {_cut(corrections[finding.entry].text)}")
    lines.append(f"{report.source}: {summary(report)}")
    return lines


def summary(report: FileReport) -> str:
    """``173 formulas equal, 6 wrong``, with what was compared at points only or not at all."""
    total, wrong = len(report.findings), len(report.wrong)
    known = sum(finding.erratum for finding in report.wrong)
    numeric = sum(not finding.verdict.exact for finding in report.findings)
    text = f"{total - wrong} equal, {wrong} wrong"
    text += f" ({known} marked as errata)" if known else ""
    text += f"; {numeric} compared at random points only" if numeric else ""
    return text + (f"; not compared: {', '.join(report.unread)}" if report.unread else "")


def finding_lines(finding: Finding, printer: Printer) -> Iterator[str]:
    """A wrong formula: where, what, the right one, and numbers that show it."""
    yield f"{finding.location}: {_what(finding)} is wrong: {_cut(finding.text)}"
    yield f"  right: {_cut(_right(finding, printer))}"
    if finding.verdict.counter_example is not None:
        yield f"  {_numbers(finding.verdict.counter_example)}"


def as_dict(report: FileReport, printer: Printer) -> dict[str, Any]:
    """The report of one file as plain data."""
    return {
        "file": report.source,
        "robot": report.robot,
        "equal": len(report.findings) - len(report.wrong),
        "wrong": len(report.wrong),
        "not_compared": list(report.unread),
        "entries": [finding_dict(finding, printer) for finding in report.findings],
    }


def finding_dict(finding: Finding, printer: Printer) -> dict[str, Any]:
    """One comparison as plain data; the derived formula and the numbers only where the printed one is wrong."""
    entry: dict[str, Any] = {
        "quantity": finding.entry,
        "role": finding.role.value,
        "printed": finding.text,
        "equal": finding.verdict.equal,
        "exact": finding.verdict.exact,
        "erratum": finding.erratum,
        "line": finding.location.line,
        "column": finding.location.column,
    }
    if finding.verdict.equal:
        return entry
    entry["right"] = _right(finding, printer)
    example = finding.verdict.counter_example
    if example is not None:
        values = {name: float(value) for name, value in example.values}
        entry["counter_example"] = {"values": values, "printed": example.printed, "right": example.right}
    return entry


def _what(finding: Finding) -> str:
    match finding.role:
        case Role.CORRECTION:
            return f"correction of {finding.entry}"
        case Role.ABBREVIATED:
            return f"abbreviated {finding.entry}"
        case Role.IDENTITY:
            return f"identity for {_cut(finding.quantity)}"
        case Role.REST:
            return f"{finding.entry} of the rest"
        case _:
            return finding.entry + (" (marked as an erratum)" if finding.erratum else "")


def _right(finding: Finding, printer: Printer) -> str:
    return finding.right if isinstance(finding.right, str) else printer(finding.right)


def _numbers(example: CounterExample) -> str:
    values = ", ".join(f"{name} = {float(value):g}" for name, value in example.values)
    compared = f"printed {example.printed:.6g}, right {example.right:.6g}"
    return f"at {values}: {compared}" if values else compared


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."

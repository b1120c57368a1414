"""A report on wrong formulas that a teacher can send to a colleague: document, place, printed, right, why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from derive.checking.findings import FileReport, Finding, Role
from derive.checking.printed import Citation
from derive.checking.report import (
    Printer,
    cut,
    difference_text,
    numbers,
    repaired_text,
    right_corrections,
    right_text,
    unknown_name,
    what,
)
from derive.checking.verdicts import judge

TITLE = "# Errata"
LONGEST = 600
"""Characters of a formula in the report; longer ones are cut."""


@dataclass(frozen=True)
class Printout:
    """One checked file.

    Attributes:
        report: Its comparisons.
        printer: Writes derived formulas in the notation of its robot.
    """

    report: FileReport
    printer: Printer


@dataclass(frozen=True)
class Item:
    """Wrong entries of one printed item.

    Attributes:
        findings: The entries.
        printout: The file.
        document: Where they are printed.
    """

    findings: tuple[Finding, ...]
    printout: Printout
    document: Citation


def errata_items(printouts: Sequence[Printout]) -> tuple[Item, ...]:
    """What is wrong, item by item, in the order of documents; what another file counts already is left out.

    Args:
        printouts: The checked files.
    """
    found = []
    for printout in printouts:
        report = printout.report
        wrong = [f for f in report.wrong if f.role is not Role.CORRECTION]
        for _, group in groupby(wrong, key=lambda f: (f.remark, f.quantity)):
            findings = tuple(group)
            said, whole = findings[0].remark, report.document
            title, section = said.document.title or whole.title or report.source, said.document.section or whole.section
            if not said.duplicate or said.kind == "convention":
                found.append(Item(findings, printout, Citation(title, section)))
    return tuple(sorted(found, key=lambda item: item.document.title))


def errata_report(printouts: Sequence[Printout], titles: Mapping[str, str] | None = None, head: str = "") -> str:
    """The report as Markdown.

    Args:
        printouts: The checked files.
        titles: Names to be shown for documents.
        head: A paragraph under the title.

    Returns:
        A page with one section for each document and one entry for each printed item.
    """
    items = errata_items(printouts)
    errors = [item for item in items if item.findings[0].remark.kind != "convention"]
    conventions = [item for item in items if item.findings[0].remark.kind == "convention"]
    lines = [TITLE, ""]
    lines += [head, ""] if head else []
    lines += [_count(errors, printouts), ""]
    for title, group in groupby(errors, key=lambda item: item.document.title):
        lines += [f"## {_plain((titles or {}).get(title, title) or 'Formulas')}", ""]
        for item in group:
            lines += [*_lines(item), ""]
    if conventions:
        lines += ["## Other conventions, not errors", ""]
        lines += [line for item in conventions for line in (*_lines(item), "")]
    undecidable = [f for printout in printouts for f in printout.report.undecidable]
    lines += ["## Undecidable: unknown names", ""] if undecidable else []
    for f in undecidable:
        name = _plain(unknown_name(f))
        lines.append(f"- {_code(str(f.location))}: {_plain(what(f))}, printed {_code(f.text)}: {name}")
    return "\n".join(lines).rstrip() + "\n"


def _count(errors: Sequence[Item], printouts: Sequence[Printout]) -> str:
    decided = [f for p in printouts for f in p.report.findings if f.unknown is None]
    total = sum(f.role is not Role.CORRECTION for f in decided)
    undecidable = sum(len(p.report.undecidable) for p in printouts)
    entries = sum(len(item.findings) for item in errors)
    found = sum(judge(item.findings[0]).repair is not None for item in errors)
    places = f"{len(errors)} {'place' if len(errors) == 1 else 'places'}"
    rest = f" Of {undecidable} more nothing can be said: names that the robot does not know." if undecidable else ""
    return (
        f"{total} formulas compared: {entries} wrong, at {places}; the smallest change that repairs the formula is "
        f"named for {found} of them.{rest}"
    )


def _lines(item: Item) -> Iterator[str]:
    """The section about one printed item."""
    yield f"### {', '.join(_code(finding.entry) for finding in item.findings)}"
    yield ""
    if item.document.section:
        yield f"- place: {_plain(item.document.section)}"
    printer, corrections = item.printout.printer, right_corrections(item.printout.report)
    several = len(item.findings) > 1
    for finding in item.findings:
        verdict, example = judge(finding), finding.verdict.counter_example
        correction = corrections.get(finding.entry)
        # in the document's own style where that is known: its correction, or the printed formula repaired
        own_style = correction.text if correction else repaired_text(finding)
        lines = [f"- printed: {_code(finding.text)}", f"- right: {_code(own_style or right_text(finding, printer))}"]
        if verdict.repair is not None:
            lines.append(f"- change: {_code(verdict.repair.text)}")
        elif terms := difference_text(verdict, printer):
            lines.append(f"- printed minus right: {_code(terms)}")
        if example is not None and example.values:
            lines.append(f"- numbers: {_plain(numbers(example))}")
        yield from [f"- {_code(finding.entry)}", *(f"  {line}" for line in lines)] if several else lines
    if note := item.findings[0].remark.note:
        yield f"- why: {_plain(note)}"


def _code(text: str) -> str:
    """A formula between backticks, on one line."""
    shown = " ".join(text.split()).replace("`", "'")
    return f"`{cut(shown, LONGEST)}`"


def _plain(text: str) -> str:
    """Text whose signs Markdown leaves alone."""
    one_line = " ".join(text.split())
    return "".join(f"\\{c}" if c in "\\`*_[]<>#|" else c for c in one_line if c.isprintable())

"""A report on wrong formulas that a teacher can send to a colleague: document, place, printed, right, why."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from derive.check.findings import FileReport, Finding, Role
from derive.check.printed import Document
from derive.check.report import (
    Printer,
    difference_text,
    numbers,
    repaired_text,
    right_corrections,
    right_text,
    unknown_name,
    what,
)
from derive.check.verdicts import judge

TITLE = "# Errata"
LONGEST = 600


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
    document: Document


def errata_items(printouts: Sequence[Printout]) -> tuple[Item, ...]:
    """What is wrong, item by item, in the order of documents; what another file counts already is left out."""
    found = [item for printout in printouts for item in _items(printout)]
    return tuple(sorted(found, key=lambda item: item.document.title))


def errata_report(printouts: Sequence[Printout], titles: Mapping[str, str] | None = None, head: str = "") -> str:
    """The report as Markdown.

    Args:
        printouts: The checked files.
        titles: Names to be shown for documents.
        head: A paragraph under the title.
    """
    items = errata_items(printouts)
    errors = [item for item in items if _kind(item) != "convention"]
    conventions = [item for item in items if _kind(item) == "convention"]
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
    lines += _undecidable(printouts)
    return "\n".join(lines).rstrip() + "\n"


def _items(printout: Printout) -> Iterator[Item]:
    report = printout.report
    wrong = [f for f in report.wrong if f.role is not Role.CORRECTION]
    for _, group in groupby(wrong, key=lambda f: (id(f.remark), f.quantity)):
        findings = tuple(group)
        own, whole = findings[0].remark.document, report.document
        document = Document(own.title or whole.title or report.source, own.section or whole.section)
        if not (findings[0].remark.duplicate and _is_error(findings[0])):
            yield Item(findings, printout, document)


def _undecidable(printouts: Sequence[Printout]) -> list[str]:
    """The formulas about which nothing can be said, each with its place in the file."""
    found = [f for printout in printouts for f in printout.report.undecidable]
    lines = [
        f"- {_code(str(f.location))}: {_plain(what(f))}, printed {_code(f.text)}: {_plain(unknown_name(f))}"
        for f in found
    ]
    return ["## Undecidable: unknown names", "", *lines] if found else []


def _is_error(finding: Finding) -> bool:
    return finding.remark.kind != "convention"


def _kind(item: Item) -> str:
    return item.findings[0].remark.kind


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
    yield f"### {', '.join(_code(finding.entry) for finding in item.findings)}"
    yield ""
    if item.document.section:
        yield f"- place: {_plain(item.document.section)}"
    corrections = right_corrections(item.printout.report)
    several = len(item.findings) > 1
    for finding in item.findings:
        if several:
            yield f"- {_code(finding.entry)}"
        for line in _entry_lines(finding, item.printout, corrections):
            yield f"  {line}" if several else line
    if note := item.findings[0].remark.note:
        yield f"- why: {_plain(note)}"


def _entry_lines(finding: Finding, printout: Printout, corrections: Mapping[str, Finding]) -> Iterator[str]:
    verdict, example = judge(finding), finding.verdict.counter_example
    yield f"- printed: {_code(finding.text)}"
    yield f"- right: {_code(_right(finding, printout, corrections))}"
    if verdict.repair is not None:
        yield f"- change: {_code(verdict.repair.text)}"
    elif terms := difference_text(verdict, printout.printer):
        yield f"- printed minus right: {_code(terms)}"
    if example is not None and example.values:
        yield f"- numbers: {_plain(numbers(example))}"


def _right(finding: Finding, printout: Printout, corrections: Mapping[str, Finding]) -> str:
    """In the document's own style where that is known: its correction, or the printed formula repaired."""
    correction = corrections.get(finding.entry)
    if correction is not None:
        return correction.text
    return repaired_text(finding) or right_text(finding, printout.printer)


def _code(text: str) -> str:
    """A formula between backticks, on one line."""
    shown = " ".join(text.split()).replace("`", "'")
    return f"`{shown if len(shown) <= LONGEST else shown[: LONGEST - 3] + '...'}`"


def _plain(text: str) -> str:
    """Text whose signs Markdown leaves alone."""
    one_line = " ".join(text.split())
    return "".join(f"\\{c}" if c in "\\`*_[]<>#|" else c for c in one_line if c.isprintable())

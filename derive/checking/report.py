"""Verdicts as lines of text, as plain data, and as a page on wrong formulas that a teacher can send to a colleague."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from math import isnan
from typing import Any

from derive.checking.formulas.findings import FileReport, Finding, Judgement, Outcome, Role, judge
from derive.checking.formulas.printed import Citation
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import TextPrinter, loses_digits
from derive.lecture.shorthand import notation_text
from derive.model.equality import CounterExample
from derive.robot.robot import Robot
from derive.robot.rounding import DIGITS

Printer = Callable[[Any], str]  # writes a derived formula in the notation of the file's robot
LONGEST = 400  # characters of a formula in a report; longer ones are cut
LONGEST_ON_PAGE = 600  # characters of a formula on the page; longer ones are cut
MAX_SHOWN_TERMS = 6  # terms of a difference that are shown; a longer one says little


@dataclass(frozen=True)
class Printout:
    """One checked file."""

    report: FileReport  # its comparisons
    robot: Robot

    @cached_property
    def notation(self) -> Notation:
        """That of the robot."""
        return Notation.of(self.robot)

    @cached_property
    def printer(self) -> Printer:
        """Writes derived formulas for people: numbers with few digits."""
        found: Printer = TextPrinter(self.robot, self.notation).doprint
        return found

    @cached_property
    def exact(self) -> Printer:
        """Writes them with all digits, for programs."""
        found: Printer = TextPrinter(self.robot).doprint
        return found

    def note(self, finding: Finding) -> str:
        """What is said behind a derived formula where its numbers are rounded."""
        is_formula, decimals = not isinstance(finding.right, str), self.notation.decimals
        is_rounded = is_formula and loses_digits([finding.right], decimals=decimals, digits=DIGITS)
        return f" (numbers with {DIGITS} digits)" if is_rounded else ""


@dataclass(frozen=True)
class Item:
    """Wrong entries of one printed item."""

    findings: tuple[Finding, ...]
    printout: Printout
    document: Citation  # where they are printed


def report_lines(printout: Printout) -> list[str]:
    """The report of one file: what is wrong, the right formula and what repairs it, what is undecidable, the count."""
    report = printout.report
    corrections = right_corrections(report)
    lines: list[str] = []
    for finding in (*report.wrong, *report.undecidable):
        lines += finding_lines(finding, printout)
        if finding.erratum and finding.unknown is None and finding.entry in corrections:
            lines.append(f"  its correction is right: {cut(corrections[finding.entry].text)}")
    lines.append(f"{report.source}: {summary(report)}")
    return lines


def right_corrections(report: FileReport) -> dict[str, Finding]:
    """The corrections that a file gives and that are right."""
    return {f.entry: f for f in report.findings if f.role is Role.CORRECTION and f.verdict.equal}


def summary(report: FileReport) -> str:
    """``173 equal (120 in the same form), 6 wrong``, with what was compared at points only or not at all."""
    same = sum(judge(finding).outcome is Outcome.SAME_FORM for finding in report.findings)
    known = sum(finding.erratum for finding in report.wrong)
    numeric = sum(not f.verdict.exact and f.role is not Role.BRANCHES for f in report.findings)
    text = f"{report.equal} equal" + (f" ({same} in the same form)" if same else "") + f", {len(report.wrong)} wrong"
    text += f" ({known} marked as errata)" if known else ""
    text += f", {len(report.undecidable)} undecidable" if report.undecidable else ""
    text += f"; {numeric} compared at random points only" if numeric else ""
    return text + (f"; not compared: {', '.join(report.unread)}" if report.unread else "")


def all_lines(printout: Printout) -> Iterator[str]:
    """The verdicts on all formulas; wrong entries of one matrix that have one cause are told together."""
    for (cause, quantity), group in groupby(printout.report.findings, key=lambda f: (f.cause, f.cause and f.quantity)):
        findings = tuple(group)
        if cause:
            entries = ", ".join(finding.entry for finding in findings)
            yield f"{findings[0].location}: {quantity} is wrong in {len(findings)} entries for one reason: {cause}"
            yield f"  wrong: {cut(entries)}"
            continue
        yield from (line for finding in findings for line in finding_lines(finding, printout))


def finding_lines(finding: Finding, printout: Printout) -> Iterator[str]:
    """The verdict on one formula; of a wrong one the right formula, the change that repairs it, and numbers."""
    verdict = judge(finding)
    if finding.role is Role.BRANCHES:
        place = "" if finding.verdict.equal else f"{finding.location}: "
        yield f"{place}{finding.entry}: {finding.text}"
        yield from (f"  missing: {name}" for name in finding.missing)
        return
    match verdict.outcome:
        case Outcome.SAME_FORM:
            yield f"{what(finding)}: same form"
            return
        case Outcome.EQUAL:
            is_sure = finding.verdict.exact or finding.role is Role.SOLUTION
            closed = f"{finding.verdict.configurations} random configurations of the closed loops"
            points = closed if finding.verdict.configurations else "random points"
            yield f"{what(finding)}: equal" + ("" if is_sure else f", at {points}") + finding.note
            if right := right_text(finding, printout.printer):
                yield f"  ours: {cut(right)}{printout.note(finding)}"
            return
        case Outcome.UNDECIDABLE:
            yield f"{finding.location}: {what(finding)}: {verdict.outcome}: {unknown_name(finding)}"
            return
    wrong = f"is {verdict.outcome}" + (" only" if verdict.outcome is Outcome.SOME else "") + finding.note
    yield f"{finding.location}: {what(finding)} {wrong}: {cut(finding.text)}"
    if verdict.outcome is Outcome.SOME and finding.role is Role.IDENTITY:
        return
    if right := right_text(finding, printout.printer):
        yield f"  right: {cut(right)}{printout.note(finding)}"
    if verdict.repair is not None:
        yield f"  change: {cut(verdict.repair.text)}"
    if terms := difference_text(verdict, printout.printer):
        yield f"  printed - right: {cut(terms)}"
    if finding.verdict.counter_example is not None:
        yield f"  {numbers(finding.verdict.counter_example)}"


def as_dict(printout: Printout) -> dict[str, Any]:
    """The report of one file as plain data."""
    report = printout.report
    counts = {"equal": report.equal, "wrong": len(report.wrong), "undecidable": len(report.undecidable)}
    told = {"not_compared": list(report.unread), "readings": list(report.readings)}
    entries = [finding_dict(finding, printout.exact) for finding in report.findings]
    return {"file": report.source, "robot": report.robot, **counts, **told, "entries": entries}


def finding_dict(finding: Finding, printer: Printer) -> dict[str, Any]:
    """One verdict as plain data."""
    verdict = judge(finding)
    entry: dict[str, Any] = {"quantity": finding.entry, "role": finding.role.value, "printed": finding.text}
    entry |= {"verdict": verdict.outcome.value, "equal": finding.verdict.equal, "exact": finding.verdict.exact}
    entry |= {"erratum": finding.erratum, "line": finding.location.line, "column": finding.location.column}
    if finding.unknown is not None:
        return {**entry, "equal": None, "exact": None, "reason": str(finding.unknown)}
    if verdict.outcome is not Outcome.SAME_FORM:
        entry["right"] = right_text(finding, printer)
    if not finding.verdict.equal:
        entry["difference"] = [printer(term) for term in verdict.difference]
        repair = verdict.repair
        kinds = [kind.value for kind in repair.kinds] if repair else []
        entry["change"] = repair and {"kinds": kinds, "text": repair.text, "formula": repaired_text(finding)}
    if (example := finding.verdict.counter_example) is not None:
        values = {name: float(value) for name, value in example.values}
        printed = None if isnan(example.printed) else example.printed
        entry["counter_example"] = {"values": values, "printed": printed, "right": example.right}
    if finding.missing:
        entry["missing"] = list(finding.missing)
    return entry


def repaired_text(finding: Finding) -> str:
    """The printed formula with the change made; empty where none was found."""
    repair, question = judge(finding).repair, finding.question
    if repair is None:
        return ""
    return notation_text(repair.formula, question.robot) if question else str(getattr(repair.formula, "name", ""))


def difference_text(verdict: Judgement, printer: Printer) -> str:
    """Printed minus right in one line; empty where it is not known or has many terms."""
    if not 0 < len(verdict.difference) <= MAX_SHOWN_TERMS:
        return ""
    first, *rest = [printer(term) for term in verdict.difference]
    return first + "".join(f" - {term[1:]}" if term.startswith("-") else f" + {term}" for term in rest)


def unknown_name(finding: Finding) -> str:
    """The name that the robot does not know, and the nearest known ones; empty where all are known."""
    error = finding.unknown
    return "; ".join(part for part in (error.found, error.allowed, error.remedy) if part) if error else ""


def what(finding: Finding) -> str:
    """What a formula is, in words."""
    if finding.role is Role.IDENTITY:
        return f"identity for {cut(finding.quantity)}"
    words = {Role.CORRECTION: "correction of {}", Role.ABBREVIATED: "abbreviated {}", Role.REST: "{} of the rest"}
    usual = "{} (marked as an erratum)" if finding.erratum else "{}"
    return words.get(finding.role, usual).format(finding.entry)


def right_text(finding: Finding, printer: Printer) -> str:
    """The derived formula."""
    return finding.right if isinstance(finding.right, str) else printer(finding.right)


def numbers(example: CounterExample) -> str:
    """Numbers that show a difference."""
    values = ", ".join(f"{name} = {float(value):g}" for name, value in example.values)
    printed = "no real value" if isnan(example.printed) else f"{example.printed:.6g}"
    compared = f"printed {printed}, right {example.right:.6g}"
    return f"at {values}: {compared}" if values else compared


def cut(text: str, length: int = LONGEST) -> str:
    """The beginning of a text."""
    return text if len(text) <= length else f"{text[: length - 3]}..."


def errata_items(printouts: Sequence[Printout]) -> tuple[Item, ...]:
    """What is wrong, item by item, in the order of documents; what another file counts already is left out."""
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
    """The report as Markdown."""
    items = errata_items(printouts)
    errors = [item for item in items if item.findings[0].remark.kind != "convention"]
    conventions = [item for item in items if item.findings[0].remark.kind == "convention"]
    lines = ["# Errata", "", *([head, ""] if head else [])]
    decided = [f for p in printouts for f in p.report.findings if f.unknown is None]
    total = sum(f.role is not Role.CORRECTION for f in decided)
    entries = sum(len(item.findings) for item in errors)
    found = sum(judge(item.findings[0]).repair is not None for item in errors)
    places = f"{len(errors)} {'place' if len(errors) == 1 else 'places'}"
    undecidable = [f for printout in printouts for f in printout.report.undecidable]
    counts = f"{total} formulas compared: {entries} wrong, at {places}; the smallest change that repairs the formula is"
    more = f" {len(undecidable)} more were skipped: they use names that the robot does not have." if undecidable else ""
    lines += [f"{counts} named for {found} of them.{more}", ""]
    for title, group in groupby(errors, key=lambda item: item.document.title):
        lines += [f"## {_plain((titles or {}).get(title, title) or 'Formulas')}", ""]
        for item in group:
            lines += [*_lines(item), ""]
    if conventions:
        lines += ["## Other conventions, not errors", ""]
        lines += [line for item in conventions for line in (*_lines(item), "")]
    lines += ["## Undecidable: unknown names", ""] if undecidable else []
    for f in undecidable:
        name = _plain(unknown_name(f))
        lines.append(f"- {_code(str(f.location))}: {_plain(what(f))}, printed {_code(f.text)}: {name}")
    return "\n".join(lines).rstrip() + "\n"


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
        note = "" if own_style else item.printout.note(finding)
        right = _code(own_style or right_text(finding, printer)) + note
        lines = [f"- printed: {_code(finding.text)}", f"- right: {right}"]
        if finding.role is Role.BRANCHES:
            lines = [f"- given: {finding.text}", *(f"- missing: {name}" for name in finding.missing)]
        if verdict.repair is not None:
            lines.append(f"- change: {_code(verdict.repair.text)}")
        elif terms := difference_text(verdict, printer):
            lines.append(f"- printed minus right: {_code(terms)}")
        if example is not None and example.values:
            lines.append(f"- numbers: {_plain(numbers(example))}")
        yield from [f"- {_code(finding.entry)}", *(f"  {line}" for line in lines)] if several else lines
    if why := item.findings[0].remark.note:
        yield f"- why: {_plain(why)}"


def _code(text: str) -> str:
    """A formula between backticks, on one line."""
    shown = " ".join(text.split()).replace("`", "'")
    return f"`{cut(shown, LONGEST_ON_PAGE)}`"


def _plain(text: str) -> str:
    """Text whose signs Markdown leaves alone."""
    return "".join(f"\\{c}" if c in "\\`*_[]<>#|" else c for c in " ".join(text.split()) if c.isprintable())

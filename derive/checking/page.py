"""The verdicts on a document as a web page: the reading, each slip beside what is right, and what was not compared."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby

from derive.checking.formulas.findings import judge
from derive.checking.report import Printout, difference_text, numbers, summary, what
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.page.writer import page
from derive.handouts.sheet.document import Block, Document, Paragraph, Rows, Section, Table
from derive.handouts.sheet.language import Text

MARKED = r"\colorbox{#ffd7d7}"  # behind the printed entry that is wrong
LONGEST = 4_000  # characters of a formula that is rendered; longer ones are not shown


def verdict_page(printouts: Sequence[Printout]) -> str:
    """One HTML file that needs no network: the verdicts for each robot."""
    sections, robots = list[Section](), [printout.robot.name for printout in printouts]
    for number, printout in enumerate(printouts):
        report = printout.report
        ending, title = (f"-{number}", f"{robots[number]}: ") if len(robots) > 1 else ("", "")
        right = [(_code(f.location), _code(what(f)), judge(f).outcome) for f in report.findings if f.verdict.equal]
        readings = tuple(Paragraph(_code(reading)) for reading in report.readings)
        reasons = sorted((reason, place) for place, _, reason in (note.partition(": ") for note in report.unread))
        groups = groupby(reasons, key=lambda pair: pair[0])
        unread = [(_code(reason), ", ".join(_code(place) for _, place in group)) for reason, group in groups]
        sections += (
            Section(f"reading{ending}", f"{title}How it is read", readings),
            Section(f"slips{ending}", f"{title}Slips", tuple(_slips(printout))),
            Section(f"unread{ending}", f"{title}Not compared", _table(("reason", "places"), unread)),
            Section(f"right{ending}", f"{title}Right", _table(("place", "formula", "verdict"), right)),
        )
    document = Document(
        title=printouts[0].report.source.removesuffix(f" ({robots[0]})"),
        subtitle="; ".join(summary(replace(printout.report, unread=())) for printout in printouts),
        name=", ".join(robots),
        digest="",
        footer=f"Printed formulas against those derived from {', '.join(map(_code, robots))}",
        sections=tuple(section for section in sections if section.blocks),
    )
    return page(document, Text())


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> tuple[Table, ...]:
    found = tuple(rows)
    return (Table(head, found),) if found else ()


def _slips(printout: Printout) -> Iterator[Block]:
    """Each slip once, with its place, the printed entry, what is right, and one cause."""
    printer = LatexPrinter(printout.notation)
    wrong = [finding for finding in printout.report.findings if not finding.verdict.equal and finding.unknown is None]
    for (cause, quantity), group in groupby(wrong, key=lambda f: (f.cause, f.quantity if f.cause else f.location)):
        findings = tuple(group)
        if cause:
            yield Paragraph(f"{_code(findings[0].location)} {_code(quantity)}: {len(findings)} entries, {cause}")
        for finding in findings:
            if not cause:
                yield Paragraph(f"{_code(finding.location)} {_code(what(finding))}")
            verdict = judge(finding)
            right = "" if isinstance(finding.right, str) else printer.latex(finding.right)
            lines = [rf"{MARKED}{{$\displaystyle {finding.text}$}}"] if len(finding.text) <= LONGEST else []
            lines += [rf"\text{{right:}}\quad {right}"] if right and len(right) <= LONGEST else []
            yield Rows(tuple(lines))
            if verdict.repair is not None:
                yield Paragraph(f"Change: {_code(verdict.repair.text)}")
            elif terms := difference_text(verdict, printout.printer):
                yield Paragraph(f"Printed minus right: {_code(terms)}")
            if finding.verdict.counter_example is not None:
                yield Paragraph(_code(numbers(finding.verdict.counter_example)))


def _code(text: object) -> str:
    """Somebody's text between backticks."""
    return f"`{' '.join(str(text).split()).replace('`', chr(39))}`"

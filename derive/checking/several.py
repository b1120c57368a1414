"""One document about several robots: which of them each equation is about, by what is right for one robot only."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from derive.checking.formulas.findings import Skipped
from derive.checking.latex.check import LatexReport


def divided(names: Sequence[str], reports: Sequence[LatexReport], sections: Sequence[int]) -> list[LatexReport]:
    """Of the reports on one document, one for each robot, the parts that are about that robot.

    Sections has the number of the section in which each equation stands. What is right for one robot alone is about it.
    Other equations are about the robot of the equations beside them; where these do not say which, nothing is said.
    """
    rows = list(zip(*map(_by_equation, reports), strict=True))
    verdicts = [[[finding.verdict.equal for finding in part.findings] for part in row] for row in rows]
    right = [[robot for robot, equal in enumerate(row) if equal and all(equal)] for row in verdicts]
    sure = {index: robots[0] for index, robots in enumerate(right) if len(robots) == 1}
    said = [_said(names, row, right[index], _beside(index, sure, sections)) for index, row in enumerate(rows)]
    found = []
    for number, report in enumerate(reports):
        own = [part for robot, part in said if robot == number]
        findings = tuple(finding for part in own for finding in part.findings)
        found.append(replace(report, findings=findings, skipped=tuple(one for part in own for one in part.skipped)))
    return found


def _said(
    names: Sequence[str], row: Sequence[LatexReport], right: Sequence[int], beside: Sequence[int]
) -> tuple[int, LatexReport]:
    """The robot that an equation is about, and what is said of it; beside are the robots before and behind it."""
    compared = [robot for robot, part in enumerate(row) if part.findings]
    around = [robot for robot in dict.fromkeys(beside) if robot in compared]
    if len(right) == 1 and len(beside) == 2 and len(around) == len(set(beside)) == 1 and around != list(right):
        reason = f"right for {names[right[0]]} and wrong for {names[around[0]]}, whose formulas stand around it"
        return around[0], _not_compared(row[around[0]], reason)
    if right:
        robot = next((robot for robot in beside if robot in right), right[0])
        return robot, row[robot]
    likely = compared if len(compared) == 1 else around if len(around) == len(set(beside)) else []
    if len(likely) == 1:
        return likely[0], row[likely[0]]
    if compared:
        reason = f"wrong for {' and for '.join(names[robot] for robot in compared)}; which is meant is not certain"
        return compared[0], _not_compared(row[compared[0]], reason)
    told = [robot for robot, part in enumerate(row) if part.skipped]
    robot = next((robot for robot in (*beside, *told) if robot in told), 0)
    return robot, row[robot]


def _by_equation(report: LatexReport) -> list[LatexReport]:
    """What a report says of each equation."""
    begins = [(place.line, place.column) for place in report.equations]
    ends = [*begins[1:], (10**9, 0)]
    parts = []
    for begin, end in zip(begins, ends, strict=True):
        findings = tuple(f for f in report.findings if begin <= (f.location.line, f.location.column) < end)
        skipped = tuple(s for s in report.skipped if begin <= (s.location.line, s.location.column) < end)
        parts.append(replace(report, findings=findings, skipped=skipped))
    return parts


def _beside(index: int, sure: Mapping[int, int], sections: Sequence[int]) -> list[int]:
    """The robots of the nearest equations before and behind, of those in the same section where it has any."""
    others = {at: robot for at, robot in sure.items() if at != index}
    here = {at: robot for at, robot in others.items() if sections[at] == sections[index]} or others
    before = max((at for at in here if at < index), default=None)
    behind = min((at for at in here if at > index), default=None)
    return [here[at] for at in (before, behind) if at is not None]


def _not_compared(part: LatexReport, reason: str) -> LatexReport:
    first = part.findings[0]
    return replace(part, findings=(), skipped=(Skipped(first.location, reason, first.text), *part.skipped))

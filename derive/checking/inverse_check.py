"""Printed solutions of the inverse kinematics against the arm: right, some branches, or wrong and what repairs it.

A line is tried at random configurations of arms with random geometry: put the true values of everything that it names
into it, and some choice of its plus-minus signs must give what it is about. So each line is judged by itself, although
it stands on others; lines that share a choice are judged together. That all configurations of all poses are met by such
ones means that no branch is missing, without any solver; the derived solutions only give the branches their names.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property

from derive.checking.diagnosis import Repair
from derive.checking.edits import SlipKind, changes_text
from derive.checking.findings import Finding, Role
from derive.checking.inverse_ours import OurSolution
from derive.checking.inverse_poses import places
from derive.checking.inverse_reading import Vocabulary
from derive.checking.inverse_repair import InverseRepair, Repairer
from derive.checking.latex_names import SIGN
from derive.checking.printed import Asked
from derive.checking.printed_inverse import Formula, Line, Place, PrintedInverse, with_calls
from derive.errors import listed
from derive.lecture.shorthand import notation_text
from derive.model.equality import CounterExample, Verdict
from derive.model.model import Model
from derive.robot.expression import Call, Expression, children, names
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

KINDS = tuple(kind for kind in SlipKind if kind not in (SlipKind.PLUS_MINUS, SlipKind.ATAN2))
"""The changes that are tried where a line is never right."""

RIGHT = Verdict(equal=True, exact=False)
WRONG = Verdict(equal=False, exact=False)

_ARCS = ("acos", "asin", "atan")


def inverse_findings(model: Model, printed: PrintedInverse, vocabulary: Vocabulary, asked: Asked) -> Iterator[Finding]:
    """The verdict on every line that gives a joint or something of it, and on all branches together.

    Args:
        model: The robot's model.
        printed: The solution.
        vocabulary: Its names.
        asked: Its task and where it stands.

    Yields:
        One finding for each line, in the order of the text, and one for the branches.

    Raises:
        CheckError: Lines that need each other.
    """
    check = _InverseCheck(model, printed, vocabulary, asked)
    yield from check.lines()
    if not check.is_wrong:
        yield check.branches()


class _InverseCheck:
    """The comparison of one printed solution."""

    def __init__(self, model: Model, printed: PrintedInverse, vocabulary: Vocabulary, asked: Asked) -> None:
        self._model, self._vocabulary, self._asked = model, vocabulary, asked
        self.is_wrong = False
        self._places = places(vocabulary.pose, vocabulary.sums)
        self._printed, self._note = self._in_order(printed)
        if model.robot.parameters and not self._is_right(self._printed):
            numeric = places(vocabulary.pose, vocabulary.sums, numbers=True)
            kept, self._places = self._places, numeric
            if not self._is_right(self._printed):
                self._places = kept
        self._ours = OurSolution(model, self._printed, vocabulary.pose, asked.task)

    def _is_right(self, printed: PrintedInverse) -> bool:
        return all(printed.hits(line, place) for line in printed.given for place in self._places if place.required)

    def _in_order(self, printed: PrintedInverse) -> tuple[PrintedInverse, str]:
        """The solution with atan2 for what may take the cosine first: whichever makes more lines right."""
        every = [f for line in printed.lines for f in line.formulas]
        calls = sum(_count(f.expression, "Atan2") for f in every)
        ways = {}
        for swapped in (False, True):
            change = {id(f): with_calls(f.expression, "Atan2", "atan2", swapped) for f in every}
            if self._asked.cosine_first:  # every atan2 is the book's
                change = {id(f): _turned(f.expression) for f in every}
            ways[swapped] = printed.mapped(change)
        is_lone = calls == 1 and not any("tan2" not in f.text for f in every if _count(f.expression, "Atan2"))
        if not calls or self._asked.cosine_first is not None or is_lone:
            return ways[False], ""
        some = [place for place in self._places if place.required][:8]
        right = {s: sum(all(p.hits(line, x) for x in some) for line in p.given) for s, p in ways.items()}
        swapped = right[True] > right[False]
        return ways[swapped], " (its arctangent takes the cosine first)" if swapped else ""

    # -- lines

    def lines(self) -> Iterator[Finding]:
        """The verdict on every line; of one that is wrong because of a quantity that it names, on that quantity."""
        found: dict[Formula, Finding] = {}
        failing = [line for line in self._printed.given if not all(self._hits(line))]
        for line in self._printed.given:
            if line not in failing:
                for formula in line.formulas:
                    found[formula] = self._never_right(line, formula) or self._right(line, formula)
        done: set[int] = set()
        for line in failing:
            if id(line) not in done:
                repaired, finding, place = self._failing(line, failing)
                found[place] = finding
                done.update(id(other) for other in repaired)
        for group in self._printed.coupled():
            if len(group) > 1 and not any(line in failing for line in group):
                self._check_together(group, found)
        yield from sorted(found.values(), key=lambda f: (f.location.line, f.location.column))

    def _hits(self, line: Line) -> list[bool]:
        return [self._printed.hits(line, place) for place in self._places if place.required]

    def _never_right(self, line: Line, formula: Formula) -> Finding | None:
        """The verdict on an alternative that is right nowhere, although another one is."""
        if len(line.formulas) == 1:
            return None
        alone = replace(line, formulas=(formula,))
        if any(self._printed.hits(alone, place) for place in self._places):
            return None
        self.is_wrong = True
        example = self._example(alone, [place for place in self._places if place.required])
        return self._finding(line.quantity, formula, replace(WRONG, counter_example=example))

    def _right(self, line: Line, formula: Formula) -> Finding:
        return self._finding(
            line.quantity, formula, RIGHT, right=self._ours.text(line), same=self._ours.has_form(formula)
        )

    def _failing(self, line: Line, failing: Sequence[Line]) -> tuple[list[Line], Finding, Formula]:
        """What is wrong with a line: itself, or a quantity that it names; with the lines that this repairs."""
        hits = self._hits(line)
        required = [place for place in self._places if place.required]
        bad = [place for place, hit in zip(required, hits, strict=True) if not hit]
        ordered = [*bad, *(place for place in required if place not in bad)]
        is_partial = any(hits) and sum(hits) >= len(hits) // 8
        kinds = (SlipKind.PLUS_MINUS, SlipKind.ATAN2, *KINDS) if is_partial else (*KINDS, SlipKind.ATAN2)
        repair, repaired = self._repair(line, failing, ordered, kinds)
        changed, formula = (repair.line, repair.formula) if repair else (line, line.formulas[0])
        has_arc = any(
            _count(f.expression, arc)
            for part in (*self._printed.named_before(line), line)
            for f in part.formulas
            for arc in _ARCS
        )
        is_some = is_partial and (repair.edits[0].kind is SlipKind.PLUS_MINUS if repair else not has_arc)
        self.is_wrong = self.is_wrong or not is_some
        example = self._example(line, bad)
        said = None
        if repair is not None:
            text = changes_text(repair.edits, self._model.robot)
            said = Repair(tuple(edit.kind for edit in repair.edits), shown(text), repair.expression)
        verdict = replace(WRONG, counter_example=example)
        right = self._ours.text(changed) if changed.target is not None else _repaired(repair, self._model.robot)
        finding = self._finding(
            changed.quantity,
            formula,
            verdict,
            right=right or _repaired(repair, self._model.robot),
            repair=said,
            some=is_some,
        )
        return repaired, finding, formula

    def _repair(
        self, line: Line, failing: Sequence[Line], ordered: Sequence[Place], kinds: Sequence[SlipKind]
    ) -> tuple[InverseRepair | None, list[Line]]:
        """What repairs a line, and all lines that it repairs: a quantity that others need too, itself, another one."""
        needed = self._printed.named_before(line)
        for part in needed:
            users = [other for other in failing if part in self._printed.named_before(other)]
            if len(users) > 1:
                search = Repairer(self._printed, users, ordered, self._known)
                if found := search.first(kinds, [(part, f) for f in part.formulas]):
                    return found, users
        sites = [(part, f) for part in (line, *reversed(needed)) for f in part.formulas]
        return Repairer(self._printed, [line], ordered, self._known).first(kinds, sites), [line]

    def _check_together(self, group: Sequence[Line], found: dict[Formula, Finding]) -> None:
        """Lines that are right one by one, but with choices that contradict each other."""
        required = [place for place in self._places if place.required]
        bad = [place for place in required if not self._printed.hit_together(group, place)]
        if not bad:
            return
        ordered = [*bad, *(place for place in required if place not in bad)]
        sites = [(line, formula) for line in reversed(group) for formula in line.formulas]
        repair = Repairer(self._printed, group, ordered, self._known).first(KINDS, sites)
        line, formula = (repair.line, repair.formula) if repair else (group[-1], group[-1].formulas[0])
        self.is_wrong = True
        said = None
        if repair is not None:
            text = shown(changes_text(repair.edits, self._model.robot))
            said = Repair(tuple(edit.kind for edit in repair.edits), text, repair.expression)
        note = f"; with the same signs as {listed(other.quantity for other in group if other is not line)}"
        finding = self._finding(line.quantity, formula, WRONG, right=self._ours.text(line), repair=said)
        found[formula] = replace(finding, note=note)

    @cached_property
    def _known(self) -> tuple[str, ...]:
        """Names that may have been meant: parameters, joint variables, the pose in the letters of the text."""
        robot, used = self._model.robot, self._vocabulary
        pose = list(used.pose.entries)
        stems = {name.rstrip("0123456789xyz") for name in pose}
        for stem in stems:
            columns = {name.removeprefix(stem) for name in pose if name.startswith(stem)}
            if columns & {"x", "y", "z"}:
                pose += [f"{stem}{axis}" for axis in "xyz"]
        usable = [name for name in dict.fromkeys(pose) if name in self._places[0].values]
        symbols = robot_symbols(replace(robot, links=(), gravity=None))
        named = [line.name for line in self._printed.lines if line.target is None]
        return tuple(dict.fromkeys((*symbols, *(j.variable for j in robot.joints), *usable, *used.pose.wrist, *named)))

    def _example(self, line: Line, bad: Sequence[Place]) -> CounterExample | None:
        """A configuration at which a line fails, with the value that is nearest to the right one there."""
        parts = (*self._printed.named_before(line), line)
        used = dict.fromkeys(name for part in parts for f in part.formulas for name in names(f.expression))
        for place in bad[:1]:
            wanted = self._printed.wanted(line, place)
            values = list(self._printed.values(line, place))
            is_angle = self._printed.is_angle(line)
            nearest = min(
                values,
                key=lambda v: abs(math.remainder(v - wanted, math.tau) if is_angle else v - wanted),
                default=math.nan,
            )
            point = [
                (n.strip("()"), Fraction(round(place.values[n], 4)).limit_denominator(10**4))
                for n in used
                if n in place.values
            ]
            return CounterExample(tuple(point), nearest, wanted)
        return None

    def _finding(
        self,
        quantity: str,
        formula: Formula,
        verdict: Verdict,
        *,
        right: str = "",
        repair: Repair | None = None,
        same: bool = False,
        some: bool = False,
    ) -> Finding:
        return Finding(
            quantity,
            0,
            0,
            Role.SOLUTION,
            formula.text,
            verdict,
            right,
            formula.location,
            repair=repair,
            same=same,
            some=some,
        )

    # -- branches

    def branches(self) -> Finding:
        """Whether all branches are given, or which are missing."""
        required = [place for place in self._places if place.required]
        hits = [self._is_met(place) for place in required]
        ours, robot, found = self._ours, self._model.robot, self._printed.determined
        variables = [joint.variable for joint in robot.joints]
        rest = [name for name in variables if name not in found and name not in ours.given]
        of = f" of {listed(found)}; no formula for {listed(rest)}" if rest else ""
        missing: tuple[str, ...] = ()
        if all(hits):
            count = ours.count
            what = f"all {count} solutions" if count > 1 else "the one solution" if count else "all solutions"
            if not all(self._is_met(place) for place in self._places if not place.required):
                slides = listed(joint.variable for joint in robot.joints if not joint.is_revolute)
                what = f"all solutions with positive {slides}"
        else:
            missing = ours.missing(required, hits)
            what = f"{ours.count - len(missing)} of {ours.count} solutions" if missing else "some solutions"
        text, verdict = f"{what}{of}{self._note}", RIGHT if all(hits) else WRONG
        where = self._asked.location
        return Finding("inverse", 0, 0, Role.BRANCHES, text, verdict, "", where, some=not all(hits), missing=missing)

    def _is_met(self, place: Place) -> bool:
        return all(self._printed.hit_together(group, place) for group in self._printed.coupled())


def shown(text: str) -> str:
    """A text with ``+-`` for the name of a plus-minus.

    Args:
        text: A formula, or words with formulas.
    """
    text = re.sub(rf"([+-]) -?{SIGN}\w*\*?", lambda m: f"{m[1]}- " if m[1] == "+" else "-+ ", text)
    text = re.sub(rf"-{SIGN}\w*\*?", "-+", text)
    return re.sub(rf"{SIGN}\w*\*?", "+-", text)


def _repaired(repair: InverseRepair | None, robot: Robot) -> str:
    return shown(notation_text(repair.expression, robot)) if repair else ""


def _count(e: Expression, function: str) -> int:
    own = isinstance(e, Call) and e.function == function
    return own + sum(_count(part, function) for part in children(e))


def _turned(e: Expression) -> Expression:
    """An expression whose arctangents all take the cosine first, in our order."""
    return with_calls(with_calls(e, "Atan2", "atan2", False), "atan2", "atan2", True)

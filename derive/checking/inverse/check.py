"""Printed solutions of the inverse kinematics against the arm: right, some branches, or wrong and what repairs it.

At random configurations of arms with random geometry some choice of a line's plus-minus signs must give what it is
about, with the true values of all that it names; lines that share a choice are judged together. That all configurations
of all poses are met means that no branch is missing; the derived solutions only give the branches their names.
"""

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cached_property, partial
from itertools import product

import numpy as np

from derive.checking.formulas.branches import SIGN, count_calls, with_atan2
from derive.checking.formulas.diagnosis import Repair
from derive.checking.formulas.edits import Replacements, SlipKind, changes_text, edits, spots
from derive.checking.formulas.findings import Finding, Role, Skipped
from derive.checking.formulas.printed import InverseText
from derive.checking.inverse.ours import OurSolution
from derive.checking.inverse.poses import geometry_symbols, places, pose_of
from derive.checking.inverse.printed import Place, PrintedFormula, PrintedInverse, PrintedLine, determined_joints
from derive.checking.inverse.reading import Side, Vocabulary, assembled, latex_equations, text_equations
from derive.checking.inverse.repair import InverseRepair, Repairer
from derive.checking.latex.names import plus_minus
from derive.errors import CheckError, QuantityError, listed
from derive.lecture.shorthand import notation_text
from derive.model.equality import CounterExample, Verdict
from derive.model.model import Model
from derive.model.quantity_names import parse
from derive.robot.expression import Call, Expression, Name, Pi, add, names, negate, number, substitute
from derive.robot.tree import require_chain

# The changes that are tried where a line is never right.
KINDS = tuple(kind for kind in SlipKind if kind not in (SlipKind.PLUS_MINUS, SlipKind.ATAN2))
SHOWN_OF = 12  # configurations among which one is chosen that shows a difference
RIGHT = Verdict(equal=True, exact=False)
WRONG = Verdict(equal=False, exact=False)

TRIED_FOR_BRANCHES = 16  # poses at which it is counted how many of their solutions are given


def check_inverse(model: Model, solution: InverseText) -> tuple[tuple[Finding, ...], tuple[Skipped, ...]]:
    """The verdicts on every line about a joint and on all branches together, and the equations that are not read."""
    robot, signs = model.robot, plus_minus()
    require_chain(robot, "a check of inverse kinematics", solution.location)
    equations, words = list[list[Side]](), list[str]()
    if not any(part.text.strip() for part in solution.parts):
        remedy = "write theta1 = ..., one quantity a line"
        raise CheckError("empty solution", remedy=remedy, location=solution.location)
    read = partial(latex_equations, document=solution.document) if solution.latex else text_equations
    refused: list[Skipped] | None = [] if solution.document else None
    try:
        for part in solution.parts:
            found, named = read(part.text, robot, part.location, signs)
            equations += found
            words += named
        part = solution.parts[0]  # where errors of the whole stand
        printed, vocabulary = assembled(robot, equations, words, refused)
        check = _InverseCheck(model, printed, vocabulary, solution)
        findings = [*check.lines(), *([] if check.is_wrong else [check.branches()])]
    except CheckError as error:
        raise error if part.verbatim else error.moved(part.location) from None
    erratum = solution.status == "erratum"
    said = (replace(f, erratum=erratum and not f.verdict.equal, remark=solution.remark) for f in findings)
    return tuple(said), tuple(refused or ())


def names_inverse(model: Model, quantity: str) -> bool:
    """Whether a quantity that is asked about is the inverse kinematics."""
    with suppress(QuantityError):
        return bool(quantity) and parse(model, quantity)[0].name == "inverse"
    return False


class _InverseCheck:
    """The comparison of one printed solution."""

    def __init__(self, model: Model, printed: PrintedInverse, vocabulary: Vocabulary, asked: InverseText) -> None:
        self._model, self._vocabulary, self._asked = model, vocabulary, asked
        self.is_wrong = False
        self._places: Sequence[Place] = places(vocabulary.pose, vocabulary.sums)
        self._printed, self._note = self._in_order(printed)
        if model.robot.parameters and not self._is_right():
            # wrong for arms with this table, but right perhaps for the one whose numbers the file gives
            symbolic, self._places = self._places, places(vocabulary.pose, vocabulary.sums, numbers=True)
            self._places = self._places if self._is_right() else symbolic
        self._primed = tuple(self._second_solution()) if self._printed.primed else ()
        self._ours = OurSolution(model, self._printed, vocabulary.pose, asked.task, self._places)

    @property
    def _required(self) -> tuple[Place, ...]:
        return tuple(place for place in self._places if place.required)

    def _is_right(self) -> bool:
        return all(all(self._hits(line)) for line in self._printed.given)

    def _in_order(self, printed: PrintedInverse) -> tuple[PrintedInverse, str]:
        """The solution with atan2 for what may take the cosine first: whichever makes more lines right."""
        every = [f for line in printed.lines for f in line.formulas]
        calls = sum(count_calls(f.expression, "Atan2") for f in every)
        if self._asked.cosine_first:  # every atan2 is the book's
            ours = printed.mapped(partial(with_atan2, function="Atan2", swapped=False))
            return ours.mapped(partial(with_atan2, function="atan2", swapped=True)), ""
        plain, turned = (printed.mapped(partial(with_atan2, function="Atan2", swapped=s)) for s in (False, True))
        is_lone = calls == 1 and not any("tan2" not in f.text for f in every if count_calls(f.expression, "Atan2"))
        if not calls or self._asked.cosine_first is not None or is_lone:
            return plain, ""
        some = self._required[:8]
        right, right_turned = (sum(all(p.hits(line, x) for x in some) for line in p.given) for p in (plain, turned))
        return (turned, " (its arctangent takes the cosine first)") if right_turned > right else (plain, "")

    def _second_solution(self) -> Iterator[Finding]:
        """The verdicts on primed lines, which must lead from every configuration to another one of the same pose."""
        repaired = None
        if all(self._leads_back(self._printed, place) for place in self._places):
            self._places = tuple(replace(p, twin=self._printed.second(p)) for p in self._places)
            wrong: set[PrintedLine] = set()
        else:
            self.is_wrong, repaired = True, self._primed_repair()
            wrong = {repaired[0]} if repaired else set(self._printed.primed)
        for line in self._printed.primed:
            said, verdict = (repaired and repaired[1], WRONG) if line in wrong else (None, RIGHT)
            yield self._finding(f"{line.quantity}'", line.formulas[0], verdict, repair=said)

    def _leads_back(self, printed: PrintedInverse, place: Place) -> bool:
        """Whether primed lines lead from a configuration to one of the same pose."""
        twin = printed.second(place)
        return twin is not None and np.allclose(pose_of(self._model.robot, twin.values), place.pose, atol=1e-9)

    def _primed_repair(self) -> tuple[PrintedLine, Repair] | None:
        """The change of one primed line with which they lead to the same pose."""
        robot = self._model.robot
        joints = tuple(joint.variable for joint in robot.joints)
        may = Replacements(names=joints, angles=(), terms=(Pi(), negate(Pi()), *map(Name, joints)))
        for kind, line in product(KINDS, self._printed.primed):
            for edit in (edit for spot in spots(line.formulas[0].expression) for edit in edits(spot, may, kind)):
                changed = self._printed.changed(line, line.formulas[0], edit.formula)
                if all(self._leads_back(changed, place) for place in self._places[:3]):
                    return line, Repair((kind,), changes_text((edit,), robot), Name(notation_text(edit.formula, robot)))
        return None

    def lines(self) -> Iterator[Finding]:
        """The verdict on every line; of one that is wrong because of a quantity that it names, on that quantity."""
        found: dict[PrintedFormula, Finding] = {}
        failing = [line for line in self._printed.given if not all(self._hits(line))]
        for line in (line for line in self._printed.given if line not in failing):
            never = {f: wrong for f in line.formulas if (wrong := self._never_right(line, f))}
            rest = tuple(f for f in line.formulas if f not in never)
            found.update(never)
            if rest:
                is_same = len(rest) == 1 and self._ours.has_form(rest[0])
                whole = replace(rest[0], text=" or ".join(f.text for f in rest))
                said = self._finding(line.quantity, whole, RIGHT, self._ours.text(line))
                found[rest[0]] = replace(said, same=is_same)
        done: set[PrintedLine] = set()  # what one change repairs has one verdict
        for line in failing:
            if line not in done:
                repaired, finding, place = self._failing(line, failing)
                found[place] = finding
                done.update(repaired)
        for group in (group for group in self._printed.coupled() if not any(line in failing for line in group)):
            if len(group) > 1:
                self._check_together(group, found)
            if not self.is_wrong:
                self._check_signs(group, found)
        yield from sorted((*found.values(), *self._primed), key=lambda f: (f.location.line, f.location.column))

    def _hits(self, line: PrintedLine) -> Iterator[bool]:
        return (self._printed.hits(line, place) for place in self._required)

    def _never_right(self, line: PrintedLine, formula: PrintedFormula) -> Finding | None:
        """The verdict on an alternative that is right nowhere, although another one is."""
        alone = replace(line, formulas=(formula,))
        if len(line.formulas) == 1 or any(self._printed.hits(alone, place) for place in self._places):
            return None
        self.is_wrong = True
        verdict = replace(WRONG, counter_example=self._example(alone, self._required))
        return self._finding(line.quantity, formula, verdict, repair=self._other_side(alone))

    def _other_side(self, line: PrintedLine) -> Repair | None:
        """Another left side for which a line is right: s3 for c3, or another joint."""
        robot, meaning = self._model.robot, self._printed.meaning(line.target) if line.target else None
        if line.target is None or meaning is None:
            return None
        angle = line.target.arguments[0] if isinstance(line.target, Call) else line.target
        joints: list[Expression] = [Name(joint.variable) for joint in robot.joints]
        own = [angle, *(Call(f, (angle,)) for f in ("cos", "sin", "tan"))]
        others = [Call(meaning[0], (joint,)) if meaning[0] else joint for joint in joints]
        for target in (target for target in (*own, *others) if target != line.target):
            if all(self._hits(replace(line, target=target))):
                text = notation_text(target, robot)
                return Repair((SlipKind.SYMBOL,), f"left side: {text} instead of {line.quantity}", Name(text))
        return None

    def _failing(
        self, line: PrintedLine, failing: Sequence[PrintedLine]
    ) -> tuple[list[PrintedLine], Finding, PrintedFormula]:
        """What is wrong with a line: itself, or a quantity that it names; with the lines that this repairs."""
        hits = list(self._hits(line))
        bad = [place for place, hit in zip(self._required, hits, strict=True) if not hit]
        # a change is tried first where the line fails, so that wrong ones are dropped at once
        ordered = [*bad, *(place for place in self._required if place not in bad)]
        verdict = replace(WRONG, counter_example=self._example(line, bad))
        # right at an eighth of the configurations or more: rather a branch that is missing than a slip
        is_partial = sum(hits) >= max(1, len(hits) // 8)
        kinds = (SlipKind.PLUS_MINUS, SlipKind.ATAN2, *KINDS) if is_partial else (*KINDS, SlipKind.ATAN2)
        has_arc = self._printed.has_arc(line)
        # whether it only lacks the solution half a turn away, which explains it where no arc function may be wrong
        others = [replace(f, expression=add(f.expression, Pi())) for f in line.formulas]
        both = replace(line, formulas=(*line.formulas, *others))
        lacks = is_partial and self._printed.is_angle(line) and all(self._printed.hits(both, x) for x in ordered)
        repair, repaired = (None, [line]) if lacks and not has_arc else self._repair(line, failing, ordered, kinds)
        is_some = is_partial and (repair.edits[0].kind is SlipKind.PLUS_MINUS if repair else lacks or not has_arc)
        self.is_wrong = self.is_wrong or not is_some
        if repair is not None:
            return repaired, replace(self._repaired(repair, verdict), some=is_some), repair.formula
        first, second = line.formulas[0], f"or {line.quantity} + pi"
        half_turn = Repair((SlipKind.PLUS_MINUS,), f"second solution missing: {second}", Name(f"{first.text} {second}"))
        said = half_turn if lacks else self._other_side(line)
        finding = self._finding(line.quantity, first, verdict, right=self._ours.text(line), repair=said)
        return repaired, replace(finding, some=is_some), first

    def _repaired(self, repair: InverseRepair, verdict: Verdict) -> Finding:
        robot, line = self._model.robot, repair.line
        text = shown(changes_text(repair.edits, robot))
        whole = shown(notation_text(repair.edits[-1].formula, robot))
        said = Repair(tuple(edit.kind for edit in repair.edits), text, Name(whole))
        right = (self._ours.text(line) if line.target is not None else "") or whole
        return self._finding(line.quantity, repair.formula, verdict, right=right, repair=said)

    def _repair(
        self, line: PrintedLine, failing: Sequence[PrintedLine], ordered: Sequence[Place], kinds: Sequence[SlipKind]
    ) -> tuple[InverseRepair | None, list[PrintedLine]]:
        """What repairs a line, and all lines that it repairs: a quantity that others need too, itself, another one."""
        # one slip in a quantity that several failing lines need explains all of them
        needed = self._printed.named_before(line)
        for part in needed:
            users = [other for other in failing if part in self._printed.named_before(other)]
            if len(users) > 1:
                search = Repairer(self._printed, users, ordered, self._known)
                if found := search.first(kinds, [(part, f) for f in part.formulas]):
                    return found, users
        sites = [(part, f) for part in (line, *reversed(needed)) for f in part.formulas]
        return Repairer(self._printed, [line], ordered, self._known).first(kinds, sites), [line]

    def _check_together(self, group: Sequence[PrintedLine], found: dict[PrintedFormula, Finding]) -> None:
        """Lines that are right one by one, but with choices that contradict each other."""
        bad = [place for place in self._required if not self._printed.hit_together(group, place)]
        if not bad:
            return
        ordered = [*bad, *(place for place in self._required if place not in bad)]
        sites = [(line, formula) for line in reversed(group) for formula in line.formulas]
        repair = Repairer(self._printed, group, ordered, self._known).first(KINDS, sites)
        line, formula = (repair.line, repair.formula) if repair else (group[-1], group[-1].formulas[0])
        self.is_wrong = True
        plain = self._finding(line.quantity, formula, WRONG, right=self._ours.text(line))
        note = f" with the same signs as in {listed(other.quantity for other in group if other is not line)}"
        found[formula] = replace(self._repaired(repair, WRONG) if repair else plain, note=note)

    def _check_signs(self, group: Sequence[PrintedLine], found: dict[PrintedFormula, Finding]) -> None:
        """Choices of which one never gives anything: a plus-minus where a plus or a minus would do."""
        parts = [part for line in group for part in (*self._printed.named_before(line), line)]
        for sign in {name: None for line in group for name in self._printed.choices(line) if len(name) > 1}:
            holders = [(part, f) for part in parts for f in part.formulas if sign in names(f.expression)]
            # a sign is idle where one of its values meets every required configuration and the other one none
            met = {e: [self._printed.hit_together(group, x, {sign: e}) for x in self._places] for e in (1.0, -1.0)}
            needed = [place.required for place in self._places]
            useful = [e for e, hits in met.items() if all(h for h, n in zip(hits, needed, strict=True) if n)]
            if not holders or not useful or any(met[-useful[0]]):
                continue
            self.is_wrong = True
            part, formula = holders[0]
            right = substitute(formula.expression, {sign: number(int(useful[0]))})
            text = shown(notation_text(right, self._model.robot))
            said = Repair((SlipKind.SIGN,), f"+- that is not needed: {text}", Name(text))
            found[formula] = self._finding(part.quantity, formula, WRONG, right=text, repair=said)

    @cached_property
    def _known(self) -> tuple[str, ...]:
        """Names that may have been meant: parameters, joint variables, the pose in the letters of the text."""
        robot, pose = self._model.robot, self._vocabulary.pose
        named = [line.name for line in self._printed.lines if line.target is None]
        usable = (name for name in (*pose.entries, *pose.relatives, *pose.wrist) if name in self._places[0].values)
        joints = (joint.variable for joint in robot.joints)
        return tuple(dict.fromkeys((*geometry_symbols(robot), *joints, *usable, *named)))

    def _example(self, line: PrintedLine, bad: Sequence[Place]) -> CounterExample | None:
        """A configuration at which a line fails most visibly, with the value that is nearest to the right one there."""
        parts = (*self._printed.named_before(line), line)
        used = dict.fromkeys(name for part in parts for f in part.formulas for name in names(f.expression))
        is_angle, found = self._printed.is_angle(line), []
        for k, place in enumerate(bad[:SHOWN_OF]):
            wanted = self._printed.wanted(line, place)
            gaps = [(value - wanted, value) for value in self._printed.values(line, place)]
            gaps = [(abs(math.remainder(gap, math.tau) if is_angle else gap), value) for gap, value in gaps]
            found.append((*min(gaps, default=(math.inf, math.nan)), k, wanted))
        if not found:
            return None
        _, nearest, k, wanted = max(found, key=lambda each: (each[0] < math.inf, each[0]))
        known = {name: Fraction(f"{bad[k].values[name]:.4f}") for name in used if name in bad[k].values}
        return CounterExample(tuple((name.strip("()"), value) for name, value in known.items()), nearest, wanted)

    def _finding(
        self, quantity: str, formula: PrintedFormula, verdict: Verdict, right: str = "", repair: Repair | None = None
    ) -> Finding:
        return Finding(quantity, 0, 0, Role.SOLUTION, formula.text, verdict, right, formula.location, repair=repair)

    def branches(self) -> Finding:
        """Whether all branches are given, or which are missing."""
        ours, robot, found = self._ours, self._model.robot, determined_joints(self._printed)
        rest = [joint.variable for joint in robot.joints if joint.variable not in (*found, *ours.given)]
        of = f" of {listed(found)}; no formula for {listed(rest)}" if rest else ""
        missing: tuple[str, ...] = ()
        if is_whole := all(map(self._printed.met, self._required)):
            count = ours.count
            what = f"all {count} solutions" if count > 1 else "the one solution" if count else "all solutions"
            if not all(self._printed.met(place) for place in self._places if not place.required):
                slides = listed(joint.variable for joint in robot.joints if not joint.is_revolute)
                what = f"all solutions with positive {slides}"
        else:
            has_twins = self._places[0].twin is not None

            def is_met(place: Place) -> bool:  # a configuration that is none of those that are tried, or its twin
                return self._printed.met(replace(place, twin=self._printed.second(place)) if has_twins else place)

            met, missing = ours.met(self._required[:TRIED_FOR_BRANCHES], is_met)
            what = f"{met} of {ours.count} solutions" if met else "some solutions"
        needed = {part for line in self._printed.given for part in self._printed.named_before(line)}
        entries = self._vocabulary.pose.entries
        idle = [n for n, line in self._printed.named.items() if line not in needed and n not in entries]
        unused = f"; {listed(idle)} not used" if idle else ""
        text, where = f"{what}{of}{unused}{self._note}", self._asked.location
        verdict = RIGHT if is_whole else WRONG
        return Finding("inverse", 0, 0, Role.BRANCHES, text, verdict, "", where, some=not is_whole, missing=missing)


def shown(text: str) -> str:
    """A text with ``+-`` for the name of a plus-minus."""
    text = re.sub(rf"([+-]) -?{SIGN}\w*\*?", lambda m: f"{m[1]}- " if m[1] == "+" else "-+ ", text)
    text = re.sub(rf"-{SIGN}\w*\*?", "-+", text)
    return re.sub(rf"{SIGN}\w*\*?", "+-", text)

r"""LaTeX against a robot: every equation of a text, matrices entry by entry, each with a verdict of its own.

Of ``\mathbf{T}_2^0 = \mathbf{A}_1 \mathbf{A}_2 = [...]`` the sides that name quantities are compared with those that
are formulas or matrices. A new name that a side defines (``h = -m_2 a_1 l_2 s_2``) may stand in all others.
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from derive.checking.formulas.diagnosis import PAIRED, Question
from derive.checking.formulas.findings import Finding, Role, Skipped, compared, judge, undecidable
from derive.checking.latex import whole
from derive.checking.latex.comparing import VAGUE, Side
from derive.checking.latex.conditions import NEARLY, at_home, at_stated_numbers, certain, explaining, moves
from derive.checking.latex.equations import Sides, listed
from derive.checking.latex.left import AXES, Left, taken_apart
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.pieces import LatexPiece
from derive.checking.latex.poses import Claim, Poses, Settled, names_of_pose
from derive.checking.latex.quantities import OF_LINK, AbsoluteModel, ModelOfOneEnd, may_count_from_one_direction
from derive.checking.latex.scope import Scope
from derive.checking.latex.sides import SideReading
from derive.checking.latex.targets import Target
from derive.errors import CheckError, Location, UnknownNameError, quoted
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import Verdict, compare
from derive.model.model import Model
from derive.robot.expression import ZERO, Expression, Name, is_constant, names, substitute


@dataclass(frozen=True, slots=True)
class LatexReport:
    """What was compared in a text and what was not."""

    findings: tuple[Finding, ...]  # one for each formula and each entry of a matrix, in the order of the text
    skipped: tuple[Skipped, ...] = ()  # equations about which nothing is said
    readings: tuple[str, ...] = ()  # how the text as a whole is read, where that is not the usual way
    equations: tuple[Location, ...] = ()  # where each equation begins


LATEX = Location("<latex>")  # where a text is that stands in no file


def check_latex(
    model: Model, text: str, quantity: str = "", start: Location = LATEX, *, document: bool = False, alone: bool = False
) -> LatexReport:
    """Compare the equations of a text with what follows from a robot's table; alone if it is about no other robot."""
    document = document or "\\documentclass" in text or "\\begin{document}" in text
    if model.robot.is_tree:
        model = ModelOfOneEnd(model.robot, model.style)
    if quantity:
        model.quantity(quantity)  # refused before anything is read

    def read(model: Model, order: bool | None) -> tuple[_Check, tuple[Finding, ...]]:
        check = _Check(Scope(model, text, start, document, cosine_first=order), quantity)
        if alone:
            texts = (" ".join(text[s.start : s.end] for s in sides) for sides in check.scope.equations)
            whole.refuse_other_arm(model.robot, texts, start)
        return check, whole.divided_rows(model.robot, whole.other_factorisation(model, tuple(check.findings())))

    # what only the whole text can tell is read in each way: the usual one, or that with which more formulas are right
    order = False if document and _CAPITAL.search(text) else None
    check, findings = read(model, order)
    if order is not None:
        other = read(model, True)
        if (gain := _count(other[1], right=True) - _count(findings, right=True)) > 0:
            order, (check, findings) = True, other
            check.scope.readings.append(f"Atan2 is read with the cosine first ({gain} more formulas agree)")
    others = list[tuple[str, Model]]()
    turned = AbsoluteModel(model) if document and may_count_from_one_direction(model, text) else None
    right = (f for f in findings if f.verdict.equal and f.question and f.quantity.startswith(("T", "A", "p")))
    if turned and sum(turned.moves(f.right) for f in right) <= _count(findings, right=False):  # those would be wrong
        others.append(("those of the links from one direction", turned))
    if document and _count(findings, right=False) and (unshifted := whole.by_angles_of_table(model, text)):
        others.append(("whole cells of the table", unshifted))
    for what, its_model in others:
        other = read(its_model, order)
        gain, less = (_count(other[1], right=right) - _count(findings, right=right) for right in (True, False))
        if gain > 0 >= less:
            check, findings = other
            check.scope.readings.append(f"angles are read as {what} ({gain} more agree)")
    lone = whole.uncertain_entries(findings, model.n) if document else frozenset()
    check.skipped += (Skipped(f.location, _LONE, f.text) for f in findings if f in lone)
    findings = tuple(finding for finding in findings if finding not in lone)
    begins = tuple(check.plain.location(sides[0].start) for sides in check.scope.equations)
    findings, doubts = certain(findings, begins) if document and not quantity else (findings, ())
    check.skipped += doubts
    if not findings and not (document and check.skipped):
        skipped = check.skipped[0] if check.skipped else Skipped(start, "no formula, or only names are defined")
        remedy = "write left sides such as T_3^0 = or b_{11} =, or give the quantity"
        raise CheckError(f"no formula that can be checked: {skipped.reason}", remedy=remedy, location=skipped.location)
    return LatexReport(findings, tuple(check.skipped), tuple(check.scope.readings), begins)


def _count(findings: Sequence[Finding], *, right: bool) -> int:
    return sum(finding.verdict.equal is right and finding.unknown is None for finding in findings)


# An arctangent of two arguments in a spelling that some books give the cosine first.
_CAPITAL = re.compile(r"A(?:rc)?[Tt]an|ATAN|A\s*\}?\s*\\tan|arctan\}?\s*2|(?:\\arctan|\\tan\s*\^[^()]*)\s*\([^()]*,")
_LONE = "C is not unique, and the rest of the row is not printed"
# Parts of a sum by names of the author's own, T_c + T_p.
_PARTS = re.compile(r"(?:[\s{]*[A-Z]_(?:\w|\{[^{}+]*\})[\s}]*(?:\+|$)){2,}")
_FORCE = "where the force acts, and in which axes, is not certain"
_TWO_FORMULAS = "{} has another formula elsewhere: one of them is wrong, or it means two things"
_VECTORS = frozenset("rdpoPs")  # letters for a vector between any two points


class _Check(SideReading):
    """The comparison of one text."""

    def __init__(self, scope: Scope, quantity: str) -> None:
        super().__init__(scope, quantity)
        self.names = scope.names
        self.skipped: list[Skipped] = []
        self.around: dict[Finding, frozenset[str]] = {}  # the names that are printed in the matrix of an entry
        self.lone = len(scope.equations) - len(scope.defining) == 1

    def findings(self) -> Iterator[Finding]:
        """One for each formula and each entry of a matrix, then for names of the author's own that are quantities."""
        found = tuple(self._settled())
        yield from found
        places = {finding.location for finding in found}
        told = places | {skipped.location for skipped in self.skipped if not skipped.reason.startswith("defines ")}
        self.skipped = [s for s in self.skipped if s.location not in told or not s.reason.startswith("defines ")]
        for _, index, meaning, side in self.scope.defined() if self.document else ():
            where = self.plain.location(side.start)
            if where not in places and (by_value := self._by_value(meaning, side.text, self._typed(side), where)):
                here = {self.plain.location(s.start) for s in self.scope.equations[index]}
                self.skipped = [skipped for skipped in self.skipped if skipped.location not in here]
                yield by_value

    def _settled(self) -> Iterator[Finding]:
        """Findings; those about a pose once it is known which one is meant."""
        found = list(self._findings())
        claims = [one for one in found if isinstance(one, Claim)]
        # a position that is printed rightly says which pose its names mean
        known = any(isinstance(one, Finding) and one.quantity in ("p", "T") and one.verdict.equal for one in found)
        if (poses := self.scope.poses) and not known:
            found = self._repositioned(found, poses)
        wrong = [one for one in found if isinstance(one, Finding) and one in self.loose and not one.verdict.equal]
        if {self.loose[one] for one in wrong} == {*AXES} and not self.loose.keys() - set(wrong):
            printed = [(f.question.printed, self.loose[f], f.text, f.location) for f in wrong if f.question]
            meant = [self._by_value(*one) for one in printed]
            found = [one for one in found if one not in wrong]
            found += filter(None, meant if all(meant) else ())
            reason = "which point x, y and z are is not certain"
            self.skipped += [] if all(meant) else [Skipped(one.location, reason, one.text) for one in wrong]
        statics = [one for one in found if isinstance(one, Finding) and one.quantity.startswith("statics")]
        if self.document and not any(one.verdict.equal for one in statics):
            found = [one for one in found if one not in statics]
            self.skipped += [Skipped(one.location, _FORCE, one.text) for one in statics]
        judged = iter(poses.judged(claims, self.scope.readings, known, self._names_the_pose) if poses else ())
        for one in found:
            if isinstance(one, Finding):
                yield from self._under_conditions(one)
                continue
            # beside a formula the value of the other side says nothing
            is_lone = isinstance(one.first, Name) and not (names_of_pose(one.other) or one.is_open or one.is_branch)
            if (finding := next(judged)) is not None and (finding.verdict.equal or not one.is_condition(self.robot)):
                yield from self._under_conditions(finding)
            elif finding is not None:
                reason = f"{quoted(one.left)} = {quoted(one.right)} is a condition"
                self.skipped.append(Skipped(one.where, reason, one.right))
            elif is_lone and (by_value := self._by_value(one.other, one.left, one.right, one.where)):
                yield by_value
            elif not (one.is_open and poses and any(map(poses.is_point, one.pose_names))):
                shown = f"which pose {', '.join(sorted(one.pose_names))} means is not certain"
                reason = _TWO_FORMULAS.format(one.left) if one.is_open else shown
                self.skipped.append(Skipped(one.where, reason, one.right))

    @property
    def _names_the_pose(self) -> bool:
        """Whether the text says that r_11 ... p_z are the entries of the whole transform, and of no other one."""
        sides = (e[0] for e in self.scope.equations if any(map(whole.names_its_columns, e)))
        targets = [self.meanings.targets(left)[:1] for side in sides if (left := taken_apart(side.text))]
        every = ("T", f"T[0,{self.robot.n}]", f"T[{self.robot.n},0]")
        return bool(targets) and all(target.quantity in every for first in targets for target in first or (Target(""),))

    def _under_conditions(self, finding: Finding) -> Iterator[Finding]:
        """A verdict, right where a condition of the text makes it so; none where that is not certain to be meant."""
        line = finding.location.line - self.scope.start.line
        begin = sum(map(len, self.text.splitlines(keepends=True)[:line])) + finding.location.column
        begin -= 1 if line else self.scope.start.column
        around = self.around.get(finding, frozenset())
        condition, is_certain = explaining(self.conditions, finding, begin, self.text, around) or ("", False)
        question, shifts = finding.question, self.scope.shifts
        both: tuple[Expression, ...] = (question.printed, question.right) if question else ()
        with suppress(CheckError):
            both = (self.plain.formula(LatexPiece(finding.quantity, 0)),) if shifts and not both else both
        if not (finding.verdict.equal or shifts.keys().isdisjoint(name for e in both for name in names(e))):
            what = f"with {', '.join(shifts)} counted from another zero, as the text says"
            if question and compare(self.robot, question.printed, substitute(question.right, shifts)).equal:
                yield replace(finding, verdict=Verdict(True, True), note=f", {what}", cause="", question=None)
            elif finding.role is Role.IDENTITY:  # of which both sides may be counted so
                self.skipped.append(Skipped(finding.location, f"it may be right {what}", finding.text))
            else:
                yield finding
        elif is_certain:
            right = Verdict(equal=True, exact=False)
            yield replace(finding, verdict=right, note=f", where {condition}", cause="", question=None)
        elif condition:
            reason = f"it is right where {condition}, as the text says elsewhere, and not otherwise"
            self.skipped.append(Skipped(finding.location, reason, finding.text))
        else:
            yield finding

    def _repositioned(self, found: list[Finding | Claim], poses: Poses) -> list[Finding | Claim]:
        """Printed positions of another point than the end effector: the origin of the frame that most of them need."""
        places = {i: f for i, f in enumerate(found) if isinstance(f, Finding) and f.quantity == "p"}
        printed = {i: (f, f.question) for i, f in places.items() if f.question}
        for reading in (r for r in poses.readings[1:] if not r.reference and len(printed) > 1):
            place = self.model.quantity(f"T[{reading.position}]")[:3, 3]
            again = {}
            for i, (f, asked) in printed.items():
                right = place[f.row - 1]
                question = Question(self.robot, asked.printed, expression_from_sympy(right))
                again[i] = compared(question, f.quantity, (f.row, 0), f.role, f.text, right, f.location)
            count = sum(f.verdict.equal for f in again.values())
            if count > 1 and 2 * count > len(printed):
                self.scope.readings.append(f"{reading.shown(Settled.PLACE)} ({count} of {len(printed)} equations)")
                return [again.get(i, one) for i, one in enumerate(found)]
        return found

    def _findings(self) -> Iterator[Finding | Claim]:
        compared: set[int] = set()
        for index, equation in enumerate(self.scope.equations):
            if index in self.scope.defining:
                continue
            if self.scope.torques or any(len(meanings) > 1 for meanings in self.scope.definitions.values()):
                self.reader = self.scope.reader(index)
            if self.scope.poses is not None and self.scope.parts:
                self.scope.poses.named = next((part for i, part in reversed(self.scope.parts) if i <= index), None)
                self.reader = self.scope.reader(index)
            named = {head: left for begin, head, left in self.scope.namings if begin <= index}
            self.meanings.entries = {h: left for h, left in named.items() if left != Left(h, arguments=left.arguments)}
            told, found = len(self.skipped), list[Finding | Claim]()
            try:
                found.extend(self._equation(index, equation))
            except CheckError as error:
                if not self.document:
                    raise error.at(self.plain.location(equation[0].start)) from None
                if by_value := self.otherwise(index, equation):
                    compared.add(index)
                    del self.skipped[told:]
                    yield from by_value
                elif len(self.skipped) == told:
                    self._skip(equation[0], error)
                yield from (one for one in found if isinstance(one, Claim) or one.verdict.equal)
                continue
            compared |= {index} if found else set()
            entries = [one for one in found if isinstance(one, Finding) and one.question is not None]
            printed = frozenset(name for one in entries if one.question for name in names(one.question.printed))
            self.around |= dict.fromkeys(entries, printed)
            unknown = next((one.unknown for one in found if isinstance(one, Finding) and one.unknown), None)
            right = [one for one in found if isinstance(one, Finding) and one.verdict.equal]
            otherwise = () if unknown is None or any(map(moves, right)) else self.otherwise(index, equation)
            if otherwise and self.document:
                compared.add(index)
                yield from otherwise
            elif unknown is not None and self.document:
                if not (slips := self.misnamed(index, found)):
                    self._skip(equation[0], unknown)
                yield from slips
                known = [one for one in found if isinstance(one, Claim) or not one.unknown]
                # a side that is right as a whole stays so beside a matrix of which little can be read
                yield from known if len(right) >= VAGUE * len(found) else (f for f in right if f.question is None)
            else:
                yield from found
        if self.document:
            yield from self._said_twice()
            yield from self._defined(compared)

    def _said_twice(self) -> Iterator[Finding | Claim]:
        """Names that are given two formulas: where these are equal, that is said; otherwise a name has two meanings."""
        for name, meanings in self.scope.definitions.items():
            (_, first), *others = meanings
            for index, other in others:
                side = next(s for s in self.scope.equations[index] if (index, s.offset) not in self.names)
                claim = Claim(first, other, name, self._typed(side), self.plain.location(side.start), is_open=True)
                if is_constant(first) or is_constant(other):
                    continue  # a number that an example gives
                if names_of_pose(first, other):
                    yield claim
                elif (found := claim.read(self.robot)).verdict.equal:
                    yield found
                elif near := self._of_unknown(index, self.scope.equations[index]):
                    yield from near
                else:
                    self._skip_for(side, _TWO_FORMULAS.format(name))

    def _defined(self, compared: set[int]) -> Iterator[Finding | Claim]:
        """Points and energies of links, which other formulas take as they are defined here."""
        moving = self.rates.union(name for cell in self.robot.gravity or () for name in names(cell))
        known = set[str]()  # letters of energies of links of which one is right
        for name, _, meaning, side in self.scope.defined():
            if (left := taken_apart(side.text)) is None:
                continue
            text, where = self._typed(side), self.plain.location(side.start)
            claim = Claim(self._branch_of(left) or ZERO, meaning, name, text, where, is_branch=True)  # theta_{2,I}
            if claim.first != ZERO and (names_of_pose(meaning) or claim.read(self.robot).verdict.equal):
                yield claim if names_of_pose(meaning) else claim.read(self.robot)
                continue
            is_speed = left.head != "v" or not self.rates.isdisjoint(names(meaning))  # v_{1,x} may be of any vector
            if left.is_point and is_speed and (point := self._stands_for(left)) is not None:
                yield Claim(point, meaning, name, text, where, is_open=True)
            kinds: tuple[str, ...] = ("kinetic[", "potential[")
            if left.head in "ku" and moving.isdisjoint(names(meaning)):
                continue  # a short name
            if left.head == "V" and not self.rates.isdisjoint(names(meaning)):
                kinds = ("Cqd",)
            rights = (self.meanings.right(t) for t in self.meanings.targets(left) if t.quantity.startswith(kinds))
            if (right := next(rights, None)) is None:
                continue
            table = Table(((Entry(meaning, text, side.start),),))
            if names_of_pose(meaning):
                yield Claim(expression_from_sympy(right.value[0, 0]), meaning, right.quantity, text, where)
            elif (found := next(self._entries(right, table, side.start))).verdict.equal or (
                left.head in known and (repair := judge(found).repair) and {*PAIRED}.issuperset(repair.kinds)
            ):  # a slip, as the energy of another link is right
                known |= {left.head} if found.verdict.equal else set()
                yield found
            else:
                self._skip_for(side, f"{name} is used as it is defined here, though it is not {right.quantity}")
        alone = [one for one in self.scope.defined() if len(self.scope.definitions[one[0]]) == 1]
        for name, _, _, side in whole.unused(alone, self.scope.equations, compared):
            left = taken_apart(side.text)
            if left is None or not left.is_point or self._stands_for(left) is None:
                self._skip_for(side, f"defines {name}, which no formula uses that is compared")

    def _skip(self, side: LatexPiece, error: CheckError) -> None:
        """Tell that an equation is not compared; prose speaks of symbols, numbers and conditions all the time."""
        line = self.text[self.text.rfind("\n", 0, side.start) + 1 :].lstrip()[:1]
        if line == "|" and "=" not in self.text[side.start : side.end + 2]:
            return  # a cell of a table
        if side.inline and not re.search(r"(?s)\\partial|^(?=.*\\ddot).*\\(?:sin|cos)", side.text):
            is_given = "=" in self.text[side.end :].lstrip()[:2]
            left = taken_apart(side.text) if is_given else None
            of_angle = is_given and re.match(r"\s*\\(?:cos|sin|tan)(?![a-z])", side.text)
            rest = self.text[side.end : self.text.find("$", side.end)]
            is_solution = of_angle or re.search(r"\\(?:arc|cos|sin|tan|sqrt|operatorname)|atan2", rest)
            is_own = left is None or self.scope.is_own(left)
            is_told = (left or of_angle) and is_own and is_solution and isinstance(error, UnknownNameError)
            if not is_told and (is_own or left is None or not self.meanings.targets(left)):
                return
        self._skip_for(side, error.found, error.location)

    def _skip_for(self, side: LatexPiece, reason: str, where: Location | None = None) -> None:
        self.skipped.append(Skipped(where or self.plain.location(side.start), reason, self._typed(side)))

    def _equation(self, index: int, equation: Sides) -> Iterator[Finding | Claim]:
        if not (pieces := self.claiming(index, equation)):
            return
        for piece in equation[1:-1]:  # how a matrix is made is compared with nothing
            slopes = ["".join(cell.text.split()) for cell in piece.cells if "\\partial" in cell.text]
            if len({*slopes}) < len(slopes):
                self._skip_for(piece, "the same derivative stands in it twice")
        is_scalar_equation = not any(piece.matrices or len(listed(piece)) > 1 for piece in pieces)
        sides = [self.side(piece, len(pieces) > 1, has_points=is_scalar_equation) for piece in pieces]
        if len(sides) > 1 and all(side.value is None and side.error is None for side in sides):  # b_{12} = b_{21}
            turned = any(t.turned or t.quantity.startswith(OF_LINK) for side in sides for t in side.targets)
            sides[1:] = [self._said(side, turned) for side in sides[1:]]
        first, *others = sides = [sides[0], *(self.identity(side, sides[0]) for side in sides[1:])]
        if len(sides) == 2 and (cells := self._named_cells(*sides)):
            for name, entry in cells:
                yield from self._compared(name, Table(((entry,),)), entry.offset)
            return
        named = self._naming(sides, is_scalar_equation)
        said = [side for side in sides if side.value is not None and side not in named]
        # products and sums of named matrices beside what they are said to be
        unnamed = [side for side in sides if side not in named]
        verdicts = [self._multiplied(named, side) or self._by_names(side, named, said) for side in unnamed]
        judged = [(side, finding) for side, finding in zip(unnamed, verdicts, strict=True) if finding is not None]
        yield from (finding for _, finding in judged)
        if judged and not named and len(said) < 2:
            return
        is_theory = not (re.search("sin|cos", first.piece.text) or any(s.factors for s in named))
        if first.error is not None and not (said or judged or is_theory):
            raise first.error
        if said and isinstance(said[-1].value, Table) and self._is_configuration(first, said[-1].value):
            raise self._refused(first.piece, "a configuration, joint by joint")
        if said and said[-1].value == ZERO and any(t == Target("g") for side in named for t in side.targets):
            weightless = {name: ZERO for cell in self.robot.gravity or () for name in names(cell)}
            self._states(first.piece, f"{self._typed(first.piece)} = 0", (weightless,))
        chains = [side for side, _ in judged]
        sides, others, said = ([side for side in group if side not in chains] for group in (sides, others, said))
        for side in sides if len(sides) == 1 else others:
            if side.error is not None and side not in named:
                yield from self._unread(side, side.error, named, side is sides[-1])
        if not named and not self.asked and len(said) > 1:
            yield from self._identities(said, is_nameless=first in said)
            return
        if not named and not self.asked and (said or first.error is None):
            remedy = "write its left side, such as T_3^0 = or b_{11} =, or give the quantity"
            found = f"{quoted(self._typed(first.piece))} names no quantity of this robot" if others else "formula alone"
            raise self._refused(first.piece, found, remedy)
        if not named and others and first in said:
            said.remove(first)  # a name of the robot itself before what is asked
        yield from self._judged(named or [Side(first.piece)], said, any(side.error for side in sides))

    def _judged(self, named: list[Side], said: list[Side], is_open: bool) -> Iterator[Finding]:
        """What is said against what is named; open where another side cannot be read."""
        moving = [side for side in said if isinstance(side.value, Table) or not is_constant(side.value or ZERO)]
        # det J = a1 a2 s2 = 0 says where the arm is singular
        is_singular = self.document and any(not isinstance(side.value, Table) for side in moving)
        if self.document and any(t.is_determinant or t.quantity == "detJ" for name in named for t in name.targets):
            said = [side for side in said if side.value != ZERO]  # det J = 0 is a condition
        fitting = [s for s in said if isinstance(s.value, Table) and any(self._fitting(x, s.value)[1] for x in named)]
        # another matrix beside one of the right shape says how that is made
        said = [side for side in said if not fitting or side in fitting or not isinstance(side.value, Table)]
        is_later = right = False  # behind a side that is right
        for side in moving if is_singular else said:
            is_later = is_later or right
            text, start = self._typed(side.piece), side.piece.start
            if self.document and side.value == ZERO and (zeros := self._constant_matrix(named, False)) is not None:
                side = replace(side, value=zeros)
            formula = side.value or ZERO
            table = formula if isinstance(formula, Table) else Table(((Entry(formula, text, start),),))
            right = False  # of a name with indices, beside which a letter alone is the author's own: R_6^3 = [...] = M
            for name in named:
                if right and name.left is not None and not name.left.sub + name.left.sup + name.left.before:
                    continue
                findings = tuple(self._compared(name, table, side.piece.start))
                if self.document:
                    findings = at_home(self.robot, self._moving, table, findings)
                    findings = at_stated_numbers(self.robot, self.conditions, findings, is_later and not moving)
                if not (right := all(finding.verdict.equal for finding in findings)):
                    self._refuse_example(side, findings)
                    is_rough = is_later and self.document and NEARLY.search(self.text, max(start - 1500, 0), start)
                    if is_rough and not any(judge(finding).repair for finding in findings):
                        raise self._refused(side.piece, "an approximation of the side before it")
                    if name.left is not None and name.left.head in _VECTORS and is_open:
                        what = f"{quoted(self._typed(name.piece))} is defined by what cannot be read"
                        raise self._refused(name.piece, what)
                yield from findings

    def _unread(self, side: Side, error: CheckError, named: list[Side], is_last: bool) -> Iterator[Finding]:
        """What becomes of a side that cannot be read: one between others is passed over, the last one is refused."""
        if not is_last:
            if not (isinstance(error, UnknownNameError) and _PARTS.fullmatch(side.piece.text)):
                self._skip(side.piece, error)
        elif isinstance(error, UnknownNameError) and not self.lone and (named or self.asked):
            target = named[0].targets[0] if named else Target(self.asked)
            place = ((*target.rows, 0)[0], (*target.columns, 0)[0])
            yield undecidable(target.quantity, place, Role.PRINTED, self._typed(side.piece), error)
        else:
            raise error

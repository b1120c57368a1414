"""What the lines of a printed solution are about: which give joints, which only name quantities.

Text and LaTeX are split by their own modules into equations with sides; what is common to both stands here: the names
that may occur, and how ``alpha = theta1 + theta2 - theta4 = atan2(r12, r11)`` becomes lines.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

from derive.checking.formulas.branches import SIGN
from derive.checking.formulas.findings import Skipped
from derive.checking.inverse.poses import PoseNames
from derive.checking.inverse.printed import PrintedFormula, PrintedInverse, PrintedLine, closeness
from derive.checking.latex.names import sum_of_angles
from derive.errors import CheckError, Location, UnknownNameError, listed, near_miss, quoted
from derive.lecture.shorthand import notation_text, resolve_tokens
from derive.robot.expression import ZERO, Call, Expression, Name, Number, add, names, negate
from derive.robot.names import joint_label, own_names
from derive.robot.robot import Robot

_JOINT = re.compile(r"(vartheta|theta|th|q|d)([0-9]+)")
_SUM = re.compile(r"(?:vartheta|theta|th|q)([0-9]{2,})")
_CIRCULAR = re.compile(r"([cCsS])([0-9]+)")
_SIGN_NAME = re.compile(r"(?:sgn|sign|eps|epsilon|varepsilon|sigma)[0-9]*")


@dataclass(frozen=True)
class Alternative:
    """One of the alternatives that a side of an equation is."""

    text: str  # as it is printed
    location: Location  # where it stands
    read: Callable[[Mapping[str, Expression]], Expression]  # reads it with some names and what they stand for


@dataclass(frozen=True)
class Side:
    """One side of an equation."""

    parts: tuple[Alternative, ...]  # its alternatives, mostly one
    word: str = ""  # the name that it is, on one line; empty of a formula
    primed: bool = False  # whether that name has a prime
    formulas: tuple[PrintedFormula, ...] = ()  # what its alternatives say, once they are read

    @property
    def expression(self) -> Expression:
        """What the first alternative says."""
        return self.formulas[0].expression

    def read(self, meanings: Mapping[str, Expression]) -> Side:
        """With its formulas, in names whose meanings are known."""
        formulas = (PrintedFormula(part.read(meanings), part.text, part.location) for part in self.parts)
        return replace(self, formulas=tuple(formulas))


@dataclass
class Vocabulary:
    """The names of one printed solution."""

    robot: Robot  # whose solution it is
    pose: PoseNames  # the names of the pose
    # What names stand for that the robot itself does not have.
    meanings: dict[str, Expression] = field(default_factory=dict)
    sums: dict[str, Expression] = field(default_factory=dict)  # names of sums of joint variables
    new: set[str] = field(default_factory=set)  # names that the solution gives itself

    @classmethod
    def of(cls, robot: Robot, words: Sequence[str], defined: Sequence[str]) -> Vocabulary:
        """The names among the words of a text."""
        own = own_names(robot)
        found = cls(robot, PoseNames.of(robot, words))
        for word in dict.fromkeys(words):
            if word not in own and word not in found.pose.meanings:
                found._learn(word)
        found.new = {w for w in defined if w not in own and (w in found.pose.meanings or w not in found.meanings)}
        found.new -= {w for w in found.new if w in found.pose.angles or found._is_token(w)}
        found.meanings |= {**found.pose.meanings, **{word: Name(word) for word in found.new}}
        return found

    def _learn(self, word: str) -> None:
        """A word that is a joint variable, a sum of them, a cosine or sine, or a sign."""
        flat = word.replace("_", "")
        match = _JOINT.fullmatch(flat)
        joints = [j for j in self.robot.joints if match is not None and joint_label(j.variable) == match[2]]
        fitting = [j for j in joints if match and (match[1] == "q" or (match[1] == "d") is not j.is_revolute)]
        if _SIGN_NAME.fullmatch(flat):
            self.meanings[word] = Name(SIGN + flat)
        elif fitting:
            self.meanings[word] = Name(fitting[0].variable)
        elif match := _SUM.fullmatch(flat):
            if terms := sum_of_angles(self.robot, match[1]):
                self.sums[word], self.meanings[word] = add(*terms), Name(word)
        elif (match := _CIRCULAR.fullmatch(flat)) and flat != word:
            self.meanings[word] = resolve_tokens(Name(match[1].lower() + match[2]), self.robot)
        elif match and match[1].isupper():
            self.meanings[word] = resolve_tokens(Name(flat.lower()), self.robot)

    def _is_token(self, word: str) -> bool:
        """Whether a word such as c2 is the cosine or sine of joint angles."""
        with suppress(CheckError):
            return isinstance(resolve_tokens(Name(word), self.robot), Call)
        return False

    def is_forward(self, word: str, e: Expression) -> bool:
        """Whether an equation is one of the forward kinematics: an entry of the pose by joint variables alone."""
        is_plain = self.pose.entries.keys().isdisjoint(names(e)) and self.new.isdisjoint(names(e))
        return word in self.pose.entries and is_plain and self.has_joints(e)

    def has_joints(self, e: Expression) -> bool:
        """Whether joint variables occur in an expression."""
        return not {*self.sums, *(joint.variable for joint in self.robot.joints)}.isdisjoint(names(e))


def assembled(
    robot: Robot, equations: Sequence[Sequence[Side]], words: Sequence[str], refused: list[Skipped] | None = None
) -> tuple[PrintedInverse, Vocabulary]:
    """The lines of a printed solution; equations that are not understood go to refused, None to refuse the whole."""
    defined = [side.word for sides in equations for side in sides if side.word]
    vocabulary = Vocabulary.of(robot, words, defined)
    lines: list[PrintedLine] = []
    for sides in equations:
        before = len(lines)
        try:
            found_here = tuple(_lines(vocabulary, [side.read(vocabulary.meanings) for side in sides]))
        except CheckError as error:
            if refused is None:
                raise
            refused.append(Skipped(error.location or sides[0].parts[0].location, error.found))
            continue
        for line in found_here:
            _merge(lines, line, before)
    for i, line in enumerate(lines):
        if isinstance(line.target, Name):
            # an alternative such as ``q4 + pi`` means the first one by the unknown's own name
            own, (first, *others) = line.target.name, line.formulas
            others = [replace(f, first=own if own in names(f.expression) else "") for f in others]
            lines[i] = replace(line, formulas=(first, *others))
    found = PrintedInverse(robot, lines, vocabulary.sums, closeness(lines))
    found.check_size()
    # a name that stands alone on a side and that no line defines
    unknown = vocabulary.new.difference(found.named, vocabulary.pose.meanings)
    for formula in (formula for line in found.lines for formula in line.formulas):
        for name in (name for name in names(formula.expression) if name in unknown):
            known = listed(dict.fromkeys((*found.named, *(joint.variable for joint in robot.joints))))
            remedy = near_miss(name, found.named) or f"write a line {name} = ..."
            what = f"unknown name {quoted(name)}"
            raise UnknownNameError(what, allowed=f"known: {known}", remedy=remedy, location=formula.location)
    if not found.given:
        where = equations[0][0].parts[0].location if equations else None
        variables = ", ".join(joint.variable for joint in robot.joints)
        remedy = "write left sides such as theta1 = or q1 ="
        raise CheckError("no line gives a joint variable", allowed=f"of {variables}", remedy=remedy, location=where)
    return found, vocabulary


def _lines(vocabulary: Vocabulary, sides: Sequence[Side]) -> Iterator[PrintedLine]:
    """The lines that one equation makes."""
    first, *others = sides
    joints = vocabulary.has_joints
    if others and first.primed:
        if not joints(first.expression):
            where = first.formulas[0].location
            raise CheckError("prime of a name that is not a joint variable", remedy="remove it", location=where)
        yield replace(_about(vocabulary, first, others[0].formulas), primed=True)
        return
    if not others:
        where = first.formulas[0].location
        raise CheckError("formula without a left side", remedy="write theta1 = ...", location=where)
    if first.word in vocabulary.new and not vocabulary.is_forward(first.word, others[0].expression):
        # D = ... defines a name; a further side with joint variables, D = ... = cos(theta2), is a line about them
        value = next((side for side in others if not joints(side.expression)), others[0])
        yield PrintedLine(first.word, value.formulas, name=first.word)
        for side in others:
            if side is not value and joints(side.expression):
                about = PrintedFormula(first.expression, first.formulas[0].text, value.formulas[0].location)
                yield _about(vocabulary, side, (about,))
        return
    # otherwise the side with joint variables is what the others give; the first one is taken where several have some
    target = first if joints(first.expression) else next((side for side in others if joints(side.expression)), None)
    if target is None:  # a condition of the pose
        return
    rest = [side for side in (first, *others) if side is not target]
    for side, after in zip(rest, (*rest[1:], None), strict=True):
        if side.word in vocabulary.new and after is not None:  # alpha, between what it is and its formula
            yield PrintedLine(side.word, after.formulas, name=side.word)
            continue
        yield _about(vocabulary, target, side.formulas)


def _about(vocabulary: Vocabulary, target: Side, formulas: tuple[PrintedFormula, ...]) -> PrintedLine:
    """A line about joint variables; of an equation with named quantities on both sides, that its sides are equal."""
    e = target.expression
    what = notation_text(e, vocabulary.robot)
    if any(name in vocabulary.new or name[0] == SIGN for name in names(e)):
        # r*cos(theta1) = x with a printed r: the difference of both sides must be zero
        whole = tuple(replace(f, expression=add(e, negate(f.expression))) for f in formulas)
        return PrintedLine(what, whole, ZERO)
    return PrintedLine(what, formulas, e)


def _merge(lines: list[PrintedLine], line: PrintedLine, before: int) -> None:
    """One line more, or further alternatives of one that an equation before has."""
    for i, other in enumerate(lines[:before]):
        same = other.name == line.name if line.target is None else other.target == line.target
        same = same and other.primed is line.primed and (other.target is None) is (line.target is None)
        if same and not isinstance(line.target, Number):
            known = {formula.expression for formula in other.formulas}
            new = tuple(f for f in line.formulas if f.expression not in known)
            lines[i] = replace(other, formulas=(*other.formulas, *new))
            return
    lines.append(line)

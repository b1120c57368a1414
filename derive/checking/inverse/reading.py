"""What the lines of a printed solution are about: which give joints, which only name quantities.

Common to plain text and LaTeX are the names that may occur, and how ``alpha = theta1 + theta2 = atan2(r12, r11)``
becomes lines. Plain text has one quantity a line, the order free; it is rewritten for the grammar of formulas.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial

from derive.checking.formulas.branches import SIGN
from derive.checking.formulas.findings import Skipped
from derive.checking.inverse.poses import PoseNames
from derive.checking.inverse.printed import PrintedFormula, PrintedInverse, PrintedLine, closeness
from derive.checking.latex.equations import equations
from derive.checking.latex.formula import LatexReader
from derive.checking.latex.left import taken_apart
from derive.checking.latex.names import FLAT, LatexNames, PlusMinus, sum_of_angles
from derive.checking.latex.pieces import MATRIX_MARK, LatexPiece
from derive.errors import CheckError, Location, UnknownNameError, listed, near_miss, quoted
from derive.lecture.shorthand import notation_text, read_formula, resolve_tokens
from derive.robot.expression import ZERO, Call, Expression, Name, Number, add, names, negate
from derive.robot.names import joint_label, own_names
from derive.robot.parser import FORMULA_FUNCTIONS, place
from derive.robot.robot import Robot


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
    meanings: dict[str, Expression] = field(default_factory=dict)  # what names stand for that the robot does not have
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
        match = re.fullmatch(r"(vartheta|theta|th|q|d)([0-9]+)", flat)
        joints = [j for j in self.robot.joints if match is not None and joint_label(j.variable) == match[2]]
        fitting = [j for j in joints if match and (match[1] == "q" or (match[1] == "d") is not j.is_revolute)]
        if re.fullmatch(r"(?:sgn|sign|eps|epsilon|varepsilon|sigma)[0-9]*", flat):
            self.meanings[word] = Name(SIGN + flat)
        elif fitting:
            self.meanings[word] = Name(fitting[0].variable)
        elif match := re.fullmatch(r"(?:vartheta|theta|th|q)([0-9]{2,})", flat):
            if terms := sum_of_angles(self.robot, match[1]):
                self.sums[word], self.meanings[word] = add(*terms), Name(word)
        elif (match := re.fullmatch(r"([cCsS])([0-9]+)", flat)) and flat != word:
            self.meanings[word] = resolve_tokens(Name(match[1].lower() + match[2]), self.robot)
        elif match and match[1].isupper():
            self.meanings[word] = resolve_tokens(Name(flat.lower()), self.robot)

    def _is_token(self, word: str) -> bool:
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
    vocabulary = Vocabulary.of(robot, words, [side.word for sides in equations for side in sides if side.word])
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
    first, *others = sides
    joints, where = vocabulary.has_joints, first.formulas[0].location
    if others and first.primed:
        if not joints(first.expression):
            raise CheckError("prime of a name that is not a joint variable", remedy="remove it", location=where)
        yield replace(_about(vocabulary, first, others[0].formulas), primed=True)
        return
    if not others:
        raise CheckError("formula without a left side", remedy="write theta1 = ...", location=where)
    if first.word in vocabulary.new and not vocabulary.is_forward(first.word, others[0].expression):
        # D = ... defines a name; a further side with joint variables, D = ... = cos(theta2), is a line about them
        value = next((side for side in others if not joints(side.expression)), others[0])
        yield PrintedLine(first.word, value.formulas, name=first.word)
        for side in others:
            if side is not value and joints(side.expression):
                same = replace(first.formulas[0], location=value.formulas[0].location)
                yield _about(vocabulary, side, (same,))
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
        return PrintedLine(what, tuple(replace(f, expression=add(e, negate(f.expression))) for f in formulas), ZERO)
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


# Inverse functions of one argument by the names that they have.
INVERSE = {"acos": "acos", "arccos": "acos", "asin": "asin", "arcsin": "asin", "atan": "atan", "arctan": "atan"}
COSINE_MAY_BE_FIRST = "Atan2"  # an arctangent of two arguments whose order depends on the book: A tan, ArcTan
MAX_LINES = 200  # lines of one solution
WORD = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TOKEN = re.compile(
    r"(?P<plus>\+/-|\+-|±)|(?P<minus>-/\+|-\+|∓)|(?P<degrees>°)"
    r"|(?P<tan>A[ ]tan(?=\s*\())|(?P<word>[A-Za-z][A-Za-z0-9_]*)|(?P<other>.)",
    re.DOTALL,
)
_OR = re.compile(r"(?<![A-Za-z0-9_])(?:or|oppure|ou)(?![A-Za-z0-9_])")
_LEAD = re.compile(r"\s*(?:where|with|and|dove|con|e|onde|com)\s+(?=[A-Za-z])")
_NEXT = re.compile(
    r",(?=\s*(?:where\s+|with\s+|and\s+)?(?:[A-Za-z][A-Za-z0-9_]*|(?:cos|sin|tan)\([A-Za-z0-9_]*\))\s*=)"
)


def text_equations(text: str, robot: Robot, start: Location, signs: PlusMinus) -> tuple[list[list[Side]], list[str]]:
    """The equations of a text, one on a line or between semicolons."""
    found: list[list[Side]] = []
    text = re.sub(r"#[^\n]*", lambda match: " " * len(match[0]), text)
    lines = _cut(text, 0, len(text), re.compile(r"[\n;]"), everywhere=True)
    for begin, end in (span for line in lines for span in _cut(text, *line, _NEXT) if text[slice(*span)].strip()):
        lead = _LEAD.match(text, begin, end)
        sides = _cut(text, lead.end() if lead else begin, end, re.compile("="))
        if len(sides) < 2 or any(not text[a:b].strip() for a, b in sides):
            where = place(text, begin + len(text[begin:end]) - len(text[begin:end].lstrip()), start)
            remedy = "write theta1 = ..., one quantity a line"
            raise CheckError("a line is not an equation", remedy=remedy, location=where)
        found.append([_side(text, span, robot, start, signs) for span in sides])
        if len(found) > MAX_LINES:
            raise CheckError("too many lines", allowed=f"allowed: at most {MAX_LINES}", location=start)
    return found, WORD.findall(text)


def _cut(text: str, begin: int, end: int, at: re.Pattern[str], everywhere: bool = False) -> list[tuple[int, int]]:
    """The parts of a text between signs that stand outside of brackets."""
    cuts = [begin]
    for match in at.finditer(text, begin, end):
        before = text[begin : match.start()]
        if everywhere or before.count("(") == before.count(")"):
            cuts += [match.start(), match.end()]
    return list(zip(cuts[::2], [*cuts[1::2], end], strict=True))


def _side(text: str, span: tuple[int, int], robot: Robot, start: Location, signs: PlusMinus) -> Side:
    whole = text[slice(*span)].strip()
    if is_primed := len(whole) > 1 and whole[-1] in "'\u2032\u2019" and bool(WORD.fullmatch(whole[:-1])):
        whole = whole[:-1]
        span = span[0], span[0] + text[slice(*span)].index(whole) + len(whole)
    parts = []
    for begin, end in _cut(text, *span, _OR):
        shown = text[begin:end].strip()
        where = place(text, begin + len(text[begin:end]) - len(text[begin:end].lstrip()), start)
        parts.append(Alternative(shown, where, partial(_formula, shown, robot, where, signs)))
    return Side(tuple(parts), whole if WORD.fullmatch(whole) else "", is_primed)


def _formula(
    text: str, robot: Robot, where: Location, signs: PlusMinus, meanings: Mapping[str, Expression]
) -> Expression:
    """A formula, with errors at places of the text as it was typed."""
    known = dict(meanings)
    rewritten, origins = _rewritten(text, known, signs)
    functions = FORMULA_FUNCTIONS | {*INVERSE.values(), COSINE_MAY_BE_FIRST}
    try:
        return read_formula(rewritten, robot, Location(""), known, functions)
    except CheckError as error:
        column = error.location.column - 1 if error.location else 0
        offset = origins[column] if column < len(origins) else len(text)
        found = error.found.replace(repr(rewritten), repr(text)) if len(rewritten) < 40 else error.found
        there = place(text, offset, where)
        raise type(error)(found, allowed=error.allowed, remedy=error.remedy, location=there) from None


def _rewritten(text: str, known: dict[str, Expression], signs: PlusMinus) -> tuple[str, Sequence[int]]:
    """The text in the grammar of formulas, and where each of its characters comes from."""
    pieces: list[tuple[str, int]] = []
    for match in _TOKEN.finditer(text):
        kind, token = match.lastgroup, match[0]
        if kind in ("plus", "minus"):
            name = f"plusminus{len(pieces)}"
            known[name] = next(signs)
            token = f"{'+' if kind == 'plus' else '-'}{name}*"
        elif kind == "degrees":
            token = "*pi/180"
        elif kind in ("word", "tan") and text[match.end() :].lstrip()[:1] == "(":
            token = _function(token, text[match.end() :])
        pieces.append((" " if token in "\n\r\t" else token, match.start()))
    return "".join(token for token, _ in pieces), [offset for token, offset in pieces for _ in token]


def _function(word: str, behind: str) -> str:
    """What a function is called in the grammar, whose arguments stand behind it."""
    plain = word.lower().replace("_", "").replace(" ", "")
    depth = 0
    for letter in behind if plain in ("atan2", "arctan2", "atan", "arctan") else "":
        depth += {"(": 1, ")": -1}.get(letter, 0)
        if letter == "," and depth == 1:  # two arguments: a comma that is not in brackets of its own
            return "atan2" if plain.endswith("2") and word[0] == "a" else COSINE_MAY_BE_FIRST
        if letter == ")" and depth == 0:
            break
    return INVERSE.get(plain, plain if plain in ("sqrt", "sin", "cos", "tan") else word)


_OR_MARK = "\ue0f0"  # stands for the word between alternatives
_LATEX_OR = re.compile(r"\\(?:text|textrm|mathrm|mbox)\s*\{\s*(?:or|oppure|ou|o)\s*\}|\\(?:lor|vee)(?![A-Za-z])")
_PRIME = re.compile(r"(?:\^\s*(?:\\prime(?![A-Za-z])|\{\s*\\prime\s*\})|')\s*$")
_NAME = re.compile(
    r"(\\(?:math[a-z]+|text[a-z]*|operatorname\*?)\s*\{\s*[A-Za-z]+\s*\}|\\[A-Za-z]+|(?<![A-Za-z\\])[A-Z]{2}(?=\s*_)"
    r"|[A-Za-z\u0391-\u03c9])"
    r"\s*((?:_\s*(?:\{(?:[^{}]|\{[^{}]*\})*\}|\\[A-Za-z]+|[A-Za-z0-9]))?)"
)


def latex_equations(
    text: str, robot: Robot, start: Location, signs: PlusMinus, *, document: bool
) -> tuple[list[list[Side]], list[str]]:
    """The equations of a LaTeX text."""
    marked = _LATEX_OR.sub(lambda match: _OR_MARK.ljust(len(match[0])), text)
    found = equations(marked, start, document=document, time=False)
    return [[_latex_side(piece, text, robot, start, signs) for piece in e] for e in found], list(printed_words(text))


def gives_joints(text: str, robot: Robot) -> bool:
    r"""Whether a text is a printed solution: a left side is a joint variable, and an arc function stands somewhere."""
    if not re.search(r"(?i)a(?:rc)?\s*\\?tan|arc(?:cos|sin)|\^\s*\{\s*-\s*1\s*\}", text):
        return False
    labels = "|".join(re.escape(joint.variable.lstrip("qdthea_")) or "x" for joint in robot.joints)
    return bool(re.search(rf"(?:^|[\s&$,;{{])(?:\\(?:var)?theta|q)\s*_\s*\{{?\s*(?:{labels})\s*\}}?\s*&?\s*=", text))


def printed_words(text: str) -> Iterator[str]:
    """Names on the line: ``p_{Wx}`` as pWx."""
    for match in _NAME.finditer(text):
        braced = re.fullmatch(r"\\[a-z]+\*?\s*\{\s*([A-Za-z]+)\s*\}", match[1])
        head = braced[1] if braced else match[1].removeprefix("\\")
        sub = re.sub(r"\\[a-z]+(?=\s*\{)|[^A-Za-z0-9]", "", match[2])
        yield FLAT.get(head, head) + sub
        yield FLAT.get(head, head)
        if head in ("c", "s") and sub:  # c_\phi
            yield head + FLAT.get(sub, sub)


def _latex_side(piece: LatexPiece, text: str, robot: Robot, start: Location, signs: PlusMinus) -> Side:
    left = None if piece.matrices or _OR_MARK in piece.text else taken_apart(piece.text)
    plain = _PRIME.sub(lambda match: " " * len(match[0]), piece.text)
    if is_primed := plain != piece.text and taken_apart(plain) is not None:
        piece, left = replace(piece, text=plain), taken_apart(plain)
    word = left.flat if left is not None and left.is_plain and not left.arguments else ""
    # alternatives are the first column of cases, or what stands between the words or
    of_cases = [row[0] for row in piece.matrices[0].rows] if piece.text.strip() == MATRIX_MARK else None

    def formula(part: LatexPiece, meanings: Mapping[str, Expression]) -> Expression:
        own = own_names(robot)
        known = {name: meaning for name, meaning in meanings.items() if name not in own}
        return LatexReader(LatexNames(robot, known, signs=signs), text, start).formula(part)

    shown = ((part, " ".join(text[part.start : part.end].split())) for part in of_cases or piece.split(_OR_MARK))
    parts = (Alternative(said, place(text, part.start, start), partial(formula, part)) for part, said in shown)
    return Side(tuple(parts), word, is_primed)

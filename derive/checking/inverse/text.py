"""Printed solutions as plain text: ``theta2 = atan2(+-sqrt(1 - D**2), D)``, one quantity a line, the order free.

What the grammar of formulas does not have is rewritten before it is parsed, and places are those of the text as it was
typed: a plus-minus is a factor, ``arctan2`` and ``Atan2`` are atan2, ``acos`` and its like are functions.
"""

import re
from collections.abc import Mapping, Sequence
from functools import partial

from derive.checking.inverse.reading import Alternative, Side
from derive.checking.latex.names import PlusMinus
from derive.errors import CheckError, Location
from derive.lecture.shorthand import read_formula
from derive.robot.expression import Expression
from derive.robot.parser import FORMULA_FUNCTIONS, place
from derive.robot.robot import Robot

# Inverse functions of one argument by the names that they have.
INVERSE = {"acos": "acos", "arccos": "acos", "asin": "asin", "arcsin": "asin", "atan": "atan", "arctan": "atan"}
# How a two-argument arctangent is called whose order depends on the book: Atan2, A tan, ArcTan.
COSINE_MAY_BE_FIRST = "Atan2"
MAX_LINES = 200  # lines of one solution
WORD = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TOKEN = re.compile(
    r"(?P<plus>\+/-|\+-|±)|(?P<minus>-/\+|-\+|∓)|(?P<degrees>°)"
    r"|(?P<tan>A[ ]tan(?=\s*\())|(?P<word>[A-Za-z][A-Za-z0-9_]*)|(?P<other>.)",
    re.DOTALL,
)
_COMMENT = re.compile(r"#[^\n]*")
_OR = re.compile(r"(?<![A-Za-z0-9_])(?:or|oppure|ou)(?![A-Za-z0-9_])")
_LEAD = re.compile(r"\s*(?:where|with|and|dove|con|e|onde|com)\s+(?=[A-Za-z])")
_NEXT = re.compile(
    r",(?=\s*(?:where\s+|with\s+|and\s+)?(?:[A-Za-z][A-Za-z0-9_]*|(?:cos|sin|tan)\([A-Za-z0-9_]*\))\s*=)"
)


def text_equations(text: str, robot: Robot, start: Location, signs: PlusMinus) -> tuple[list[list[Side]], list[str]]:
    """The equations of a text, one on a line or between semicolons."""
    found: list[list[Side]] = []
    text = _COMMENT.sub(lambda match: " " * len(match[0]), text)
    lines = _cut(text, 0, len(text), re.compile(r"[\n;]"), everywhere=True)
    spans = [span for line in lines for span in _cut(text, *line, _NEXT) if text[slice(*span)].strip()]
    for begin, end in spans:
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
    is_primed = len(whole) > 1 and whole[-1] in "'\u2032\u2019" and bool(WORD.fullmatch(whole[:-1]))
    if is_primed:
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
    own = Location("")
    functions = FORMULA_FUNCTIONS | {*INVERSE.values(), COSINE_MAY_BE_FIRST}
    try:
        return read_formula(rewritten, robot, own, known, functions)
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
    origins = [offset for token, offset in pieces for _ in token]
    return "".join(token for token, _ in pieces), origins


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

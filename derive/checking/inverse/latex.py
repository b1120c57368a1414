r"""Printed solutions in LaTeX: ``\theta_2 = \operatorname{atan2}(\pm\sqrt{1 - D^2}, D)``, displays and documents."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

from derive.checking.inverse.reading import Alternative, Side
from derive.checking.latex.equations import equations
from derive.checking.latex.formula import LatexReader
from derive.checking.latex.left import taken_apart
from derive.checking.latex.names import FLAT, LatexNames, PlusMinus
from derive.checking.latex.pieces import MATRIX_MARK, LatexPiece
from derive.errors import Location
from derive.robot.expression import Expression
from derive.robot.names import own_names
from derive.robot.parser import place
from derive.robot.robot import Robot

_OR_MARK = "\ue0f0"  # stands for the word between alternatives
_OR = re.compile(r"\\(?:text|textrm|mathrm|mbox)\s*\{\s*(?:or|oppure|ou|o)\s*\}|\\(?:lor|vee)(?![A-Za-z])")
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
    marked = _OR.sub(lambda match: _OR_MARK.ljust(len(match[0])), text)
    found = equations(marked, start, document=document, time=False)
    return [[_side(piece, text, robot, start, signs) for piece in e] for e in found], list(printed_words(text))


def gives_joints(text: str, robot: Robot) -> bool:
    r"""Whether a text is a printed solution: a left side is a joint variable, and an arc function stands somewhere."""
    if not re.search(r"(?i)a(?:rc)?\s*\\?tan|arc(?:cos|sin)|\^\s*\{\s*-\s*1\s*\}", text):
        return False
    labels = "|".join(re.escape(joint.variable.lstrip("qdthea_")) or "x" for joint in robot.joints)
    return bool(re.search(rf"(?:^|[\s&$,;{{])(?:\\(?:var)?theta|q)\s*_\s*\{{?\s*(?:{labels})\s*\}}?\s*&?\s*=", text))


def printed_words(text: str) -> Iterator[str]:
    """Names on the line: ``p_{Wx}`` as pWx."""
    for match in _NAME.finditer(text):
        head = match[1]
        if braced := re.fullmatch(r"\\[a-z]+\*?\s*\{\s*([A-Za-z]+)\s*\}", head):
            head = braced[1]
        head = head.removeprefix("\\")
        sub = re.sub(r"\\[a-z]+(?=\s*\{)|[^A-Za-z0-9]", "", match[2])
        yield FLAT.get(head, head) + sub
        yield FLAT.get(head, head)
        if head in ("c", "s") and sub:  # c_\phi
            yield head + FLAT.get(sub, sub)


def _side(piece: LatexPiece, text: str, robot: Robot, start: Location, signs: PlusMinus) -> Side:
    left = None if piece.matrices or _OR_MARK in piece.text else taken_apart(piece.text)
    plain = _PRIME.sub(lambda match: " " * len(match[0]), piece.text)
    is_primed = plain != piece.text and taken_apart(plain) is not None
    if is_primed:
        piece, left = replace(piece, text=plain), taken_apart(plain)
    word = left.flat if left is not None and left.is_plain and not left.arguments else ""
    # alternatives are the first column of cases, or what stands between the words or
    of_cases = [row[0] for row in piece.matrices[0].rows] if piece.text.strip() == MATRIX_MARK else None

    def formula(part: LatexPiece, meanings: Mapping[str, Expression]) -> Expression:
        own = own_names(robot)
        known = {name: meaning for name, meaning in meanings.items() if name not in own}
        return LatexReader(LatexNames(robot, known, signs=signs), text, start).formula(part)

    parts = []
    for part in of_cases or piece.split(_OR_MARK):
        shown = " ".join(text[part.start : part.end].split())
        parts.append(Alternative(shown, place(text, part.start, start), partial(formula, part)))
    return Side(tuple(parts), word, is_primed)

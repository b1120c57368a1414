"""Cell text to tokens; every character that is not in the grammar is refused with what to write instead."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum

from derive.errors import ExpressionError, Location
from derive.robot.limits import Limits
from derive.robot.wording import quoted


class TokenKind(Enum):
    """What a token is."""

    NUMBER = "number"
    NAME = "name"
    OPERATOR = "operator"
    END = "end"


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of the text and where it begins (0-based offset)."""

    kind: TokenKind
    text: str
    offset: int


_TOKEN = re.compile(
    r"(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]*)"
    r"|(?P<operator>\*\*|[-+*/(),])"
)
_SPACE = re.compile(r"[ \t\r\n]+")

_REMEDIES = {
    "^": "write ** for powers",
    "²": "write **2",
    "³": "write **3",
    "π": "write pi",
    "°": "write 'units: {angle: deg}' in the file and plain numbers in the cells",
    "√": "write sqrt(...)",
    "·": "write * for products",
    "\u00d7": "write * for products",
    "÷": "write / for quotients",
    "\u2212": "write the ASCII minus sign -",
    "\u2013": "write the ASCII minus sign -",
    "\u2014": "write the ASCII minus sign -",
    "[": "use parentheses ( )",
    "{": "use parentheses ( )",
    "_": "a name begins with a letter; write numbers without _",
    "=": "write only the right-hand side",
    "'": "remove the quotation mark",
    "\u2019": "remove the prime",
    '"': "remove the quotation mark",
}
_GRAMMAR = "allowed: integers, decimals, names, + - * / **, parentheses, pi, sin cos tan sqrt"


def place(text: str, offset: int, start: Location) -> Location:
    """The location of ``text[offset]`` when ``text`` begins at ``start``."""
    newlines = text.count("\n", 0, offset)
    if newlines == 0:
        return Location(start.source, start.line, start.column + offset)
    return Location(start.source, start.line + newlines, offset - text.rfind("\n", 0, offset))


def tokenize(text: str, start: Location, limits: Limits) -> tuple[Token, ...]:
    """Split an expression into tokens.

    Args:
        text: The expression.
        start: Where its first character stands.
        limits: Bounds on length and number of tokens.

    Returns:
        The tokens, the last one of kind END.

    Raises:
        ExpressionError: A character outside the grammar, or a limit exceeded.
    """
    if len(text) > limits.text_length:
        raise ExpressionError(
            f"expression of {len(text)} characters",
            allowed=f"allowed: at most {limits.text_length}",
            remedy="introduce a parameter for part of it",
            location=start,
        )
    tokens: list[Token] = []
    offset = 0
    while (offset := _skip_space(text, offset)) < len(text):
        tokens.append(_next_token(text, offset, start))
        offset += len(tokens[-1].text)
        if len(tokens) > limits.tokens:
            raise ExpressionError(
                f"expression with more than {limits.tokens} numbers, names and signs",
                remedy="introduce a parameter for part of it",
                location=start,
            )
    return (*tokens, Token(TokenKind.END, "", len(text)))


def _skip_space(text: str, offset: int) -> int:
    match = _SPACE.match(text, offset)
    return match.end() if match else offset


def _next_token(text: str, offset: int, start: Location) -> Token:
    match = _TOKEN.match(text, offset)
    if match is None or match.lastgroup is None:
        raise _unexpected_character(text, offset, start)
    return Token(TokenKind(match.lastgroup), match.group(), offset)


def _unexpected_character(text: str, offset: int, start: Location) -> ExpressionError:
    character = text[offset]
    code = "" if character.isascii() else f" (U+{ord(character):04X})"
    remedy = _REMEDIES.get(character, "")
    if not remedy and character.isalpha():
        remedy = "names use the letters A-Z and a-z, digits and _ only; letters that look alike are different letters"
    return ExpressionError(
        f"unexpected character {quoted(character)}{code} in {quoted(text)}",
        allowed=_GRAMMAR,
        remedy=remedy,
        location=place(text, offset, start),
    )

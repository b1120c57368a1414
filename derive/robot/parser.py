"""The cell grammar: text to an exact expression tree, by recursive descent over own tokens.

    sum     := product (("+" | "-") product)*
    product := sign (("*" | "/") sign)*
    sign    := ("+" | "-") sign | power
    power   := atom ["**" sign]          the exponent folds to an integer; ** binds to the right
    atom    := number | "pi" | name | function "(" sum ("," sum)* ")" | "(" sum ")"

``-x**2`` is ``-(x**2)``; there is no implicit multiplication. Users' text is never handed to Python or SymPy. Every
character and every construction that is not in the grammar is refused with what to write instead.
"""

import re
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from typing import Final

from derive.errors import ExpressionError, Location, listed, near_miss, quoted
from derive.robot import expression as tree
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power
from derive.robot.reading.size_limits import CELL_LIMITS, FILE_LIMITS, Limits

TokenKind = StrEnum("TokenKind", ("NUMBER", "NAME", "OPERATOR", "END"))


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
    **dict.fromkeys("·\u00d7", "write * for products"),
    "÷": "write / for quotients",
    **dict.fromkeys("\u2212\u2013\u2014", "write the ASCII minus sign -"),
    **dict.fromkeys("[{", "use parentheses ( )"),
    "_": "a name begins with a letter; write numbers without _",
    "=": "write only the right-hand side",
    "\u2019": "remove the prime",
    **dict.fromkeys("'\"", "remove the quotation mark"),
}
_LETTERS = "names use the letters A-Z and a-z, digits and _ only; letters that look alike are different letters"
_GRAMMAR = "allowed: integers, decimals, names, + - * / **, parentheses, pi, sin cos tan sqrt"


def place(text: str, offset: int, start: Location) -> Location:
    """The place of a character in its file."""
    # On later lines of a block scalar columns count from its own line, on the first one from where the cell begins.
    newlines = text.count("\n", 0, offset)
    if newlines == 0:
        return Location(start.source, start.line, start.column + offset)
    return Location(start.source, start.line + newlines, offset - text.rfind("\n", 0, offset))


def tokenize(text: str, start: Location, limits: Limits) -> tuple[Token, ...]:
    """Split an expression into tokens."""
    shorter = "introduce a parameter for part of it"
    if len(text) > limits.text_length:
        found, allowed = f"expression of {len(text)} characters", f"allowed: at most {limits.text_length}"
        raise ExpressionError(found, allowed=allowed, remedy=shorter, location=start)
    tokens: list[Token] = []
    offset = 0
    while offset < len(text):
        if space := _SPACE.match(text, offset):
            offset = space.end()
            continue
        match = _TOKEN.match(text, offset)
        if match is None or match.lastgroup is None:
            character = text[offset]
            code = "" if character.isascii() else f" (U+{ord(character):04X})"
            found = f"unexpected character {quoted(character)}{code} in {quoted(text)}"
            remedy = _REMEDIES.get(character, _LETTERS if character.isalpha() else "")
            raise ExpressionError(found, allowed=_GRAMMAR, remedy=remedy, location=place(text, offset, start))
        tokens.append(Token(TokenKind(match.lastgroup), match.group(), offset))
        offset = match.end()
        if len(tokens) > limits.tokens:
            found = f"expression with more than {limits.tokens} numbers, names and signs"
            raise ExpressionError(found, remedy=shorter, location=start)
    return (*tokens, Token(TokenKind.END, "", len(text)))


CELL_FUNCTIONS: Final = frozenset({"sin", "cos", "tan", "sqrt"})
FORMULA_FUNCTIONS: Final = CELL_FUNCTIONS | {"atan2"}
RESERVED_NAMES: Final = FORMULA_FUNCTIONS | {"pi"}
# Spellings (in any case) of YAML's and Python's special values: as symbols they could only be mistakes.
NOT_SYMBOLS: Final = frozenset({"nan", "inf", "infinity", "null", "none", "true", "false"})


def parse_expression(
    text: str, location: Location, functions: frozenset[str] = CELL_FUNCTIONS, limits: Limits = CELL_LIMITS
) -> Expression:
    """Parse one cell or formula."""
    return _Parser(text, location, functions, limits).parse()


class _Parser:
    """Recursive descent, one method per rule; depth is counted, so that Python's limit is never reached."""

    def __init__(self, text: str, location: Location, functions: frozenset[str], limits: Limits) -> None:
        self._text, self._start, self._functions, self._limits = text, location, functions, limits
        self._tokens = tokenize(text, location, limits)
        self._position = self._depth = 0

    def parse(self) -> Expression:
        if not self._text.strip():
            raise self._error("empty cell", self._next, "write a number, a name or an expression")
        expression = self._sum()
        if self._next.kind is not TokenKind.END:
            raise self._unexpected(self._next)
        # Multiplying out is what costs later: bounded here, without doing it.
        if tree.expanded_terms(expression, self._limits.expanded_terms) > self._limits.expanded_terms:
            remedy = f"at most {self._limits.expanded_terms} terms; introduce a parameter for part of it"
            raise self._error("expression has too many terms when multiplied out", self._tokens[0], remedy)
        return expression

    @property
    def _next(self) -> Token:
        return self._tokens[self._position]

    def _take(self, *operators: str) -> Token | None:
        token = self._next
        if token.kind is TokenKind.OPERATOR and token.text in operators:
            self._position += 1
            return token
        return None

    def _sum(self) -> Expression:
        token = self._next
        self._enter(token)
        terms = [self._product()]
        while operator := self._take("+", "-"):
            term = self._product()
            terms.append(term if operator.text == "+" else tree.negate(term))
        self._depth -= 1
        return self._bounded(tree.add(*terms), token)

    def _product(self) -> Expression:
        token = self._next
        factors = [self._sign()]
        while operator := self._take("*", "/"):
            factor = self._sign()
            factors.append(factor if operator.text == "*" else self._raise(factor, -1, operator))
        return self._bounded(tree.multiply(*factors), token)

    def _sign(self) -> Expression:
        operator = self._take("+", "-")
        if operator is None:
            return self._power()
        self._enter(operator)
        value = self._sign()
        self._depth -= 1
        return value if operator.text == "+" else tree.negate(value)

    def _power(self) -> Expression:
        base = self._atom()
        operator = self._take("**")
        if operator is None:
            return base
        token = self._next
        self._enter(operator)
        exponent = self._sign()  # right of **: -x**-2**2 is -(x**(-(2**2)))
        self._depth -= 1
        # With integers alone a tree is a rational function of symbols, sines, cosines and roots, as the algebra needs.
        if not isinstance(exponent, Number) or exponent.value.denominator != 1:
            half = isinstance(exponent, Number) and exponent.value.denominator == 2
            remedy = "write sqrt(...) for the exponent 1/2" if half else "write the power out"
            raise self._error("exponent that is not an integer", token, f"integers only; {remedy}")
        if abs(exponent.value) > self._limits.exponent:
            raise self._error("exponent too large", token, f"at most {self._limits.exponent}, signs aside")
        return self._raise(base, int(exponent.value), operator)

    def _raise(self, base: Expression, exponent: int, token: Token) -> Expression:
        if isinstance(base, Number):
            if base.value == 0 and exponent < 0:
                raise self._error("division by zero", token, "remove it")
            # A power has about as many bits as base bits times exponent: refused before it is computed.
            if _bits(base.value) * abs(exponent) > 2 * self._limits.number_bits:
                raise self._number_too_large(token)
        return self._bounded(tree.power(base, exponent), token)

    def _atom(self) -> Expression:
        token = self._next
        self._position += 1
        if token.kind is TokenKind.NUMBER:
            mantissa, _, exponent = token.text.lower().partition("e")
            if len(mantissa) > self._limits.digits:
                raise self._error("number with too many digits", token, f"at most {self._limits.digits}")
            if exponent and (len(exponent) > 6 or abs(int(exponent)) > self._limits.decimal_exponent):
                raise self._error("decimal exponent too large", token, f"at most {self._limits.decimal_exponent}")
            return Number(Fraction(mantissa) * Fraction(10) ** int(exponent or 0))  # 0.1 is 1/10, no float
        if token.kind is TokenKind.NAME:
            return self._name(token)
        if token.text == "(":
            inner = self._sum()
            self._close(token)
            return inner
        self._position -= 1
        raise self._unexpected(token)

    def _name(self, token: Token) -> Expression:
        name, known = token.text, f"allowed: {listed(sorted(self._functions))}"
        if name in self._functions:
            return self._call(token)
        if name in RESERVED_NAMES - {"pi"}:
            raise self._error(f"function '{name}' is not available here", token, known)
        if self._next.text == "(":
            remedy = near_miss(name, self._functions) or f"for a product write {name}*(...)"
            raise self._error(f"unknown function {quoted(name)}", token, f"{known}; {remedy}")
        if name == "pi":
            return Pi()
        if name.casefold() in NOT_SYMBOLS:
            raise self._error(f"'{name}' is not a number", token, "write a finite number or another name")
        if len(name) > FILE_LIMITS.name_length:
            raise self._error(f"name {quoted(name)} too long", token, f"at most {FILE_LIMITS.name_length} characters")
        return Name(name)

    def _call(self, token: Token) -> Expression:
        opening = self._next
        if self._take("(") is None:
            raise self._error(f"'{token.text}' without its argument", token, f"write {token.text}(...)")
        arguments = [self._sum()]
        while self._take(","):
            arguments.append(self._sum())
        self._close(opening)
        arity = 2 if token.text.lower() == "atan2" else 1
        if len(arguments) != arity:
            raise self._error(f"{token.text} with {len(arguments)} arguments", token, f"it takes {arity}")
        return Call(token.text, tuple(arguments))

    def _close(self, opening: Token) -> None:
        if self._take(")"):
            return
        if self._next.kind is TokenKind.END:
            raise self._error("parenthesis that is never closed", opening, "add )")
        raise self._unexpected(self._next)

    def _enter(self, token: Token) -> None:
        self._depth += 1
        if self._depth > self._limits.depth:
            raise self._error("expression nested too deeply", token, f"at most {self._limits.depth} levels")

    def _bounded(self, expression: Expression, token: Token) -> Expression:
        match expression:
            case Number(value) if _bits(value) > self._limits.number_bits:
                raise self._number_too_large(token)
            case Power(_, exponent) if abs(exponent) > self._limits.exponent:
                raise self._error("exponent too large", token, f"at most {self._limits.exponent}, signs aside")
            case _:
                return expression

    def _number_too_large(self, token: Token) -> ExpressionError:
        digits = self._limits.number_bits * 3 // 10
        return self._error("number too large or too fine", token, f"at most {digits} digits after evaluation")

    def _unexpected(self, token: Token) -> ExpressionError:
        if token.kind is TokenKind.END:
            return self._error("expression ends too early", token, "a number, a name or ( is missing")
        before = self._tokens[self._position - 1] if self._position else None
        named = (TokenKind.NUMBER, TokenKind.NAME)
        begins = token.kind in named or token.text == "("
        if before is not None and begins and (before.kind in named or before.text == ")"):
            whole = f"{self._text[: token.offset].rstrip()}*{self._text[token.offset :]}".strip()
            shown = whole if len(whole) <= 40 else f"{before.text[-20:]}*{token.text[:20]}"
            remedy = f"write the product as {shown}"
            return self._error(f"no operator before {quoted(token.text)}", token, remedy)
        remedy = "write 0.5, with a decimal point" if token.text == "," else "check the operators and parentheses"
        return self._error(f"unexpected {quoted(token.text)}", token, remedy)

    def _error(self, found: str, token: Token, remedy: str) -> ExpressionError:
        found = found if self._text.strip() in ("", token.text) else f"{found} in {quoted(self._text)}"
        return ExpressionError(found, remedy=remedy, location=place(self._text, token.offset, self._start))


def _bits(value: Fraction) -> int:
    return max(value.numerator.bit_length(), value.denominator.bit_length())

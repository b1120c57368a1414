r"""Formulas in the LaTeX of lecture notes as expression trees: ``c_1 \left(a_2 c_2 + a_3 c_{23}\right)``.

Understood are fractions, roots, powers, subscripts, dots, Greek letters, cosines and sines with or without brackets,
juxtaposition as product, and everything that only moves ink (``\left``, ``\big``, ``\,``, ``\quad``). Whatever else
occurs is refused at its place; nothing is ever guessed from a macro that is not known.

Why a LaTeX formula was refused, in words.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from importlib.resources import files
from typing import Any

from lark import Lark, Token
from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken, VisitError
from lark.visitors import Transformer_NonRecursive

from derive.check.latex_names import FLAT, LatexNames, Symbol, circular_call
from derive.errors import CheckError, DeriveError, Location, near_miss, quoted
from derive.robot.expression import (
    Call,
    Expression,
    Number,
    Power,
    Product,
    add,
    expanded_terms,
    multiply,
    negate,
    number,
    power,
)
from derive.robot.limits import FORMULA_LIMITS
from derive.robot.parser import place
from derive.robot.robot import Robot

MAX_LENGTH = 40_000
"""Characters of one formula; a printed page holds some 4,000."""

MACROS = (
    *("cos", "sin", "tan", "sqrt", "frac", "tfrac", "dfrac", "left", "right", "dot", "ddot", "cdot", "times", "quad"),
    *("alpha", "beta", "gamma", "delta", "epsilon", "theta", "vartheta", "lambda", "mu", "nu", "xi", "pi", "rho"),
    *("sigma", "tau", "phi", "varphi", "chi", "psi", "omega", "ell", "mathrm", "text", "operatorname", "mathbf"),
)

_MACRO = re.compile(r"\\[A-Za-z]+|\\.")
_LONG_SCRIPT = re.compile(r"([_^])\s*([A-Za-z0-9][0-9]+)")
_REMEDIES = {
    "=": "write only the right-hand side",
    "'": "primes have no meaning here; remove it",
    "^": "write an exponent as ^2 or ^{2}, that of a function as \\cos^2\\theta_1 or (\\cos\\theta_1)^2",
    "&": "check one entry at a time",
    "$": "dollar signs may only stand around the whole formula",
    "|": "use brackets",
}


def check_size(text: str, start: Location) -> None:
    """Refuse what is too long or nested too deeply, before anything is parsed.

    Raises:
        CheckError: Beyond a limit.
    """
    if len(text) > MAX_LENGTH:
        raise CheckError(f"formula of {len(text)} characters", allowed=f"at most {MAX_LENGTH}", location=start)
    if not text.strip(" \t\r\n$"):
        raise CheckError("empty formula", remedy="write the right-hand side", location=start)
    depth = 0
    for offset, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if depth > FORMULA_LIMITS.depth:
            where = place(text, offset, start)
            raise CheckError("brackets nested too deeply", allowed=f"at most {FORMULA_LIMITS.depth}", location=where)


def bounded(e: Expression) -> Expression:
    """The tree itself; no folded number may outgrow a float.

    Raises:
        CheckError: It does.
    """
    first = e.factors[0] if isinstance(e, Product) else e
    if isinstance(first, Number):
        bits = max(first.value.numerator.bit_length(), first.value.denominator.bit_length())
        if bits > FORMULA_LIMITS.number_bits:
            raise CheckError("number too large or too fine", allowed=f"at most {FORMULA_LIMITS.number_bits} bits")
    return e


def refusal(text: str, offset: int, start: Location) -> CheckError:
    """The message for text that the grammar does not know."""
    where = place(text, offset, start)
    rest = text[offset:]
    if not rest.strip():
        return CheckError("formula ends too early", remedy="check brackets and braces", location=where)
    if match := _LONG_SCRIPT.match(text, _script_before(text, offset)):
        where = place(text, match.start(), start)
        mark, script = match[1], match[2]
        shown = f"LaTeX prints only {script[0]!r} of {mark}{script} as a script"
        return CheckError(shown, remedy=f"write {mark}{{{script}}}", location=where)
    if match := _MACRO.match(rest):
        if match[0][1:] in MACROS:
            return CheckError(f"{match[0]} at a place where it has no meaning", location=where)
        hint = near_miss(match[0][1:], MACROS).replace("'", "\\", 1).replace("'", "")
        return CheckError(f"unknown macro {quoted(match[0])}".replace("\\\\", "\\"), remedy=hint, location=where)
    return CheckError(f"unexpected {quoted(rest[0])}", remedy=_REMEDIES.get(rest[0], "check it"), location=where)


def _script_before(text: str, offset: int) -> int:
    """Where the script begins in whose middle the reading stopped; the place itself if in none."""
    before = text[:offset].rstrip()
    return len(before) - 1 if before.endswith(("_", "^")) else offset


Value = Expression | Symbol
Children = list[Any]


def read_latex(
    text: str,
    robot: Robot,
    location: Location | None = None,
    abbreviations: Mapping[str, Expression] | None = None,
) -> Expression:
    r"""A LaTeX formula as an expression in the robot's own names.

    Args:
        text: The formula, a right-hand side; dollar signs around it are allowed.
        robot: Whose formula it is.
        location: Where its first character stands.
        abbreviations: Further names and what they stand for, such as h.

    Raises:
        CheckError: An unknown macro, an unknown name, or text outside the grammar; placed at it.
    """
    start = location or Location("<latex>")
    check_size(text, start)
    names = LatexNames(robot, abbreviations)
    blank = _without_dollars(text)
    try:
        found: Expression = _Builder(names).transform(_parser().parse(blank))
    except UnexpectedInput as error:
        raise refusal(blank, _offset(error, blank), start) from None
    except VisitError as error:
        raise _placed(error.orig_exc, text, start) from None
    if expanded_terms(found, FORMULA_LIMITS.expanded_terms) > FORMULA_LIMITS.expanded_terms:
        raise CheckError("formula has too many terms when multiplied out", location=start)
    return found


class _At(Exception):
    """An error with the offset of what caused it."""

    def __init__(self, offset: int, error: DeriveError) -> None:
        super().__init__(str(error))
        self.offset = offset
        self.error = error


def _placed(error: Exception, text: str, start: Location) -> DeriveError:
    if isinstance(error, _At):
        return error.error.at(place(text, error.offset, start))
    if isinstance(error, DeriveError):
        return error.at(start)
    if isinstance(error, ZeroDivisionError):
        return CheckError("division by zero", location=start)
    raise error


def _offset(error: UnexpectedInput, text: str) -> int:
    if isinstance(error, UnexpectedToken) and error.token.type == "$END":
        return len(text)
    if isinstance(error, UnexpectedToken | UnexpectedCharacters):
        return error.pos_in_stream or 0
    return len(text)


def _without_dollars(text: str) -> str:
    """Dollar signs around the formula become blanks, so that every offset stays."""
    inner = text.strip()
    for dollars in ("$$", "$"):
        if inner.startswith(dollars) and inner.endswith(dollars) and len(inner) > 2 * len(dollars):
            first, last = text.index(dollars), text.rindex(dollars)
            blank = " " * len(dollars)
            return text[:first] + blank + text[first + len(dollars) : last] + blank + text[last + len(dollars) :]
    return text


@cache
def _parser() -> Lark:
    grammar = files("derive.check").joinpath("latex_formula.lark").read_text(encoding="utf-8")
    return Lark(grammar, parser="lalr")


class _Builder(Transformer_NonRecursive[Token, Expression]):
    """Rules of the grammar as constructors; a name stays a `Symbol` until all its scripts are known."""

    def __init__(self, names: LatexNames) -> None:
        super().__init__()
        self.names = names

    def tree(self, value: Value) -> Expression:
        """The expression that a value stands for."""
        if not isinstance(value, Symbol):
            return value
        try:
            return self.names.meaning(value)
        except DeriveError as error:
            raise _At(value.offset, error) from None

    def start(self, children: Children) -> Expression:
        return self.tree(children[0])

    def sum(self, children: Children) -> Value:
        terms = [child for child in children if not isinstance(child, Token)]
        signs = [1, *(-1 if child == "-" else 1 for child in children if isinstance(child, Token))]
        if len(terms) == 1:
            return terms[0]  # type: ignore[no-any-return]
        pairs = zip(signs, terms, strict=True)
        return add(*(negate(self.tree(t)) if sign < 0 else self.tree(t) for sign, t in pairs))

    def signed(self, children: Children) -> Value:
        return children[0]  # type: ignore[no-any-return]

    def plus(self, children: Children) -> Value:
        return children[1]  # type: ignore[no-any-return]

    def minus(self, children: Children) -> Expression:
        return negate(self.tree(children[1]))

    def product(self, children: Children) -> Value:
        if len(children) == 1:
            return children[0]  # type: ignore[no-any-return]
        factors: list[Expression] = []
        function, divide = "", False
        for child in children:
            if isinstance(child, Token):
                divide = child.type == "SLASH"
                continue
            if not function and isinstance(child, Symbol) and child is not children[-1]:
                function = self.names.circular(child)
                if function:
                    continue
            value = circular_call(function, self.tree(child)) if function else self.tree(child)
            factors.append(power(value, -1) if divide else value)
            function, divide = "", False
        return bounded(multiply(*factors))

    def bracket(self, children: Children) -> Expression:
        return self.tree(next(child for child in children if not isinstance(child, Token)))

    def group(self, children: Children) -> Value:
        return children[0]  # type: ignore[no-any-return]

    def number(self, children: Children) -> Expression:
        return _number(children[0])

    # -- names

    def letter(self, children: Children) -> Symbol:
        token = children[0]
        return Symbol(_flat(token), token.start_pos or 0)

    def symbol(self, children: Children) -> Value:
        base, *scripts = children
        if not isinstance(base, Symbol):
            raise _At(scripts[0][1] if scripts else 0, CheckError("subscript of a formula", allowed="of a name"))
        return Symbol(base.text + "".join(text for text, _ in scripts), base.offset, base.dots)

    bracket_subscript = accent_symbol = symbol

    def power(self, children: Children) -> Expression:
        scripts = [child for child in children if isinstance(child, tuple)]
        exponent = next(child for child in children[1:] if not isinstance(child, tuple))
        return self._power(self.symbol([children[0], *scripts]), exponent)

    bracket_subscript_power = accent_power = power

    def bracket_power(self, children: Children) -> Expression:
        return self._power(children[0], children[1])

    def number_power(self, children: Children) -> Expression:
        return self._power(_number(children[0]), children[1])

    def accent(self, children: Children) -> Symbol:
        token, base = children
        if not isinstance(base, Symbol):
            raise _At(token.start_pos or 0, CheckError("dot over a formula", allowed="over a joint variable"))
        return Symbol(base.text, base.offset, base.dots + (2 if token.type == "DDOT" else 1))

    def subscript_group(self, children: Children) -> tuple[str, int]:
        return "".join(text for text, _ in children), children[0][1]

    index_group = index_subscript = subscript_group

    def subscript_character(self, children: Children) -> tuple[str, int]:
        return children[0][-1], children[0].start_pos or 0

    def subscript_macro(self, children: Children) -> tuple[str, int]:
        return _flat(children[0]), children[0].start_pos or 0

    def index_part(self, children: Children) -> tuple[str, int]:
        return "" if children[0] in "+," else _flat(children[0]), children[0].start_pos or 0

    # -- powers and functions

    def exponent_group(self, children: Children) -> Expression:
        return self.tree(children[0])

    def exponent_digit(self, children: Children) -> Expression:
        return number(children[0][-1])

    def _power(self, base: Value, exponent: Expression) -> Expression:
        offset = base.offset if isinstance(base, Symbol) else 0
        if not isinstance(exponent, Number) or exponent.value.denominator != 1:
            raise _At(offset, CheckError("exponent that is no whole number", remedy=r"write roots as \sqrt{}"))
        tree = self.tree(base)
        inner = tree.exponent if isinstance(tree, Power) else 1
        if abs(exponent.value * inner) > FORMULA_LIMITS.exponent:
            raise _At(offset, CheckError("exponent too large", allowed=f"at most {FORMULA_LIMITS.exponent}"))
        return bounded(power(tree, int(exponent.value)))

    def call(self, children: Children) -> Expression:
        return Call(_function(children[0]), (self.tree(children[1]),))

    root_letter = call

    def call_power(self, children: Children) -> Expression:
        return self._power(self.call(children[:2]), children[2])

    def power_call(self, children: Children) -> Expression:
        function, exponent, argument = children
        if isinstance(exponent, Number) and exponent.value < 0:
            what = CheckError(f"inverse function {function}^{{-1}}", remedy=r"write \operatorname{atan2}(y, x)")
            raise _At(function.start_pos or 0, what)
        return self._power(self.call([function, argument]), exponent)

    def atan2(self, children: Children) -> Expression:
        arguments = [self.tree(child) for child in children if not isinstance(child, Token)]
        return Call("atan2", tuple(arguments))

    def operand(self, children: Children) -> Expression:
        return multiply(*(_number(c) if isinstance(c, Token) else self.tree(c) for c in children))

    def accent_operand(self, children: Children) -> Value:
        return children[0]  # type: ignore[no-any-return]

    def fraction(self, children: Children) -> Expression:
        if len(children) == 1:
            return self.tree(children[0])
        return multiply(self.tree(children[1]), power(self.tree(children[2]), -1))

    def short_fraction(self, children: Children) -> Expression:
        above, below = [Fraction(c) for c in children[0] if c.isdigit()]
        return number(above / below)


def _number(token: Token) -> Expression:
    if len(token) > FORMULA_LIMITS.digits:
        raise _At(token.start_pos or 0, CheckError("number with too many digits", allowed=f"{FORMULA_LIMITS.digits}"))
    return number(Fraction(str(token)))


def _function(token: Token) -> str:
    return "sqrt" if token.type == "ROOT" else next(f for f in ("cos", "sin", "tan") if f in token)


def _flat(token: Token) -> str:
    """The letters of a name: the macro's own name, or what stands in its braces."""
    text = str(token)
    if "{" in text:
        return "".join(text[text.index("{") + 1 : -1].split())
    macro = text.removeprefix("\\")
    return FLAT.get(macro, macro)

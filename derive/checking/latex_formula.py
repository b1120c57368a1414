r"""Formulas in the LaTeX of lecture notes as expression trees: ``c_1 \left(a_2 c_2 + a_3 c_{23}\right)``.

Understood are fractions, roots, powers, subscripts, dots, Greek letters, cosines and sines with or without brackets,
juxtaposition as product, and everything that only moves ink (``\left``, ``\big``, ``\,``, ``\quad``). Whatever else
occurs is refused at its place, in words; nothing is ever guessed from a macro that is not known.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from importlib.resources import files
from typing import Any

from lark import Lark, Token
from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken
from lark.visitors import Transformer_NonRecursive

from derive.checking.latex_names import FLAT, LatexNames, Symbol
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
from derive.robot.parser import place
from derive.robot.robot import Robot
from derive.robot.size_limits import FORMULA_LIMITS

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

    Returns:
        The tree, in the order in which the formula is printed.

    Raises:
        CheckError: An unknown macro, an unknown name, or text outside the grammar; placed at it.
    """
    start = location or Location("<latex>")
    names, blank = LatexNames(robot, abbreviations), _without_dollars(text, start)
    try:
        found: Expression = _Builder(names).transform(_parser().parse(blank))
    except UnexpectedInput as error:
        raise _refusal(blank, error, start) from None
    except _At as error:
        raise error.error.at(place(text, error.offset, start)) from None
    except DeriveError as error:
        raise error.at(start) from None
    except ZeroDivisionError:
        raise CheckError("division by zero", location=start) from None
    if expanded_terms(found, FORMULA_LIMITS.expanded_terms) > FORMULA_LIMITS.expanded_terms:
        raise CheckError("formula has too many terms when multiplied out", location=start)
    return found


def _without_dollars(text: str, start: Location) -> str:
    """The text with blanks for the dollar signs around it, so that every offset stays; refuses one beyond a limit."""
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
    inner = text.strip()
    for dollars in ("$$", "$"):
        if inner.startswith(dollars) and inner.endswith(dollars) and len(inner) > 2 * len(dollars):
            first, last = text.index(dollars), text.rindex(dollars)
            blank = " " * len(dollars)
            return text[:first] + blank + text[first + len(dollars) : last] + blank + text[last + len(dollars) :]
    return text


def _refusal(text: str, error: UnexpectedInput, start: Location) -> CheckError:
    """The message for text that the grammar does not know."""
    offset = len(text)
    if isinstance(error, UnexpectedToken | UnexpectedCharacters):
        at_end = isinstance(error, UnexpectedToken) and error.token.type == "$END"
        offset = offset if at_end else error.pos_in_stream or 0
    where, rest = place(text, offset, start), text[offset:]
    if not rest.strip():
        return CheckError("formula ends too early", remedy="check brackets and braces", location=where)
    before = text[:offset].rstrip()
    script_start = len(before) - 1 if before.endswith(("_", "^")) else offset  # reading may stop in mid script
    if match := _LONG_SCRIPT.match(text, script_start):
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


@cache
def _parser() -> Lark:
    grammar = files("derive.checking").joinpath("latex_formula.lark").read_text(encoding="utf-8")
    return Lark(grammar, parser="lalr")


class _At(Exception):
    """An error with the offset of what caused it."""

    def __init__(self, offset: int, error: DeriveError) -> None:
        super().__init__(str(error))
        self.offset = offset
        self.error = error


class _Builder(Transformer_NonRecursive[Token, Expression]):
    """Makes of every rule of the grammar an expression, a name, or a script.

    A name stays a `Symbol` until all its scripts are known; a script is its text with its offset.
    """

    def __init__(self, names: LatexNames) -> None:
        super().__init__()
        self._names = names

    def __default__(self, data: str, children: Children, meta: object) -> Any:
        """What a rule makes of what its parts have become."""
        match data, children:
            case (("start" | "exponent_group"), (value,)):
                return self._tree(value)
            case "plus", (_, value):
                return value
            case "minus", (_, value):
                return negate(self._tree(value))
            case "bracket", (_, value, _):
                return self._tree(value)
            case "sum", (first, *rest):
                pairs = zip(rest[::2], map(self._tree, rest[1::2]), strict=True)
                return add(self._tree(first), *(negate(term) if sign == "-" else term for sign, term in pairs))
            case "product", _:
                return self._product(children)
            case "operand", _:
                return multiply(*(_number(c) if isinstance(c, Token) else self._tree(c) for c in children))
            case "fraction", (_, above, below):
                return multiply(self._tree(above), power(self._tree(below), -1))
            case "short_fraction", (token,):
                above, below = [Fraction(c) for c in token if c.isdigit()]
                return number(above / below)
            case "number", (token,):
                return _number(token)
            case "exponent_digit", (token,):
                return number(token[-1])
            case "atan2", _:
                return Call("atan2", tuple(self._tree(child) for child in children if not isinstance(child, Token)))
            case (("call" | "root_letter"), (function, argument)):
                return self._call(function, argument)
            case "call_power", (function, argument, exponent):
                return self._power(self._call(function, argument), exponent)
            case "power_call", (function, exponent, argument):
                if isinstance(exponent, Number) and exponent.value < 0:
                    what = CheckError(f"inverse function {function}^{{-1}}", remedy=r"write \operatorname{atan2}(y, x)")
                    raise _At(function.start_pos or 0, what)
                return self._power(self._call(function, argument), exponent)
            case "number_power", (token, exponent):
                return self._power(_number(token), exponent)
            case "bracket_power", (base, exponent):
                return self._power(base, exponent)
            case (("power" | "bracket_subscript_power" | "accent_power"), (base, *others)):
                scripts = [other for other in others if isinstance(other, tuple)]
                (exponent,) = (other for other in others if not isinstance(other, tuple))
                return self._power(_symbol(base, scripts), exponent)
        return _name_or_script(data, children)

    def _tree(self, value: Value) -> Expression:
        """The expression that a value stands for."""
        if not isinstance(value, Symbol):
            return value
        try:
            return self._names.meaning(value)
        except DeriveError as error:
            raise _At(value.offset, error) from None

    def _product(self, children: Children) -> Expression:
        """Factors side by side, with signs of multiplication and division between them, and c before an angle."""
        factors: list[Expression] = []
        function, divide = "", False
        for child in children:
            if isinstance(child, Token):
                divide = child.type == "SLASH"
                continue
            if not function and isinstance(child, Symbol) and child is not children[-1]:
                function = self._names.circular(child)
                if function:
                    continue
            value = Call(function, (self._tree(child),)) if function else self._tree(child)
            factors.append(power(value, -1) if divide else value)
            function, divide = "", False
        return _bounded(multiply(*factors))

    def _call(self, token: Token, argument: Value) -> Expression:
        function = "sqrt" if token.type == "ROOT" else next(f for f in ("cos", "sin", "tan") if f in token)
        return Call(function, (self._tree(argument),))

    def _power(self, base: Value, exponent: Expression) -> Expression:
        offset = base.offset if isinstance(base, Symbol) else 0
        if not isinstance(exponent, Number) or exponent.value.denominator != 1:
            raise _At(offset, CheckError("exponent that is no whole number", remedy=r"write roots as \sqrt{}"))
        tree = self._tree(base)
        inner = tree.exponent if isinstance(tree, Power) else 1
        if abs(exponent.value * inner) > FORMULA_LIMITS.exponent:
            raise _At(offset, CheckError("exponent too large", allowed=f"at most {FORMULA_LIMITS.exponent}"))
        return _bounded(power(tree, int(exponent.value)))


def _name_or_script(data: str, children: Children) -> Symbol | tuple[str, int]:
    """What a rule about names makes of its parts: a name, or a script with its offset."""
    match data, children:
        case "letter", (token,):
            return Symbol(_flat(token), token.start_pos or 0)
        case (("symbol" | "bracket_subscript" | "accent_symbol"), (base, *scripts)):
            return _symbol(base, scripts)
        case "accent", (token, base):
            if not isinstance(base, Symbol):
                raise _At(token.start_pos or 0, CheckError("dot over a formula", allowed="over a joint variable"))
            return Symbol(base.text, base.offset, base.dots + (2 if token.type == "DDOT" else 1))
        case (("subscript_group" | "index_group" | "index_subscript"), ((_, offset), *_)):
            return "".join(text for text, _ in children), offset
        case "subscript_character", (token,):
            return token[-1], token.start_pos or 0
        case (("subscript_macro" | "index_part"), (token,)):
            return "" if token in ("+", ",") else _flat(token), token.start_pos or 0
    raise AssertionError(data)


def _symbol(base: Value, scripts: list[tuple[str, int]]) -> Symbol:
    """A name with its scripts."""
    if not isinstance(base, Symbol):
        raise _At(scripts[0][1] if scripts else 0, CheckError("subscript of a formula", allowed="of a name"))
    return Symbol(base.text + "".join(text for text, _ in scripts), base.offset, base.dots)


def _bounded(e: Expression) -> Expression:
    """The tree itself; no folded number may outgrow a float."""
    first = e.factors[0] if isinstance(e, Product) else e
    if isinstance(first, Number):
        bits = max(first.value.numerator.bit_length(), first.value.denominator.bit_length())
        if bits > FORMULA_LIMITS.number_bits:
            raise CheckError("number too large or too fine", allowed=f"at most {FORMULA_LIMITS.number_bits} bits")
    return e


def _number(token: Token) -> Expression:
    if len(token) > FORMULA_LIMITS.digits:
        raise _At(token.start_pos or 0, CheckError("number with too many digits", allowed=f"{FORMULA_LIMITS.digits}"))
    return number(Fraction(str(token)))


def _flat(token: Token) -> str:
    """The letters of a name: the macro's own name, or what stands in its braces."""
    text = str(token)
    if "{" in text:
        return "".join(text[text.index("{") + 1 : -1].split())
    macro = text.removeprefix("\\")
    return FLAT.get(macro, macro)

r"""Formulas in the LaTeX of lecture notes as expression trees: ``c_1 \left(a_2 c_2 + a_3 c_{23}\right)``.

Understood are fractions, roots, powers, subscripts, dots, Greek letters, cosines and sines with or without brackets,
juxtaposition as product, matrices with factors and sums, and everything that only moves ink (``\left``, ``\,``).
Whatever else occurs is refused at its place, in words; nothing is ever guessed from a macro that is not known.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, reduce
from importlib.resources import files
from typing import Any

from lark import Lark, Token
from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken
from lark.visitors import Transformer_NonRecursive

from derive.checking.latex_equations import MATRIX_MARK, Piece, PrintedMatrix
from derive.checking.latex_matrices import Entry, Table
from derive.checking.latex_names import FLAT, LatexNames, Symbol
from derive.checking.latex_typography import PRIMED, cleaned
from derive.errors import CheckError, DeriveError, Location, UnknownNameError, near_miss, quoted
from derive.robot.expression import (
    ZERO,
    Call,
    Expression,
    Number,
    Pi,
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

MAX_TERMS = 1_000_000
"""Terms of a formula when multiplied out, at most; an analytic Jacobian of a 7R arm has 300,000, and long formulas are
compared at points."""

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
    ",": "write decimals with a point; separate equations by a line break",
    **dict.fromkeys((".", "\u2026", "\u22ef"), "write out what dots stand for"),
    "<": "only equations can be compared",
    ">": "only equations can be compared",
}
_MACRO_REMEDIES = {
    **dict.fromkeys(("ldots", "cdots", "dots", "vdots", "ddots", "dotsc", "dotsb"), "write out what dots stand for"),
    **dict.fromkeys(("pm", "mp"), "these are two formulas; check one sign at a time"),
    **dict.fromkeys(("newcommand", "renewcommand", "def", "DeclareMathOperator"), "write own macros out"),
    **dict.fromkeys(("sum", "prod", "int"), "write the terms out"),
    **dict.fromkeys(("bar", "hat", "tilde", "overline", "widehat"), "names have dots only; write a plain name"),
    **dict.fromkeys(("arctan", "arccos", "arcsin"), r"write \operatorname{atan2}(y, x)"),
    **dict.fromkeys(("approx", "simeq", "leq", "geq", "le", "ge", "neq", "sim"), "only equations can be compared"),
}


@dataclass(frozen=True, slots=True)
class _Raised:
    """A power whose base may yet be the argument of a c or s that stands before it, as in ``c(q_1)^2``."""

    base: Any
    exponent: Expression


@dataclass(frozen=True, slots=True)
class _Digits:
    """A written number, of which two side by side are refused."""

    value: Expression
    offset: int


Value = Expression | Symbol | Table | _Raised | _Digits
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
    piece = Piece(_without_dollars(cleaned(text)), 0)
    return LatexReader(robot, text, start, abbreviations).formula(piece)


class LatexReader:
    """Reads the pieces of one text.

    Args:
        robot: Whose formulas they are.
        text: The text as it was typed.
        start: Where its first character stands.
        abbreviations: Further names and what they stand for.
        entries: Names of entries of quantities such as b12 and what they stand for, looked up last.
    """

    def __init__(
        self,
        robot: Robot,
        text: str,
        start: Location,
        abbreviations: Mapping[str, Expression] | None = None,
        entries: Mapping[str, Expression] | None = None,
    ) -> None:
        self.names = LatexNames(robot, abbreviations, entries)
        self._text = text
        self._start = start

    def location(self, offset: int) -> Location:
        """The place of a character.

        Args:
            offset: Its position in the text, from 0.
        """
        return place(self._text, offset, self._start)

    def formula(self, piece: Piece) -> Expression:
        """What a piece says that is no matrix.

        Args:
            piece: The piece.

        Raises:
            CheckError: It cannot be read, or is a matrix; placed at what is not understood.
        """
        found = self.value(piece)
        if isinstance(found, Table):
            raise CheckError("matrix where a formula is expected", location=self.location(piece.start))
        return found

    def value(self, piece: Piece) -> Expression | Table:
        """What a piece says.

        Args:
            piece: The piece.

        Raises:
            CheckError: It cannot be read; placed at what is not understood.
        """
        self._check_size(piece)
        marks = [i for i, letter in enumerate(piece.text) if letter == MATRIX_MARK] if piece.matrices else []
        tables = {i: self._matrix(matrix) for i, matrix in zip(marks, piece.matrices, strict=True)}
        try:
            text = self._with_long_names(piece.text)
            found: Expression | Table = _Builder(self.names, tables).transform(_parser().parse(text))
        except UnexpectedInput as error:
            raise self._refusal(piece, error) from None
        except _At as error:
            raise error.error.at(self.location(piece.offset + error.offset)) from None
        except DeriveError as error:
            raise error.at(self.location(piece.start)) from None
        except ZeroDivisionError:
            raise CheckError("division by zero", location=self.location(piece.start)) from None
        formulas = [found] if not isinstance(found, Table) else [e.formula for row in found.rows for e in row]
        if any(expanded_terms(formula, MAX_TERMS) > MAX_TERMS for formula in formulas):
            raise CheckError("formula has too many terms when multiplied out", location=self.location(piece.start))
        return found

    def _with_long_names(self, text: str) -> str:
        """One sign for each run of letters that is a name of the robot, as SymPy prints it: ``qd_{1}``, ``Ixx_{1}``."""
        return _RUN.sub(self._long_name, text)

    def _long_name(self, match: re.Match[str]) -> str:
        run = match["run"]
        if run is None:
            return match[0]
        sub = re.sub(r"[^A-Za-z0-9]", "", match["sub"] or "")
        if not self._is_known(run + sub) or all(map(self._is_known, (*run[:-1], run[-1] + sub))):
            return match[0]
        sign = self.names.sign(run)
        return sign.ljust(len(run)) + match[0][len(run) :]

    def _is_known(self, name: str) -> bool:
        try:
            self.names.meaning(Symbol(name, 0))
        except CheckError:
            return False
        return True

    def _matrix(self, matrix: PrintedMatrix) -> Expression | Table:
        """The entries of a matrix; one with an unknown name says so, since the others can be compared all the same."""
        if len({len(row) for row in matrix.rows}) != 1:
            where = self.location(matrix.rows[-1][0].start) if matrix.rows else self._start
            lengths = " and ".join(map(str, sorted({len(row) for row in matrix.rows}))) or "no"
            remedy = r"check & and \\ of its rows"
            raise CheckError(f"matrix whose rows have {lengths} entries", remedy=remedy, location=where)
        table = Table(tuple(tuple(self._entry(cell) for cell in row) for row in matrix.rows))
        if not matrix.is_determinant:
            return table
        determinant = table.determinant
        if determinant.unknown is not None:
            raise determinant.unknown
        return determinant.formula

    def _entry(self, cell: Piece) -> Entry:
        text = " ".join(self._text[cell.start : cell.end].split())
        if not cell.text.strip():
            raise CheckError("empty entry", remedy="write 0", location=self.location(cell.start))
        try:
            return Entry(self.formula(cell), text, cell.start)
        except UnknownNameError as error:
            return Entry(ZERO, text, cell.start, error)

    def _check_size(self, piece: Piece) -> None:
        """Refuse what is empty or beyond a limit."""
        text, longest, deepest = piece.text, FORMULA_LIMITS.text_length, FORMULA_LIMITS.depth
        if len(text) > longest:
            where = self.location(piece.start)
            raise CheckError(f"formula of {len(text)} characters", allowed=f"at most {longest}", location=where)
        if not text.strip(" \t\r\n$"):
            raise CheckError("empty formula", remedy="write the right-hand side", location=self.location(piece.offset))
        depth = 0
        for match in _BRACKET.finditer(text):
            depth += 1 if match[0] in "([{" else -1
            if depth > deepest:
                where = self.location(piece.offset + match.start())
                raise CheckError("brackets nested too deeply", allowed=f"at most {deepest}", location=where)

    def _refusal(self, piece: Piece, error: UnexpectedInput) -> CheckError:
        """The message for text that the grammar does not know."""
        text, offset = piece.text, len(piece.text)
        if isinstance(error, UnexpectedToken | UnexpectedCharacters):
            at_end = isinstance(error, UnexpectedToken) and error.token.type == "$END"
            offset = offset if at_end else error.pos_in_stream or 0
        where, rest = self.location(piece.offset + offset), text[offset:]
        if not rest.strip():
            return CheckError("formula ends too early", remedy="check brackets and braces", location=where)
        before = text[:offset].rstrip()
        script_start = len(before) - 1 if before.endswith(("_", "^")) else offset  # reading may stop in mid script
        if match := _LONG_SCRIPT.match(text, script_start):
            where = self.location(piece.offset + match.start())
            mark, script = match[1], match[2]
            shown = f"LaTeX prints only {script[0]!r} of {mark}{script} as a script"
            return CheckError(shown, remedy=f"write {mark}{{{script}}}", location=where)
        if match := _MACRO.match(rest):
            name = match[0][1:]
            if name in MACROS:
                return CheckError(f"{match[0]} at a place where it has no meaning", location=where)
            hint = near_miss(name, MACROS).replace("'", "\\", 1).replace("'", "")
            if name in _MACRO_REMEDIES:
                return CheckError(f"{match[0]} in a formula", remedy=_MACRO_REMEDIES[name], location=where)
            hint = hint or "allowed: " + ", ".join(f"\\{macro}" for macro in (*MACROS[:5], "cdot")) + ", Greek letters"
            return CheckError(f"unknown macro {quoted(match[0])}".replace("\\\\", "\\"), remedy=hint, location=where)
        sign = "'" if rest[0] in PRIMED.values() else rest[0]
        return CheckError(f"unexpected {quoted(sign)}", remedy=_REMEDIES.get(sign, "check it"), location=where)


_RUN = re.compile(
    r"\\(?:math[a-z]+|text[a-z]*|operatorname\*?|boldsymbol|bm|pmb|vec|mbox)\s*\{[^{}]*\}|\\[A-Za-z]+|_\s*\{[^{}]*\}"
    r"|(?P<run>[A-Za-z]{2,})(?P<sub>[0-9]*\s*(?:_\s*(?:\{[^{}]*\}|[A-Za-z0-9]))?)"
)
"""A run of letters that is no macro, no script and no word in roman letters, with its subscript."""

_BRACKET = re.compile(r"[][(){}]")


def _without_dollars(text: str) -> str:
    """The text with blanks for the dollar signs around it, so that every offset stays."""
    inner = text.strip()
    for dollars in ("$$", "$"):
        if inner.startswith(dollars) and inner.endswith(dollars) and len(inner) > 2 * len(dollars):
            first, last = text.index(dollars), text.rindex(dollars)
            blank = " " * len(dollars)
            return text[:first] + blank + text[first + len(dollars) : last] + blank + text[last + len(dollars) :]
    return text


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


class _Builder(Transformer_NonRecursive[Token, Any]):
    """Makes of every rule of the grammar an expression, a matrix, a name, or a script.

    A name stays a `Symbol` until all its scripts are known; a script is its text with its offset.
    """

    def __init__(self, names: LatexNames, tables: Mapping[int, Expression | Table]) -> None:
        super().__init__()
        self._names = names
        self._tables = tables

    def __default__(self, data: str, children: Children, meta: object) -> Any:
        """What a rule makes of what its parts have become."""
        match data, children:
            case "start", (value,):
                return self._settled(value)
            case "exponent_group", (value,):
                return self._tree(value)
            case "plus", (_, value):
                return value
            case "minus", (_, value):
                return _each(self._settled(value), negate)
            case "bracket", (_, value, _):
                return self._settled(value)
            case "sum", (first, *rest):
                return self._sum(first, rest)
            case "product", _:
                return self._product(children)
            case "operand", _:
                return multiply(*(_number(c) if isinstance(c, Token) else self._tree(c) for c in children))
            case "degrees", (token, _):
                return multiply(_number(token), number(Fraction(1, 180)), Pi())
            case "fraction", (token, above, below):
                value = multiply(self._tree(above), power(self._tree(below), -1))
                return _Digits(value, token.start_pos or 0) if isinstance(value, Number) else value
            case "over", (above, _, below):
                return multiply(self._tree(above), power(self._tree(below), -1))
            case "short_fraction", (token,):
                above, below = [Fraction(c) for c in token if c.isdigit()]
                return _Digits(number(above / below), token.start_pos or 0)
            case "number", (token,):
                return _Digits(_number(token), token.start_pos or 0)
            case "exponent_digit", (token,):
                return number({"²": "2", "³": "3"}.get(token[-1], token[-1]))
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
                return _Raised(base, exponent)
            case (("matrix" | "transpose" | "list"), _):
                return self._matrix(data, children)
        return self._of_names(data, children)

    def _of_names(self, data: str, children: Children) -> Any:
        """Names with their scripts, dots and primes, and powers of them."""
        match data, children:
            case "letter", (token,) if token[0] in self._names.words:
                return Symbol(self._names.words[token[0]] + token[1:], token.start_pos or 0)
            case (("circular" | "circular_power"), (function, *others)):
                scripts = [other for other in others if isinstance(other, tuple)]
                letter = _function(function)[0]
                symbol = Symbol(letter + "".join(text for text, _ in scripts), function.start_pos or 0)
                return self._power(symbol, others[-1]) if data == "circular_power" else symbol
            case (("primed" | "primed_power"), (base, *others)):
                exponent = others.pop() if data == "primed_power" else None
                dots = next(count for count, mark in PRIMED.items() if mark == others[-1])
                symbol = _symbol(base, others[:-1])
                dotted = Symbol(symbol.text, symbol.offset, symbol.dots + dots)
                return dotted if exponent is None else self._power(dotted, exponent)
            case (("power" | "bracket_subscript_power" | "accent_power"), (base, *others)):
                scripts = [other for other in others if isinstance(other, tuple)]
                (exponent,) = (other for other in others if not isinstance(other, tuple))
                return _Raised(_symbol(base, scripts), exponent)
        return _name_or_script(data, children)

    def _settled(self, value: Value) -> Expression | Table:
        """The expression or matrix that a value stands for."""
        match value:
            case Table():
                return value
            case _Digits():
                return value.value
            case _Raised():
                return self._power(value.base, value.exponent)
            case Symbol():
                try:
                    return self._names.meaning(value)
                except DeriveError as error:
                    raise _At(value.offset, error) from None
        return value

    def _tree(self, value: Value) -> Expression:
        """The expression that a value stands for."""
        settled = self._settled(value)
        if isinstance(settled, Table):
            raise CheckError("matrix where a formula is expected", remedy="multiply and add matrices only")
        return settled

    def _sum(self, first: Value, rest: Children) -> Expression | Table:
        terms = [self._settled(first)]
        for sign, term in zip(rest[::2], rest[1::2], strict=True):
            settled = self._settled(term)
            terms.append(_each(settled, negate) if sign == "-" else settled)
        tables = [term for term in terms if isinstance(term, Table)]
        formulas = [term for term in terms if not isinstance(term, Table)]
        if tables and formulas:
            raise CheckError("sum of a matrix and a formula", remedy="add matrices only")
        return reduce(Table.plus, tables) if tables else add(*formulas)

    def _product(self, children: Children) -> Expression | Table:
        """Factors side by side, with signs of multiplication and division between them, and c before an angle."""
        factors: list[Expression | Table] = []
        function, exponent, divide = "", 1, False
        before: object = None
        for child in children:
            if isinstance(child, Token):
                divide, before = child.type == "SLASH", None
                continue
            if isinstance(child, _Digits) and isinstance(before, _Digits):
                raise _At(child.offset, CheckError("two numbers side by side", remedy=r"write \cdot between them"))
            before = child
            if not function and child is not children[-1]:
                function, exponent = self._circular(child)
                if function:
                    continue
            value = self._applied(function, child, exponent) if function else self._settled(child)
            factors.append(self._inverse(value) if divide else value)
            function, divide = "", False
        formulas = [factor for factor in factors if not isinstance(factor, Table)]
        scale = _bounded(multiply(*formulas))
        tables = [factor for factor in factors if isinstance(factor, Table)]
        if not tables:
            return scale
        return (
            reduce(Table.times, tables).changed(lambda e: multiply(scale, e))
            if formulas
            else reduce(Table.times, tables)
        )

    def _circular(self, child: Value) -> tuple[str, int]:
        """The function that c or s stands for, and the exponent that it bears."""
        base, exponent = (child.base, child.exponent) if isinstance(child, _Raised) else (child, number(1))
        if not isinstance(base, Symbol) or not isinstance(exponent, Number):
            return "", 1
        return self._names.circular(base), int(exponent.value)

    def _applied(self, function: str, child: Value, exponent: int) -> Expression:
        """``c`` before an angle, which may bear the exponent that belongs to the cosine."""
        if isinstance(child, _Raised):
            return self._power(Call(function, (self._tree(child.base),)), child.exponent)
        return power(Call(function, (self._tree(child),)), exponent)

    def _inverse(self, value: Expression | Table) -> Expression:
        if isinstance(value, Table):
            raise CheckError("division by a matrix", remedy="write the inverse out")
        return power(value, -1)

    def _matrix(self, data: str, children: Children) -> Expression | Table:
        """A matrix, a list, or the transpose of one."""
        if data == "list":
            entries = tuple(Entry(self._tree(child)) for child in children if not isinstance(child, Token))
            table = Table((entries,))
            return table.transposed if isinstance(children[-1], Token) and children[-1].type == "TRANSPOSE" else table
        first = children[0]
        value = self._tables[first.start_pos or 0] if isinstance(first, Token) else self._settled(first)
        if data == "transpose":
            if not isinstance(value, Table):
                raise CheckError("transpose of a formula", remedy="transpose matrices only")
            return value.transposed
        return value

    def _call(self, token: Token, argument: Value) -> Expression:
        return Call("sqrt" if token.type == "ROOT" else _function(token), (self._tree(argument),))

    def _power(self, base: Value, exponent: Expression) -> Expression:
        offset = base.offset if isinstance(base, Symbol) else 0
        if not isinstance(exponent, Number) or exponent.value.denominator > 2:
            raise _At(offset, CheckError("exponent that is no whole number", remedy=r"write roots as \sqrt{}"))
        tree, value = self._tree(base), exponent.value
        if value == 0:
            raise _At(offset, CheckError("exponent 0", remedy="write 1; a frame's index stands on the left side only"))
        if value.denominator == 2:
            tree, value = Call("sqrt", (tree,)), 2 * value
        inner = tree.exponent if isinstance(tree, Power) else 1
        if abs(value * inner) > FORMULA_LIMITS.exponent:
            raise _At(offset, CheckError("exponent too large", allowed=f"at most {FORMULA_LIMITS.exponent}"))
        return _bounded(power(tree, int(value)))


_NAMES_OF_FUNCTIONS = {
    "cos": "cos",
    "sen": "sin",
    "sin": "sin",
    "tan": "tan",
    "tg": "tan",
    "sgn": "sign",
    "sign": "sign",
}


def _function(token: Token) -> str:
    """``cos`` for all the ways to write it."""
    return next(function for name, function in _NAMES_OF_FUNCTIONS.items() if name in token.lower())


def _each(value: Expression | Table, change: Any) -> Expression | Table:
    return value.changed(change) if isinstance(value, Table) else change(value)


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
        case "subscript_digits", (token,):
            return token.translate(_LOWERED), token.start_pos or 0
        case (("subscript_macro" | "index_part"), (token,)):
            return _flat(token), token.start_pos or 0
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
    return number(Fraction(str(token).replace("{,}", ".")))


def _flat(token: Token) -> str:
    """The letters of a name: the macro's own name, or what stands in its braces."""
    text = str(token)
    if text.startswith("{"):  # {\it a1}
        return text[1:-1].split()[-1]
    if "{" in text:
        return "".join(text[text.index("{") + 1 : -1].replace("\\_", "_").split())
    macro = text.removeprefix("\\")
    return FLAT.get(macro, macro)


_LOWERED = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")

"""The grammar of formulas, and what each rule makes of its parts; a name is a `Symbol` until its scripts are known."""

from collections.abc import Mapping
from contextvars import ContextVar
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial, reduce
from importlib.resources import files
from typing import Any, cast

from lark import Lark, Token, Transformer, Tree

from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.names import FLAT, LatexNames, Symbol
from derive.checking.latex.typography import PRIMED
from derive.errors import CheckError, DeriveError
from derive.robot import expression as tree
from derive.robot.expression import ZERO, Call, Expression, Number, Pi, Power, Product
from derive.robot.reading.size_limits import FORMULA_LIMITS


@dataclass(frozen=True, slots=True)
class _Raised:
    """A power whose base may yet be the argument of a c or s that stands before it, as in ``c(q_1)^2``."""

    base: Any
    exponent: Expression


@dataclass(frozen=True, slots=True)
class _Digits:
    """A written number, of which two side by side are refused, but for what stands behind a fraction."""

    value: Expression
    offset: int
    is_fraction: bool = False


Value = Expression | Symbol | Table | _Raised | _Digits
Children = list[Any]


class MisplacedError(Exception):
    """An error with the offset of what caused it in the text that was read."""

    def __init__(self, offset: int | None, error: DeriveError) -> None:
        super().__init__(str(error))
        self.offset, self.error = offset or 0, error


def _refused(offset: int | None, found: str, allowed: str = "", remedy: str = "") -> MisplacedError:
    return MisplacedError(offset, CheckError(found, allowed=allowed, remedy=remedy))


def parsed(text: str, names: LatexNames, tables: Mapping[int, Expression | Table]) -> Expression | Table:
    """What a formula says."""
    grammar, token = parser("latex_formula.lark", _WhileParsing), _BUILDER.set(FormulaBuilder(names, tables))
    try:
        return cast(Expression | Table, grammar.parse(text))
    except (MisplacedError, DeriveError, ArithmeticError):
        _BUILDER.set(None)
        grammar.parse(text)  # what the grammar does not know is told first
        raise
    finally:
        _BUILDER.reset(token)


@cache
def parser(grammar: str, made: type[Transformer[Token, Any]] | None = None) -> Lark:
    """What reads the language of a grammar beside this package, by the name of its file; as trees, or what is made."""
    text = files("derive.checking").joinpath(grammar).read_text(encoding="utf-8")
    return Lark(text, parser="lalr", transformer=made() if made else None)


class FormulaBuilder:
    """Makes of every rule of the grammar an expression, a matrix, a name, or a script."""

    def __init__(self, names: LatexNames, tables: Mapping[int, Expression | Table]) -> None:
        self._names, self._tables = names, tables

    def made(self, data: str, children: Children) -> Any:
        """What a rule makes of what its parts have become."""
        match data, children:
            case ("start", (value,)) | ("bracket", (_, value, _)):
                return self._settled(value)
            case "exponent_group", (value,):
                return self._tree(value)
            case "plus", (_, value):
                return value
            case "minus", (_, value):
                return _each(self._settled(value), tree.negate)
            case "plus_minus", (token, value):
                return _each(self._settled(value), partial(tree.multiply, self._sign(token)))
            case "sum", (first, *rest):
                return self._sum(first, rest)
            case "product", _:
                return self._product(children)
            case "operand", _:
                return tree.multiply(*(_number(c) if isinstance(c, Token) else self._tree(c) for c in children))
            case "degrees", (token, _):
                return tree.multiply(_number(token), tree.number(Fraction(1, 180)), Pi())
            case "fraction", (token, above, below):
                value = tree.multiply(self._tree(above), tree.power(self._tree(below), -1))
                return _Digits(value, token.start_pos or 0, True) if isinstance(value, Number) else value
            case "over", (above, _, below):
                return tree.multiply(self._tree(above), tree.power(self._tree(below), -1))
            case "short_fraction", (token,):
                above, below = [Fraction(c) for c in token if c.isdigit()]
                return _Digits(tree.number(above / below), token.start_pos or 0, True)
            case "number", (token,):
                return _Digits(_number(token), token.start_pos or 0)
            case "round", (value,):
                return value.value if isinstance(value, _Digits) else value  # 2(9.81) is a product
            case "exponent_digit", (token,):
                return tree.number({"²": "2", "³": "3"}.get(token[-1], token[-1]))
            case "number_power", (token, exponent):
                return self._power(_number(token), exponent)
            case "bracket_power", (base, exponent):
                return _Raised(base, exponent)
            case (("matrix" | "transpose" | "list"), _):
                return self._matrix(data, children)
        return self._of_functions(data, children)

    def _of_functions(self, data: str, children: Children) -> Any:
        """Functions of one argument and of two, their powers and inverses."""
        match data, children:
            case "atan2", (token, *arguments):
                return self._of_two(token, arguments)
            case "inverse", (token, *arguments):
                return self._inverse_function(token, None, arguments)
            case "inverse_of_two", (token, exponent, *arguments):
                return self._inverse_function(token, exponent, arguments)
            case (("call" | "root_letter"), (function, argument)):
                return self._call(function, argument)
            case "absolute", (_, argument, _, *exponents):  # |x| is the root of x^2
                absolute = Call("sqrt", (tree.power(self._tree(argument), 2),))
                return self._power(absolute, exponents[0]) if exponents else absolute
            case "power_call", (function, Number(value) as exponent, argument) if value < 0:
                return self._inverse_function(function, exponent, [argument])
            case ("call_power", (function, argument, exponent)) | ("power_call", (function, exponent, argument)):
                return self._power(self._call(function, argument), exponent)
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
                    raise MisplacedError(value.offset, error) from None
        return value

    def _tree(self, value: Value) -> Expression:
        settled = self._settled(value)
        if isinstance(settled, Table):
            raise CheckError("matrix where a formula is expected", remedy="multiply and add matrices only")
        return settled

    def _sum(self, first: Value, rest: Children) -> Expression | Table:
        terms = [self._settled(first)]
        for sign, term in zip(rest[::2], rest[1::2], strict=True):
            settled = self._settled(term)
            if sign.type == "PLUS_MINUS":
                settled = _each(settled, partial(tree.multiply, self._sign(sign)))
            terms.append(_each(settled, tree.negate) if sign == "-" else settled)
        tables = [term for term in terms if isinstance(term, Table)]
        if len(tables) < len(terms) and all(table.shape == (1, 1) for table in tables):  # v^T v beside a formula
            terms, tables = [t.entries[0].formula if isinstance(t, Table) else t for t in terms], []
        formulas = [term for term in terms if not isinstance(term, Table)]
        if tables and any(formula != ZERO for formula in formulas):
            raise CheckError("sum of a matrix and a formula", remedy="add matrices only")
        return reduce(Table.plus, tables) if tables else tree.add(*formulas)

    def _product(self, children: Children) -> Expression | Table:
        """Factors side by side, with signs of multiplication and division between them, and c before an angle."""
        factors: list[Expression | Table] = []
        # what waits for the next factor: cos or sin from a c or s, its exponent, and whether a slash stands before it
        function, exponent, divide = "", 1, False
        before: object = None
        for child in children:
            if isinstance(child, Token) and child.type == "MINUS":  # a \cdot -b
                factors.append(tree.number(-1))
                continue
            if isinstance(child, Token):
                divide, before = child.type == "SLASH", None
                continue
            if isinstance(child, _Digits) and isinstance(before, _Digits) and not before.is_fraction:
                raise _refused(child.offset, "two numbers side by side", remedy=r"write \cdot between them")
            before = child
            # c before an angle, as in c \theta_1; c^2 \theta is the square of the cosine
            base, of_c = (child.base, child.exponent) if isinstance(child, _Raised) else (child, tree.number(1))
            if not function and child is not children[-1] and isinstance(base, Symbol) and isinstance(of_c, Number):
                function, exponent = self._names.circular(base), int(of_c.value)
                if function:
                    continue
            if function and isinstance(child, _Raised):  # what the angle bears belongs to the cosine
                value: Expression | Table = self._power(Call(function, (self._tree(base),)), of_c)
            else:
                value = tree.power(Call(function, (self._tree(child),)), exponent) if function else self._settled(child)
            if divide:
                if isinstance(value, Table):
                    raise CheckError("division by a matrix", remedy="write the inverse out")
                value = tree.power(value, -1)
            factors.append(value)
            function, divide = "", False
        formulas = [factor for factor in factors if not isinstance(factor, Table)]
        scale = _bounded(tree.multiply(*formulas))
        if not (tables := [factor for factor in factors if isinstance(factor, Table)]):
            return scale
        # formulas commute with the matrices, whose order stays; an entry without a factor keeps its text and place
        try:
            product = reduce(Table.times, tables)
        except CheckError:  # p x R f is p x (R f)
            product = reduce(lambda behind, before: before.times(behind), reversed(tables))
        return product.changed(partial(tree.multiply, scale)) if formulas else product

    def _matrix(self, data: str, children: Children) -> Expression | Table:
        first, last = children[0], children[-1]
        if data == "list":
            table = Table((tuple(Entry(self._tree(child)) for child in children if not isinstance(child, Token)),))
            return table.transposed if isinstance(last, Token) and last.type == "TRANSPOSE" else table
        value = self._tables[first.start_pos or 0] if isinstance(first, Token) else self._settled(first)
        if data == "transpose" and not isinstance(value, Table):
            raise CheckError("transpose of a formula", remedy="transpose matrices only")
        return value.transposed if data == "transpose" and isinstance(value, Table) else value

    def _call(self, token: Token, argument: Value) -> Expression:
        return Call("sqrt" if token.type == "ROOT" else _function(token), (self._tree(argument),))

    def _sign(self, token: Token) -> Expression:
        """A plus-minus, where it has a meaning."""
        if self._names.signs is None:
            remedy = "these are two formulas; check one sign at a time, or an inverse solution as a whole"
            raise _refused(token.start_pos, f"{token} in a formula", remedy=remedy)
        return next(self._names.signs)

    def _inverse_function(self, token: Token, exponent: Expression | None, children: Children) -> Expression:
        r"""An arc function, where it has a meaning; ``\cos^{-1}`` is one too."""
        arguments = [child for child in children if not isinstance(child, Token)]
        if self._names.signs is None:
            shown = f"inverse function {token}^{{-1}}" if exponent else f"{token} in a formula"
            raise _refused(token.start_pos, shown, remedy=r"write \operatorname{atan2}(y, x)")
        if exponent and exponent != tree.number(-1):
            raise _refused(token.start_pos, "exponent of a function", allowed="allowed: ^{-1} here")
        if len(arguments) == 2:
            return self._of_two(token, arguments)
        plain = token.lower().replace("tg", "tan")  # arctg
        return Call("a" + next(f for f in ("cos", "sin", "tan") if f in plain), (self._tree(arguments[0]),))

    def _of_two(self, token: Token, arguments: Children) -> Expression:
        """The arctangent of two arguments; in some books it has a capital and takes the cosine first."""
        may_turn = self._names.signs is not None and (token.type != "ATAN2" or "A" in token)
        both = [self._tree(argument) for argument in arguments if not isinstance(argument, Token)]
        if may_turn and self._names.cosine_first is not None:
            return Call("atan2", tuple(both[::-1] if self._names.cosine_first else both))
        return Call("Atan2" if may_turn else "atan2", tuple(both))

    def _power(self, base: Value, exponent: Expression) -> Expression:
        offset = base.offset if isinstance(base, Symbol) else 0
        if not isinstance(exponent, Number) or exponent.value.denominator > 2:
            raise _refused(offset, "the exponent is not a whole number", remedy=r"write roots as \sqrt{}")
        whole, value = self._tree(base), exponent.value  # a half one is a root: x^(3/2) = sqrt(x)^3
        if value == 0:
            raise _refused(offset, "exponent 0", remedy="write 1; a frame's index stands on the left side only")
        if value.denominator == 2:
            whole, value = Call("sqrt", (whole,)), 2 * value
        inner = whole.exponent if isinstance(whole, Power) else 1  # powers of powers are joined
        if abs(value * inner) > FORMULA_LIMITS.exponent:
            raise _refused(offset, "exponent too large", allowed=f"allowed: at most {FORMULA_LIMITS.exponent}")
        return _bounded(tree.power(whole, int(value)))


_BUILDER: ContextVar[FormulaBuilder | None] = ContextVar("builder", default=None)


class _WhileParsing(Transformer[Token, Any]):
    """Makes each part as soon as it is read: trees of a page are slow to build and to go through."""

    def __default__(self, data: str, children: Children, meta: object) -> Any:
        builder = None if data.startswith("_") else _BUILDER.get()  # repetitions have names of their own
        # and the others are tokens, which are compared slowly
        return builder.made(str(data), children) if builder else Tree(data, children)


# How books write them, in Italian ones too.
_FUNCTIONS = {"cos": "cos", "sen": "sin", "sin": "sin", "tan": "tan", "tg": "tan", "sgn": "sign", "sign": "sign"}


def _function(token: Token) -> str:
    """``cos`` for all the ways to write it."""
    return next(function for name, function in _FUNCTIONS.items() if name in token.lower())


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
                raise _refused(token.start_pos, "dot over a formula", allowed="allowed: over a joint variable")
            return Symbol(base.text, base.offset, base.dots + (2 if token.type == "DDOT" else 1))
        case (("subscript_group" | "index_group" | "index_subscript"), ((_, offset), *_)):
            return "".join(text for text, _ in children), offset
        case "subscript_character", (token,):
            return token[-1], token.start_pos or 0
        case "subscript_digits", (token,):
            return token.translate(str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")), token.start_pos or 0
        case (("subscript_macro" | "index_part"), (token,)):
            return _flat(token), token.start_pos or 0
    raise AssertionError(data)


def _symbol(base: Value, scripts: list[tuple[str, int]]) -> Symbol:
    if not isinstance(base, Symbol):
        raise _refused(scripts[0][1] if scripts else 0, "subscript of a formula", allowed="allowed: of a name")
    return Symbol(base.text + "".join(text for text, _ in scripts), base.offset, base.dots)


def _bounded(e: Expression) -> Expression:
    """The tree itself; no folded number may outgrow a float."""
    first = e.factors[0] if isinstance(e, Product) else e
    if isinstance(first, Number):
        most = FORMULA_LIMITS.number_bits
        if max(part.bit_length() for part in first.value.as_integer_ratio()) > most:
            raise CheckError("number too large or too fine", allowed=f"allowed: at most {most} bits")
    return e


def _number(token: Token) -> Expression:
    if len(token) > FORMULA_LIMITS.digits:
        raise _refused(token.start_pos, "number with too many digits", allowed=f"allowed: {FORMULA_LIMITS.digits}")
    return tree.number(Fraction(str(token).replace("{,}", ".")))


def _flat(token: Token) -> str:
    """The letters of a name: the macro's own name, or what stands in its braces."""
    if (text := str(token)).startswith("{"):  # {\it a1}
        return text[1:-1].split()[-1]
    if "{" in text:
        return "".join(text[text.index("{") + 1 : -1].replace("\\_", "_").split())
    macro = text.removeprefix("\\")
    return FLAT.get(macro, macro)

"""SymPy and back: exact expressions and printed factors as SymPy objects, SymPy's expressions as exact trees.

Symbols are plain, sines and cosines too; a tree is walked, no text is ever evaluated.
"""

from bisect import insort
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache, cmp_to_key
from typing import Any

import sympy
from sympy.core.basic import Basic

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.errors import ExpressionError, quoted
from derive.lecture.plan import FactorTable, Monomial, PrintedFactor
from derive.mechanics.vectors import Frame, Vector
from derive.robot import expression as exact
from derive.robot.expression import ZERO, Call, Expression, Name, Number, Pi, Power, Product, Sum, number
from derive.robot.reading.size_limits import CELL_LIMITS

Expr = Any  # a SymPy expression; SymPy comes without types
Matrix = Any  # a SymPy matrix; those of a model are immutable
# Factors that SymPy never merges with another or with a number.
PLAIN = frozenset({Kind.SINE, Kind.COSINE, Kind.VARIABLE, Kind.PARAMETER, Kind.RATE, Kind.ACCELERATION})
Write = Callable[[Any], Expr]  # writes an exact entry
_order = cmp_to_key(Basic.compare)

_FUNCTIONS = {name: getattr(sympy, name) for name in ("sin", "cos", "tan", "sqrt", "atan2", "sign")}
_PLAIN = _FUNCTIONS.keys() - {"sqrt"}  # a root comes as a power
_RECIPROCAL = {"sec": "cos", "csc": "sin", "cot": "tan"}


@cache
def expression_to_sympy(e: Expression) -> Expr:
    """The SymPy form of an exact expression; every name becomes a plain symbol."""
    match e:
        case Number(value):
            return sympy.Rational(value)
        case Pi():
            return sympy.pi
        case Name(name):
            return sympy.Symbol(name)
        case Sum(terms):
            return sympy.Add(*(expression_to_sympy(t) for t in terms))
        case Product(factors):
            return sympy.Mul(*(expression_to_sympy(f) for f in factors))
        case Power(base, exponent):
            return expression_to_sympy(base) ** exponent
        case Call(function, arguments):
            return _FUNCTIONS[function](*(expression_to_sympy(a) for a in arguments))


def factor_to_sympy(domain: PolynomialDomain, factor: PrintedFactor) -> Expr:
    """One printed factor as a SymPy expression."""
    argument = expression_to_sympy(factor.argument or domain.printed_angle(factor.joints))
    # SymPy would turn cos(q - pi/6) into sin(q + pi/3), and the sine of 36 degrees into nested roots
    is_plain = not argument.has(sympy.pi)
    match factor.kind:
        case Kind.SINE | Kind.CONSTANT_SINE:
            return sympy.sin(argument, evaluate=is_plain)
        case Kind.COSINE | Kind.CONSTANT_COSINE:
            return sympy.cos(argument, evaluate=is_plain)
        case Kind.ROOT | Kind.PRIME_ROOT:
            return sympy.sqrt(argument)
        case Kind.INVERSE:
            return 1 / argument
        case _:
            return argument


def expression_from_sympy(expression: Any) -> Expression:
    """A SymPy expression as an exact tree; a float stands for the decimal that it prints."""
    try:
        tree = sympy.sympify(expression, strict=True)
    except sympy.SympifyError:
        found = f"an expression of type {type(expression).__name__}"
        raise ExpressionError(found, allowed="allowed: numbers and SymPy expressions") from None
    return _tree(tree, {})


def _tree(e: Any, known: dict[Any, Expression]) -> Expression:
    """The tree of a SymPy expression; what is known already is not walked again."""
    if (found := known.get(e)) is not None:
        return found
    if e.is_Symbol:
        found = Name(e.name)
    elif e.is_Rational:
        found = number(Fraction(int(e.p), int(e.q)))
    elif e.is_Float and e.is_finite:
        found = number(Fraction(str(e)))
    elif e.is_Number:
        raise _refused(e, "finite numbers")
    elif e is sympy.pi:
        found = Pi()
    elif e.is_Add:
        found = exact.add(*(_tree(part, known) for part in e.args))
    elif e.is_Mul:
        found = exact.multiply(*(_tree(part, known) for part in e.args))
    elif e.is_Pow:
        found = _power(e, known)
    elif isinstance(e, sympy.Abs):
        found = Call("sqrt", (exact.power(_tree(e.args[0], known), 2),))
    else:
        if (name := getattr(e.func, "__name__", "")) not in _PLAIN and name not in _RECIPROCAL:
            raise _refused(e, "sums, products, powers, sin, cos, tan, sqrt, atan2 and sign")
        arguments = tuple(_tree(part, known) for part in e.args)
        found = Call(name, arguments) if name in _PLAIN else exact.power(Call(_RECIPROCAL[name], arguments[:1]), -1)
    known[e] = found
    return found


def _power(e: Any, known: dict[Any, Expression]) -> Expression:
    base, exponent = e.args
    if not exponent.is_Rational or exponent.q > 2 or abs(exponent.p) > CELL_LIMITS.exponent:
        raise _refused(e, "whole and half exponents up to 32")
    inner = _tree(base, known)
    if exponent.q == 2:  # x^(p/2) = sqrt(x)^p
        inner = Call("sqrt", (inner,))
    if inner == ZERO and exponent < 0:
        raise ExpressionError(f"division by zero in {quoted(str(e), 80)}")
    return exact.power(inner, int(exponent.p))


def _refused(e: Any, allowed: str) -> ExpressionError:
    return ExpressionError(f"SymPy expression {quoted(str(e), 80)}", allowed=allowed)


def frame_matrix(frame: Frame[Any], write: Write = lambda value: value) -> Matrix:
    """A frame as a homogeneous matrix, 4x4."""
    rows = [[*map(write, frame.rotation[i]), write(frame.position[i])] for i in range(3)]
    return sympy.ImmutableMatrix([*rows, [0, 0, 0, 1]])


def columns_matrix(
    linear: Sequence[Vector[Any]], angular: Sequence[Vector[Any]] | None = None, write: Write = lambda value: value
) -> Matrix:
    """A Jacobian from its columns: 3xn, or 6xn with the linear rows first."""
    halves = [linear] if angular is None else [linear, angular]
    columns = [[write(x) for vector in parts for x in vector] for parts in zip(*halves, strict=True)]
    return sympy.ImmutableMatrix(columns).T


def aligned_latex(lines: Sequence[str]) -> str:
    """Equations below each other, aligned at their left, as a notebook shows them."""
    body = " \\\\ ".join(f"& {line}" for line in lines)
    return f"$\\displaystyle \\begin{{aligned}} {body} \\end{{aligned}}$"


class ProductBuilder:
    """Turns monomials into SymPy products, whose order is found once, by insertion: SymPy takes long for it."""

    def __init__(self, table: FactorTable) -> None:
        self._table = table
        self._powers: dict[tuple[int, int], Expr] = {}
        self._sorted: list[Any] = []
        self._rank: dict[tuple[int, int], int] = {}
        self.term = cache(self._term)

    def _term(self, coefficient: Fraction, monomial: Monomial) -> Expr:
        """coefficient * monomial as SymPy's own product would be."""
        number = sympy.Rational(coefficient)
        powers = [self._power(pair) for pair in monomial]
        factors = [self._table.factors[f] for f, _ in monomial]
        is_plain = all(factor.kind in PLAIN for factor in factors) and not any(power.is_Mul for power in powers)
        if not coefficient or not monomial or not is_plain:
            # roots and numbers may merge: sqrt(2)*sqrt(2), 2*sqrt(2)/2; sin(q3 - q2) is -sin(q2 - q3)
            return sympy.Mul(number, *powers)
        if len(powers) == 1 and coefficient == 1:
            return powers[0]
        # factors that never merge, in SymPy's own order: the product that Mul would give, without its work
        ordered = [self._powers[pair] for pair in sorted(monomial, key=self._rank.__getitem__)]
        return sympy.Mul._from_args(ordered if coefficient == 1 else [number, *ordered])

    def _power(self, pair: tuple[int, int]) -> Expr:
        if pair not in self._powers:
            factor, exponent = pair
            value = factor_to_sympy(self._table.domain, self._table.factors[factor]) ** exponent
            self._powers[pair] = value
            insort(self._sorted, (_order(value), pair), key=lambda item: item[0])
            self._rank = {p: i for i, (_, p) in enumerate(self._sorted)}
        return self._powers[pair]

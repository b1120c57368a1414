"""A closed form at a point: a number where every symbol of it has one, else what remains in the others.

Numbers are computed with fifty digits, each subexpression once. What cancels exactly is zero then, so an angle that has
no value at the point, atan2(0, 0), is noticed.
"""

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import mpmath
import sympy

from derive.errors import QuantityError
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.robot.expression import Expression
from derive.robot.rounding import shown

Real = Any  # a number of mpmath, which comes without types
DIGITS = 50
KEPT = 30  # digits that are given out; what rounding spoils lies behind them
NOISE = mpmath.mpf(10) ** -40  # of its largest term, or of 1 for a sine: what is left of a zero that rounding hides


def _direction(y: Real, x: Real) -> Real:
    if not x and not y:
        raise ZeroDivisionError("atan2(0, 0)")
    return mpmath.atan2(y, x)


_FUNCTIONS: Mapping[Any, Callable[..., Real]] = {
    **{getattr(sympy, name): getattr(mpmath, name) for name in ("sin", "cos", "tan", "sign")},
    **{sympy.atan2: _direction, sympy.Abs: abs},
}


def at_point(
    expression: Expr,
    values: Mapping[str, Expression],
    *,
    name: str = "the quantity",
    exact: bool = False,
    digits: int | None = None,  # significant ones of the numbers where symbols stay; None for thirty
) -> Expr:
    """An expression or matrix with numbers put in."""
    put_in = {sympy.Symbol(name): expression_to_sympy(value) for name, value in values.items()}
    if exact:
        if (found := expression.xreplace(put_in)).has(sympy.nan, sympy.zoo, sympy.oo, sympy.I):
            raise QuantityError(f"{name} has no finite real value here", remedy="choose another point")
        return found
    with mpmath.workdps(DIGITS):
        try:
            known = {symbol: value_of(value, {}) for symbol, value in put_in.items()}
            found = _for_each_entry(expression, lambda entry: written(value_of(entry, known)))
        except (ArithmeticError, ValueError):
            raise QuantityError(f"{name} has no finite real value here", remedy="choose another point") from None
    is_rounded = digits is not None and found.free_symbols
    return _for_each_entry(found, lambda entry: _rounded(entry, digits)) if is_rounded else found


def _for_each_entry(value: Expr, change: Callable[[Expr], Expr]) -> Expr:
    return value.applyfunc(change) if hasattr(value, "applyfunc") else change(value)


def _rounded(e: Expr, digits: int | None) -> Expr:
    """Numbers in so many digits, as they are shown; exponents stay."""
    if e.is_Rational:
        value = shown(Fraction(int(e.p), int(e.q)), decimals=True, digits=digits)
        return sympy.Rational(value) if isinstance(value, Fraction) else sympy.Float(str(value), digits)
    if e.is_Pow:
        return e.func(_rounded(e.base, digits), e.exp)
    return e.func(*(_rounded(part, digits) for part in e.args)) if e.args else e


def value_of(e: Expr, known: dict[Expr, Any]) -> Any:
    """The number of an expression, or the expression with numbers in it where a symbol has none."""
    if e in known:
        return known[e]
    if e.is_Symbol:
        return e
    if e.is_Rational:
        found = mpmath.mpf(int(e.p)) / int(e.q)
    elif e is sympy.pi:
        found = +mpmath.pi
    else:
        arguments = [value_of(argument, known) for argument in e.args]
        if any(isinstance(argument, sympy.Basic) for argument in arguments):
            found = e.func(*map(written, arguments))
        else:
            found = _number(e, arguments)
    known[e] = found
    return found


def _number(e: Expr, arguments: list[Real]) -> Real:
    if e.is_Mul:
        return mpmath.fprod(arguments)
    if e.is_Pow:
        # a complex number: the quantity has no real value here
        if isinstance(found := mpmath.power(*arguments), mpmath.mpc):
            raise ValueError("root of a negative number")
        return found
    # a sum is compared with its largest term, a sine with 1: below the noise it is a zero that rounding hides
    if e.is_Add:
        found, size = mpmath.fsum(arguments), max(map(abs, arguments))
    else:
        found, size = _FUNCTIONS[e.func](*arguments), 1
    return mpmath.mpf(0) if abs(found) < NOISE * size else found


def written(value: Any) -> Expr:
    """A number of mpmath as the rational of its first thirty digits; an expression as it is."""
    return value if isinstance(value, sympy.Basic) else sympy.Rational(Fraction(mpmath.nstr(value, KEPT)))

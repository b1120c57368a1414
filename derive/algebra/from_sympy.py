"""SymPy expressions as exact expression trees; the tree is walked, no text is ever evaluated."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import sympy

from derive.errors import ExpressionError, quoted
from derive.robot.expression import ZERO, Call, Expression, Name, Pi, add, multiply, number, power
from derive.robot.limits import CELL_LIMITS

_PLAIN = {"sin", "cos", "tan", "atan2", "sign"}
_RECIPROCAL = {"sec": "cos", "csc": "sin", "cot": "tan"}


def expression_from_sympy(expression: Any) -> Expression:
    """A SymPy expression as an exact tree; a float stands for the decimal that it prints.

    Args:
        expression: Sums, products, powers with whole or half exponents, sin, cos, tan (and their reciprocals), sqrt,
            atan2 and sign of symbols, rationals, floats and pi.

    Raises:
        ExpressionError: Anything else, or a division by zero.
    """
    try:
        tree = sympy.sympify(expression, strict=True)
    except sympy.SympifyError:
        kind = type(expression).__name__
        raise ExpressionError(f"an expression of type {kind}", allowed="numbers and SymPy expressions") from None
    return _Walker().walk(tree)


class _Walker:
    """Shared subexpressions are walked once, and their trees are shared too."""

    def __init__(self) -> None:
        self._known: dict[Any, Expression] = {}

    def walk(self, e: Any) -> Expression:
        if e not in self._known:
            self._known[e] = self._walk(e)
        return self._known[e]

    def _walk(self, e: Any) -> Expression:
        if e.is_Symbol:
            return Name(e.name)
        if e.is_Number:
            return _number(e)
        if e is sympy.pi:
            return Pi()
        if e.is_Add:
            return add(*map(self.walk, e.args))
        if e.is_Mul:
            return multiply(*map(self.walk, e.args))
        if e.is_Pow:
            return self._power(e)
        return self._function(e)

    def _power(self, e: Any) -> Expression:
        base, exponent = e.args
        if not exponent.is_Rational or exponent.q > 2 or abs(exponent.p) > CELL_LIMITS.exponent:
            raise _refused(e, "whole and half exponents up to 32")
        inner = self.walk(base)
        if exponent.q == 2:
            inner = Call("sqrt", (inner,))
        if inner == ZERO and exponent < 0:
            raise ExpressionError(f"division by zero in {quoted(str(e), 80)}")
        return power(inner, int(exponent.p))

    def _function(self, e: Any) -> Expression:
        name = getattr(e.func, "__name__", "")
        if name in _PLAIN:
            return Call(name, tuple(map(self.walk, e.args)))
        if name in _RECIPROCAL:
            return power(Call(_RECIPROCAL[name], (self.walk(e.args[0]),)), -1)
        raise _refused(e, "sums, products, powers, sin, cos, tan, sqrt, atan2 and sign")


def _number(e: Any) -> Expression:
    if e.is_Rational:
        return number(Fraction(int(e.p), int(e.q)))
    if e.is_Float and e.is_finite:
        return number(Fraction(str(e)))
    raise _refused(e, "finite numbers")


def _refused(e: Any, allowed: str) -> ExpressionError:
    return ExpressionError(f"SymPy expression {quoted(str(e), 80)}", allowed=allowed)

"""SymPy expressions as exact expression trees; the tree is walked, no text is ever evaluated."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import sympy

from derive.errors import ExpressionError, quoted
from derive.robot.expression import ZERO, Call, Expression, Name, Pi, add, multiply, number, power
from derive.robot.size_limits import CELL_LIMITS

_PLAIN = {"sin", "cos", "tan", "atan2", "sign"}
_RECIPROCAL = {"sec": "cos", "csc": "sin", "cot": "tan"}


def expression_from_sympy(expression: Any) -> Expression:
    """A SymPy expression as an exact tree; a float stands for the decimal that it prints.

    Args:
        expression: Sums, products, powers with whole or half exponents, sin, cos, tan (and their reciprocals), sqrt,
            atan2 and sign of symbols, rationals, floats and pi.

    Returns:
        The tree; subexpressions that SymPy shares are shared in it too.

    Raises:
        ExpressionError: Anything else, or a division by zero.
    """
    try:
        tree = sympy.sympify(expression, strict=True)
    except sympy.SympifyError:
        kind = type(expression).__name__
        raise ExpressionError(f"an expression of type {kind}", allowed="numbers and SymPy expressions") from None
    return _tree(tree, {})


def _tree(e: Any, known: dict[Any, Expression]) -> Expression:
    """The tree of a SymPy expression; what is known already is not walked again."""
    found = known.get(e)
    if found is not None:
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
        found = add(*(_tree(part, known) for part in e.args))
    elif e.is_Mul:
        found = multiply(*(_tree(part, known) for part in e.args))
    elif e.is_Pow:
        found = _power(e, known)
    else:
        name = getattr(e.func, "__name__", "")
        if name not in _PLAIN and name not in _RECIPROCAL:
            raise _refused(e, "sums, products, powers, sin, cos, tan, sqrt, atan2 and sign")
        arguments = tuple(_tree(part, known) for part in e.args)
        found = Call(name, arguments) if name in _PLAIN else power(Call(_RECIPROCAL[name], arguments[:1]), -1)
    known[e] = found
    return found


def _power(e: Any, known: dict[Any, Expression]) -> Expression:
    base, exponent = e.args
    if not exponent.is_Rational or exponent.q > 2 or abs(exponent.p) > CELL_LIMITS.exponent:
        raise _refused(e, "whole and half exponents up to 32")
    inner = _tree(base, known)
    if exponent.q == 2:
        inner = Call("sqrt", (inner,))
    if inner == ZERO and exponent < 0:
        raise ExpressionError(f"division by zero in {quoted(str(e), 80)}")
    return power(inner, int(exponent.p))


def _refused(e: Any, allowed: str) -> ExpressionError:
    return ExpressionError(f"SymPy expression {quoted(str(e), 80)}", allowed=allowed)

"""Expressions of a robot file in another system's arithmetic."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from operator import add, mul
from typing import Any

from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, names

_ROUNDING = 1e-15
"""What the sine of a rounded pi leaves where 0 is meant."""


@dataclass(frozen=True)
class Arithmetic:
    """A system of expressions.

    Attributes:
        number: From a float.
        functions: ``sin``, ``cos``, ``tan`` and ``sqrt``.
        symbol: A fresh symbol of a name.
        is_number: Whether an expression is a number.
    """

    number: Callable[[float], Any]
    functions: Mapping[str, Callable[[Any], Any]]
    symbol: Callable[[str], Any]
    is_number: Callable[[Any], bool]

    def value(self, expression: Expression, values: Mapping[str, Any]) -> Any:
        """An expression with ``values`` for its names."""
        match expression:
            case Number(value):
                return self.number(float(value))
            case Pi():
                return self.number(3.141592653589793)
            case Name(name):
                return values[name]
            case Sum(terms):
                return reduce(add, (self.value(term, values) for term in terms))
            case Product(factors):
                return reduce(mul, (self.value(factor, values) for factor in factors))
            case Power(base, exponent):
                return self.value(base, values) ** exponent
            case Call(function, arguments):
                return self.functions[function](self.value(arguments[0], values))

    def sine(self, angle: Expression, values: Mapping[str, Any], name: str = "sin") -> Any:
        """Sine (or cosine) of a constant angle; exactly 0 or 1 of multiples of pi/2."""
        result = self.functions[name](self.value(angle, values))
        if any(True for _ in names(angle)):
            return result
        rounded = round(float(result))
        return self.number(float(rounded)) if abs(float(result) - rounded) < _ROUNDING else result

"""The exact expression tree that the cell grammar yields.

A tree holds rationals, pi, names and the functions of the grammar; it is data, and nothing in it can be executed.
Division is a negative power, subtraction a product with -1.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class Number:
    """An exact rational."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class Pi:
    """The constant pi."""


@dataclass(frozen=True, slots=True)
class Name:
    """A user's symbol: a parameter or a joint variable."""

    name: str


@dataclass(frozen=True, slots=True)
class Sum:
    """The sum ``terms[0] + terms[1] + ...``."""

    terms: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Product:
    """The product ``factors[0] * factors[1] * ...``."""

    factors: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Power:
    """``base ** exponent`` with an integer exponent, which may be negative."""

    base: Expression
    exponent: int


@dataclass(frozen=True, slots=True)
class Call:
    """``function(arguments)``; sin, cos, tan, sqrt and, in printed formulas only, atan2."""

    function: str
    arguments: tuple[Expression, ...]


Expression = Number | Pi | Name | Sum | Product | Power | Call

ZERO = Number(Fraction(0))
ONE = Number(Fraction(1))
MINUS_ONE = Number(Fraction(-1))


def children(expression: Expression) -> tuple[Expression, ...]:
    """The direct subexpressions."""
    match expression:
        case Sum(terms):
            return terms
        case Product(factors):
            return factors
        case Power(base, _):
            return (base,)
        case Call(_, arguments):
            return arguments
        case _:
            return ()


def names(expression: Expression) -> Iterator[str]:
    """Every name in the tree, in order of appearance, repeats included."""
    stack = [expression]
    while stack:
        node = stack.pop()
        if isinstance(node, Name):
            yield node.name
        stack.extend(reversed(children(node)))

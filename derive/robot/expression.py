"""The exact expression tree that the cell grammar yields.

A tree holds rationals, pi, names and the functions of the grammar; it is data, and nothing in it can be executed.
Division is a negative power, subtraction a product with -1.

Constructors of expression trees that flatten sums and products and fold numbers, and nothing else.

How many terms an expression may have when it is multiplied out: an upper bound, found without doing it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import comb, prod


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


def number(value: int | Fraction | str) -> Number:
    """An exact number from an integer, a fraction or decimal text."""
    return Number(Fraction(value))


def add(*terms: Expression) -> Expression:
    """Sum with nested sums flattened; all numbers become one, at the place of the first."""
    flat: list[Expression] = []
    place: int | None = None
    total = Fraction(0)
    for term in _flatten_sums(terms):
        if isinstance(term, Number):
            total += term.value
            place = len(flat) if place is None else place
        else:
            flat.append(term)
    if place is not None and total != 0:
        flat.insert(place, Number(total))
    return _single(flat, ZERO) or Sum(tuple(flat))


def multiply(*factors: Expression) -> Expression:
    """Product with nested products flattened; all numbers become one coefficient in front."""
    coefficient = Fraction(1)
    flat: list[Expression] = []
    for factor in _flatten_products(factors):
        if isinstance(factor, Number):
            coefficient *= factor.value
        else:
            flat.append(factor)
    if coefficient == 0:
        return ZERO
    if coefficient != 1:
        flat.insert(0, Number(coefficient))
    return _single(flat, ONE) or Product(tuple(flat))


def power(base: Expression, exponent: int) -> Expression:
    """Integer power; numbers are folded and powers of powers joined.

    Raises:
        ZeroDivisionError: The base is zero and the exponent negative.
    """
    if exponent == 0:
        return ONE
    if exponent == 1:
        return base
    if isinstance(base, Number):
        return Number(base.value**exponent)
    if isinstance(base, Power):
        return power(base.base, base.exponent * exponent)
    return Power(base, exponent)


def negate(expression: Expression) -> Expression:
    """Minus the expression."""
    return multiply(MINUS_ONE, expression)


def linear_terms(expression: Expression) -> tuple[tuple[Fraction, Expression], ...]:
    """Pairs (coefficient, term) whose sum is the expression; a numeric factor is carried into a sum.

    ``-(q1 + 90)`` gives ``(-1, q1), (-90, 1)``.
    """
    match expression:
        case Number(value):
            return ((value, ONE),)
        case Sum(terms):
            return tuple(pair for term in terms for pair in linear_terms(term))
        case Product((Number(value), *rest)):
            return tuple((value * c, term) for c, term in linear_terms(multiply(*rest)))
        case _:
            return ((Fraction(1), expression),)


def is_constant(expression: Expression) -> bool:
    """Whether no name occurs in the expression."""
    return next(names(expression), None) is None


def contains_pi(expression: Expression) -> bool:
    """Whether pi occurs outside the arguments of functions."""
    match expression:
        case Pi():
            return True
        case Sum(parts) | Product(parts):
            return any(contains_pi(part) for part in parts)
        case Power(base, _):
            return contains_pi(base)
        case _:
            return False


def substitute(expression: Expression, values: dict[str, Expression]) -> Expression:
    """The expression with names replaced by other expressions."""
    match expression:
        case Name(name):
            return values.get(name, expression)
        case Sum(parts):
            return add(*(substitute(part, values) for part in parts))
        case Product(parts):
            return multiply(*(substitute(part, values) for part in parts))
        case Power(base, exponent):
            return power(substitute(base, values), exponent)
        case Call(function, arguments):
            return Call(function, tuple(substitute(a, values) for a in arguments))
        case _:
            return expression


def _flatten_sums(terms: Iterable[Expression]) -> Iterable[Expression]:
    for term in terms:
        if isinstance(term, Sum):
            yield from term.terms
        else:
            yield term


def _flatten_products(factors: Iterable[Expression]) -> Iterable[Expression]:
    for factor in factors:
        if isinstance(factor, Product):
            yield from factor.factors
        else:
            yield factor


def _single(parts: list[Expression], empty: Expression) -> Expression | None:
    if not parts:
        return empty
    return parts[0] if len(parts) == 1 else None


def expanded_terms(expression: Expression, stop: int) -> int:
    """Upper bound of the number of terms of the expanded expression, and of any function's argument.

    A power of a sum of t terms has ``comb(t + e - 1, e)`` terms; denominators count like numerators.

    Args:
        expression: Any tree.
        stop: Results beyond it are returned as ``stop + 1``.
    """
    match expression:
        case Sum(terms):
            count = sum(expanded_terms(term, stop) for term in terms)
        case Product(factors):
            count = _bounded_product([expanded_terms(factor, stop) for factor in factors], stop)
        case Power(base, exponent):
            width = expanded_terms(base, stop)
            count = 1 if width == 1 else comb(width + abs(exponent) - 1, abs(exponent))
        case Call(_, arguments):
            inner = max(expanded_terms(argument, stop) for argument in arguments)
            count = inner if inner > stop else 1
        case _:
            count = 1
    return min(count, stop + 1)


def _bounded_product(counts: list[int], stop: int) -> int:
    large = [count for count in counts if count > 1]
    bits = sum(count.bit_length() - 1 for count in large)
    return stop + 1 if bits > stop.bit_length() else prod(large)

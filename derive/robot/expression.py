"""The exact expression tree that the cell grammar yields, its constructors, and its text.

A tree holds rationals, pi, names and the functions of the grammar; it is data, and nothing in it can be executed.
Division is a negative power, subtraction a product with -1. The constructors `add`, `multiply` and `power` flatten
sums and products and fold numbers, and nothing else; `to_text` writes what the parser reads back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import comb, prod
from operator import is_


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


def number(value: int | Fraction | str) -> Number:
    """An exact number."""
    return Number(Fraction(value))


def add(*terms: Expression) -> Expression:
    """Sum with nested sums flattened; all numbers become one, at the place of the first."""
    flat: list[Expression] = []
    place: int | None = None
    total = Fraction(0)
    for term in terms:
        for part in term.terms if isinstance(term, Sum) else (term,):
            if isinstance(part, Number):
                total += part.value
                place = len(flat) if place is None else place
            else:
                flat.append(part)
    if place is not None and total != 0:  # at its place: messages do not turn 1 - k round
        flat.insert(place, Number(total))
    if not flat:
        return ZERO
    return flat[0] if len(flat) == 1 else Sum(tuple(flat))


def multiply(*factors: Expression) -> Expression:
    """Product with nested products flattened; all numbers become one coefficient in front."""
    coefficient = Fraction(1)  # exact, so that 3 (1/3) a is a
    flat: list[Expression] = []
    for factor in factors:
        for part in factor.factors if isinstance(factor, Product) else (factor,):
            if isinstance(part, Number):
                coefficient *= part.value
            else:
                flat.append(part)
    if coefficient == 0:
        return ZERO
    if coefficient != 1:
        flat.insert(0, Number(coefficient))
    if not flat:
        return ONE
    return flat[0] if len(flat) == 1 else Product(tuple(flat))


def power(base: Expression, exponent: int) -> Expression:
    """Integer power; numbers are folded and powers of powers joined."""
    if exponent == 0:
        return ONE
    if exponent == 1:
        return base
    if isinstance(base, Number):
        return Number(base.value**exponent)
    return power(base.base, base.exponent * exponent) if isinstance(base, Power) else Power(base, exponent)


def negate(expression: Expression) -> Expression:
    """Minus the expression."""
    return multiply(MINUS_ONE, expression)


def children(expression: Expression) -> tuple[Expression, ...]:
    """The direct subexpressions."""
    match expression:
        case Sum(parts) | Product(parts) | Call(_, parts):
            return parts
        case Power(base, _):
            return (base,)
        case _:
            return ()


def rebuilt(e: Expression, change: Callable[[Expression], Expression], *, folds: bool = True) -> Expression:
    """The expression with each direct subexpression replaced; else than by default nothing is flattened or folded."""
    parts = tuple(map(change, own := children(e)))
    if all(map(is_, parts, own)) and not (folds and own):
        return e
    match e:
        case Sum():
            return add(*parts) if folds else Sum(parts)
        case Product():
            return multiply(*parts) if folds else Product(parts)
        case Power(_, exponent):
            return power(parts[0], exponent) if folds else Power(parts[0], exponent)
        case Call(function, _):
            return Call(function, parts)
    return e


def substitute(expression: Expression, values: Mapping[str, Expression]) -> Expression:
    """The expression with names replaced by other expressions, all at once."""
    if isinstance(expression, Name):
        return values.get(expression.name, expression)
    return rebuilt(expression, lambda part: substitute(part, values))


def names(expression: Expression) -> Iterator[str]:
    """Every name in the tree."""
    stack = [expression]
    while stack:
        node = stack.pop()
        if isinstance(node, Name):
            yield node.name
        stack.extend(reversed(children(node)))


def is_constant(expression: Expression) -> bool:
    """Whether no name occurs in the expression."""
    return next(names(expression), None) is None


def contains_pi(expression: Expression) -> bool:
    """Whether pi occurs outside the arguments of functions."""
    if isinstance(expression, Call):
        return False
    return isinstance(expression, Pi) or any(map(contains_pi, children(expression)))


def linear_terms(expression: Expression) -> tuple[tuple[Fraction, Expression], ...]:
    """Pairs (coefficient, term) whose sum is the expression; a numeric factor is carried into a sum."""
    match expression:
        case Number(value):
            return ((value, ONE),)
        case Sum(terms):
            return tuple(pair for term in terms for pair in linear_terms(term))
        case Product((Number(value), *rest)):  # c (a + b) = c a + c b
            return tuple((value * c, term) for c, term in linear_terms(multiply(*rest)))
        case _:
            return ((Fraction(1), expression),)


def expanded_terms(expression: Expression, stop: int) -> int:
    """Upper bound of the number of terms after multiplying out, found without doing it."""
    # Denominators and arguments of functions count too.
    match expression:
        case Sum(terms):
            count = sum(expanded_terms(term, stop) for term in terms)
        case Product(factors):
            # (a + b)(c + d) has 2 2 terms; where the bits of the widths alone exceed the bound nothing is multiplied
            widths = [width for factor in factors if (width := expanded_terms(factor, stop)) > 1]
            bits = sum(width.bit_length() - 1 for width in widths)
            count = stop + 1 if bits > stop.bit_length() else prod(widths)
        case Power(base, exponent):
            width = expanded_terms(base, stop)
            # terms of (x_1 + ... + x_t)^e: multisets of e out of t
            count = 1 if width == 1 else comb(width + abs(exponent) - 1, abs(exponent))
        case Call(_, arguments):
            inner = max(expanded_terms(argument, stop) for argument in arguments)
            count = inner if inner > stop else 1
        case _:
            count = 1
    return min(count, stop + 1)


def to_text(expression: Expression, write: Callable[[Fraction], str] = str) -> str:
    """The expression as a user would write it in a cell; parsing the text gives the tree back."""
    match expression:
        case Number(value):
            return write(value)
        case Pi():
            return "pi"
        case Name(name):
            return name
        case Sum(terms):
            first, *rest = (to_text(term, write) for term in terms)
            return first + "".join(f" - {term[1:]}" if term.startswith("-") else f" + {term}" for term in rest)
        case Product(factors):
            return _product_text(factors, write)
        case Power(base, exponent):
            return f"{_base_text(base, write)}**{exponent}" if exponent > 0 else _product_text((expression,), write)
        case Call(function, arguments):
            return f"{function}({', '.join(to_text(argument, write) for argument in arguments)})"


def multiple_of_pi(factor: Fraction) -> str:
    """A multiple of pi as a cell."""
    sign, top = "-" if factor < 0 else "", abs(factor.numerator)
    times = "" if top == 1 else f"{top}*"
    return f"{sign}{times}pi" + (f"/{factor.denominator}" if factor.denominator != 1 else "")


def _product_text(factors: tuple[Expression, ...], write: Callable[[Fraction], str]) -> str:
    """A product with a fraction's denominator and negative powers behind slashes: ``-2*a1/(3*b)`` as ``-2*a1/b/3``."""
    # -2/3 a b^-1 as -2*a/b/3: the numerator in front, each divisor behind a slash, the denominator last
    coefficient = Fraction(1)
    if isinstance(factors[0], Number):
        coefficient, factors = factors[0].value, factors[1:]
    text, _, denominator = (str if Pi() in factors else write)(abs(coefficient)).partition("/")
    text = "" if text == "1" else text
    for factor in factors:
        if isinstance(factor, Power) and factor.exponent < 0:
            exponent = "" if factor.exponent == -1 else f"**{-factor.exponent}"
            text = f"{text or '1'}/{_base_text(factor.base, write)}{exponent}"
        else:
            shown = f"({to_text(factor, write)})" if isinstance(factor, Sum) else to_text(factor, write)
            text += ("*" if text else "") + shown
    return ("-" if coefficient < 0 else "") + text + (f"/{denominator}" if denominator else "")


def _base_text(expression: Expression, write: Callable[[Fraction], str]) -> str:
    """The base of a power, in parentheses unless it binds by itself."""
    plain = isinstance(expression, Name | Pi | Call)
    if isinstance(expression, Number):
        plain = expression.value.denominator == 1 and expression.value >= 0
    return to_text(expression, write) if plain else f"({to_text(expression, write)})"

"""SymPy expressions in the notation of lecture notes, as pieces that the layout can break."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from sympy import Add, Integer, S, pi

from derive.errors import TargetError
from derive.handout.notation.notation import Notation
from derive.handout.notation.numbers import magnitude
from derive.handout.notation.order import Order
from derive.handout.notation.pieces import (
    EMPTY,
    MINUS_WIDTH,
    Box,
    Break,
    Piece,
    binary,
    brackets,
    concatenate,
    fraction,
    greek,
    highest_nest,
    italic,
    joined,
    operator,
    script,
)

WIDEST_FRACTION = 120.0
"""Widest numerator or denominator [pt]; a wider quotient is written with negative powers, which can be broken."""

_HALF, _ONE = S.Half, S.One

MINUS = Piece(Box("-", MINUS_WIDTH))
ONE = italic("1")

_FUNCTIONS = {"sign": "sgn", "atan2": "atan2", "Abs": "abs", "acos": "arccos", "asin": "arcsin", "atan": "arctan"}

Pieces = list[Piece]
Power = tuple[Any, Any]


class LatexPrinter:
    """Prints the expressions of one robot.

    Args:
        notation: The robot's notation.
    """

    def __init__(self, notation: Notation) -> None:
        self.notation = notation
        self._order = Order(notation)
        self._written: dict[tuple[Any, int], tuple[Piece, ...]] = {}

    def latex(self, expression: Any) -> str:
        """One line of LaTeX, for mathematics mode."""
        return joined(self.pieces(expression)).tex

    def pieces(self, expression: Any) -> Pieces:
        """The expression as pieces, from left to right."""
        return self._expression(expression, 0)

    def _expression(self, expression: Any, depth: int) -> Pieces:
        """Written once: a root inside a root is measured before it is placed, which doubles the work at each level."""
        key = (expression, depth)
        if key not in self._written:
            self._written[key] = tuple(self._sum(expression, depth))
        return list(self._written[key])

    def _sum(self, expression: Any, depth: int) -> Pieces:
        terms = expression.args if expression.is_Add else (expression,)
        row: Pieces = []
        for term in sorted(terms, key=self._order.term):
            negative, pieces = self._term(term, depth)
            if row:
                row.append(binary("-" if negative else "+", depth))
            elif negative:
                row.append(MINUS)
            row += pieces
        return row

    def _term(self, term: Any, depth: int) -> tuple[bool, Pieces]:
        """Whether the term is negative, and its absolute value."""
        coefficient, rest = term.as_coeff_Mul()
        if not coefficient.is_Rational:
            coefficient, rest = type(coefficient)(1), term
        factors = rest.args if rest.is_Mul else () if rest is _ONE else (rest,)
        powers = [factor.as_base_exp() for factor in sorted(factors, key=self._order.factor)]
        value = Fraction(int(coefficient.p), int(coefficient.q))
        for index, (base, exponent) in enumerate(powers):
            if exponent is _ONE and base.is_Add and all(map(_is_negative, base.args)):
                powers[index] = (_opposite(base), exponent)
                value = -value
        return value < 0, self._product(abs(value), powers, depth)

    def _product(self, value: Fraction, powers: list[Power], depth: int) -> Pieces:
        leading, powers = self._leading(value, powers)
        row = [Piece(leading, depth=depth)] if leading.tex else []
        for pieces in self._factors(powers, depth):
            if row:
                pieces[0] = pieces[0]._replace(before=Break.FACTOR, depth=depth)
            row += pieces
        return row or [Piece(ONE, depth=depth)]

    def _factors(self, powers: list[Power], depth: int) -> Iterator[Pieces]:
        r"""Each power; where functions are written in full and a factor follows, the argument ends with a bracket.

        ``\cos \theta_{1}\dot{\theta}_{1}`` could be the cosine of the product.
        """
        for (base, exponent), following in zip(powers, (*powers[1:], None), strict=False):
            follows = following is not None and not _is_circular(following[0])
            yield self._power(base, exponent, depth, closed=follows and not self.notation.abbreviates)

    def _leading(self, value: Fraction, powers: list[Power]) -> tuple[Box, list[Power]]:
        """The number, the quotient of parameters or both in front of a product, and the powers that remain."""
        below = [(base, -exponent) for base, exponent in powers if _is_below(exponent)]
        constants = [power for power in powers if _is_constant(power[0]) and not _is_below(power[1])]
        if not below and not constants:
            plain = value == 1 and powers
            return (EMPTY if plain else self._magnitude(value)), powers
        quotient = self._quotient(value, powers, below)
        if quotient is not None:
            return quotient
        rest = [power for power in powers if power not in constants]
        number = EMPTY if value == 1 else self._magnitude(value)
        return concatenate(number, *(self._box(*power) for power in constants)), rest

    def _quotient(self, value: Fraction, powers: list[Power], below: list[Power]) -> tuple[Box, list[Power]] | None:
        """Numbers and parameters over each other, if there is a denominator and both sides are short."""
        if not below and (value.denominator == 1 or self._as_decimal(value, powers)):
            return None
        simple = [power for power in powers if not _is_below(power[1]) and self._is_simple(power[0], bool(below))]
        numerator = self._side(value.numerator, simple)
        denominator = self._side(value.denominator, below)
        if max(numerator.width, denominator.width) > WIDEST_FRACTION:
            return None
        rest = [power for power in powers if power not in simple and not _is_below(power[1])]
        return fraction(numerator, denominator, small=not below), rest

    def _as_decimal(self, value: Fraction, powers: list[Power]) -> bool:
        """Whether the coefficient is printed as a decimal; multiples of pi never are."""
        angle = any(base.is_NumberSymbol for base, _ in powers)
        return not angle and "frac" not in self._magnitude(value).tex

    def _is_simple(self, base: Any, with_parameters: bool) -> bool:
        position = self.notation.positions.get(base.name) if base.is_Symbol else None
        return _is_constant(base) or (with_parameters and position is not None and position[0] == 0)

    def _side(self, number: int, powers: list[Power]) -> Box:
        if len(powers) == 1 and number == 1 and powers[0][1] == 1:
            return joined(self._expression(powers[0][0], 0))
        boxes = [] if number == 1 and powers else [self._magnitude(Fraction(number))]
        return concatenate(*boxes, *map(joined, self._factors(powers, 0)))

    def _magnitude(self, value: Fraction) -> Box:
        return magnitude(value, self.notation.decimals, digits=self.notation.digits)

    def _box(self, base: Any, exponent: Any) -> Box:
        return joined(self._power(base, exponent, 0))

    def _power(self, base: Any, exponent: Any, depth: int, closed: bool = False) -> Pieces:
        if exponent is _HALF:
            inner = joined(self._expression(base, 0))
            if inner.width <= WIDEST_FRACTION:
                return [Piece(Box(f"\\sqrt{{{inner.tex.rstrip()}}}", inner.width + 10.0), depth=depth)]
        raised = EMPTY if exponent is _ONE else self._exponent(exponent)
        return self._raised(base, raised, depth, closed)

    def _exponent(self, exponent: Any) -> Box:
        if exponent.is_Rational:
            return Box(str(exponent), 5.0 * len(str(exponent)) + 3.0)
        return joined(self._expression(exponent, 0))

    def _raised(self, base: Any, exponent: Box, depth: int, closed: bool) -> Pieces:
        if base.is_Symbol:
            return [Piece(self.notation.glyph(base.name).power(exponent), depth=depth)]
        if base is pi:
            return [Piece(script(greek("pi"), sup=exponent), depth=depth)]
        if base.is_Integer and base >= 0:
            return [Piece(script(italic(str(base)), sup=exponent), depth=depth)]
        if base.is_Function:
            return self._function(base, exponent, depth, closed)
        if not (base.is_Add or base.is_Mul or base.is_Pow or base.is_Rational):
            raise TargetError(f"no LaTeX for {base}", allowed="exact numbers, pi, symbols and functions of the grammar")
        return self._bracket(self._expression(base, depth + 1), exponent, depth)

    def _bracket(self, inner: Pieces, exponent: Box, depth: int) -> Pieces:
        height = highest_nest(inner)
        left, right = brackets(height)
        opening = Piece(Box(left, 5.0), depth=depth, nest=height + 1)
        closing = Piece(script(Box(right, 5.0), sup=exponent), depth=depth, nest=height + 1)
        return [opening, *inner, closing]

    def _function(self, call: Any, exponent: Box, depth: int, closed: bool) -> Pieces:
        name = call.func.__name__
        if name in ("cos", "sin") and self.notation.abbreviates:
            variables = self._abbreviated(call.args[0])
            if variables:
                return [Piece(self.notation.abbreviation(name[0], variables, exponent), depth=depth)]
        if name not in _FUNCTIONS and name not in ("cos", "sin", "tan"):
            raise TargetError(f"no LaTeX for the function {name}", remedy="use sin, cos, tan, sqrt or atan2")
        head = script(operator(_FUNCTIONS.get(name, name)), sup=exponent)
        head = Box(head.tex + (" " if head.tex[-1].isalpha() else ""), head.width)
        argument = call.args[0]
        if len(call.args) == 1 and (argument.is_Symbol or argument.is_NumberSymbol) and not closed:
            return [Piece(concatenate(head, self._box(argument, Integer(1))), depth=depth)]
        row = [Piece(head, depth=depth), *self._bracket(self._arguments(call.args, depth + 1), EMPTY, depth)]
        return row if self.notation.abbreviates else self._unbroken(row, depth)

    def _unbroken(self, row: Pieces, depth: int) -> Pieces:
        """A short call in one piece."""
        box = joined(row)
        return [Piece(box, depth=depth, nest=highest_nest(row))] if box.width <= WIDEST_FRACTION else row

    def _arguments(self, arguments: tuple[Any, ...], depth: int) -> Pieces:
        row = self._expression(arguments[0], depth)
        for argument in arguments[1:]:
            row += [Piece(Box(",\\, ", 5.0), depth=depth), *self._expression(argument, depth)]
        return row

    def _abbreviated(self, angle: Any) -> tuple[str, ...]:
        """The joint variables of a plain sum, in the order of the joints; empty for any other angle."""
        order = self.notation.label_order
        terms = angle.args if angle.is_Add else (angle,)
        if not all(term.is_Symbol and term.name in order for term in terms):
            return ()
        return tuple(sorted((term.name for term in terms), key=order.__getitem__))


def _is_constant(base: Any) -> bool:
    """Whether it is a plain number, pi, or what a root is taken of."""
    return bool(base.is_Number or base.is_NumberSymbol)


def _is_circular(base: Any) -> bool:
    return bool(base.is_Function) and base.func.__name__ in ("cos", "sin", "tan")


def _is_negative(term: Any) -> bool:
    return bool(term.as_coeff_Mul()[0] < 0)


def _opposite(bracket: Any) -> Any:
    """A sum with every sign turned."""
    return Add(*(-term for term in bracket.args))


def _is_below(exponent: Any) -> bool:
    """Whether a power belongs into a denominator."""
    return bool(exponent.is_Rational and exponent < 0)

"""SymPy expressions in the notation of lecture notes, as pieces that the layout can break."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from sympy import Add, Integer, S, pi

from derive.errors import TargetError
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.numbers import magnitude
from derive.handouts.notation.order import Order, is_below
from derive.handouts.notation.pieces import (
    BRACKET_WIDTH,
    EMPTY,
    MINUS_WIDTH,
    Box,
    Break,
    Piece,
    binary,
    concatenate,
    fraction,
    greek,
    italic,
    joined,
    operator,
    script,
)

WIDEST_FRACTION = 120.0
"""Widest numerator or denominator [pt]; a wider quotient is written with negative powers, which can be broken."""

MINUS = Piece(Box("-", MINUS_WIDTH))

_HALF, _ONE = S.Half, S.One
_CIRCULAR = ("cos", "sin", "tan")
_FUNCTIONS = {"sign": "sgn", "atan2": "atan2", "Abs": "abs", "acos": "arccos", "asin": "arcsin", "atan": "arctan"}
_BRACKETS = (("(", ")"), ("[", "]"), ("\\{", "\\}"))
"""By the levels of brackets inside; deeper ones begin again."""

Pieces = list[Piece]
Power = tuple[Any, Any]
"""Base and exponent."""


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
        """One line of LaTeX, for mathematics mode.

        Args:
            expression: A SymPy expression in the robot's symbols.

        Raises:
            TargetError: It holds something that the grammar of robot files has no word for.
        """
        return joined(self.pieces(expression)).tex

    def pieces(self, expression: Any) -> Pieces:
        """The expression as pieces, from left to right.

        Args:
            expression: A SymPy expression in the robot's symbols.

        Raises:
            TargetError: It holds something that the grammar of robot files has no word for.
        """
        return self._sum(expression, 0)

    def _sum(self, expression: Any, depth: int) -> Pieces:
        """Written once: a root inside a root is measured before it is placed, which doubles the work at each level."""
        key = (expression, depth)
        if key not in self._written:
            terms = expression.args if expression.is_Add else (expression,)
            row: Pieces = []
            for term in sorted(terms, key=self._order.term):
                negative, pieces = self._term(term, depth)
                if row:
                    row.append(binary("-" if negative else "+", depth))
                elif negative:
                    row.append(MINUS)
                row += pieces
            self._written[key] = tuple(row)
        return list(self._written[key])

    def _term(self, term: Any, depth: int) -> tuple[bool, Pieces]:
        """Whether the term is negative, and its absolute value."""
        coefficient, rest = term.as_coeff_Mul()
        if not coefficient.is_Rational:
            coefficient, rest = type(coefficient)(1), term
        factors = rest.args if rest.is_Mul else () if rest is _ONE else (rest,)
        powers = [factor.as_base_exp() for factor in sorted(factors, key=self._order.factor)]
        value = Fraction(int(coefficient.p), int(coefficient.q))
        for index, (base, exponent) in enumerate(powers):
            if exponent is _ONE and base.is_Add and all(part.as_coeff_Mul()[0] < 0 for part in base.args):
                powers[index] = (Add(*(-part for part in base.args)), exponent)
                value = -value
        leading, powers = self._leading(abs(value), powers)
        row = [Piece(leading, depth=depth)] if leading.tex else []
        for pieces in self._factors(powers, depth):
            if row:
                pieces[0] = pieces[0]._replace(before=Break.FACTOR, depth=depth)
            row += pieces
        return value < 0, row or [Piece(italic("1"), depth=depth)]

    def _factors(self, powers: list[Power], depth: int) -> Iterator[Pieces]:
        r"""Each power; where functions are written in full and a factor follows, the argument ends with a bracket.

        ``\cos \theta_{1}\dot{\theta}_{1}`` could be the cosine of the product.
        """
        for (base, exponent), following in zip(powers, (*powers[1:], None), strict=False):
            alone = following is None or (following[0].is_Function and following[0].func.__name__ in _CIRCULAR)
            yield self._power(base, exponent, depth, closed=not alone and not self.notation.abbreviates)

    def _leading(self, value: Fraction, powers: list[Power]) -> tuple[Box, list[Power]]:
        """The number, the quotient of parameters or both in front of a product, and the powers that remain.

        Numbers and parameters stand over each other if there is a denominator and both sides are short.
        """
        below = [(base, -exponent) for base, exponent in powers if is_below(exponent)]
        constants = [power for power in powers if _is_constant(power[0]) and not is_below(power[1])]
        number = EMPTY if value == 1 and powers else self._magnitude(value)
        if not below and not constants:
            return number, powers
        angle = any(base.is_NumberSymbol for base, _ in powers)  # multiples of pi are never decimals
        as_decimal = not angle and "frac" not in self._magnitude(value).tex
        if below or not (value.denominator == 1 or as_decimal):
            above = [power for power in powers if not is_below(power[1]) and self._may_stand_above(power[0], below)]
            numerator, denominator = self._side(value.numerator, above), self._side(value.denominator, below)
            if max(numerator.width, denominator.width) <= WIDEST_FRACTION:
                rest = [power for power in powers if power not in above and not is_below(power[1])]
                return fraction(numerator, denominator, small=not below), rest
        boxes = (joined(self._power(base, exponent, 0)) for base, exponent in constants)
        return concatenate(number, *boxes), [power for power in powers if power not in constants]

    def _may_stand_above(self, base: Any, below: list[Power]) -> bool:
        """Numbers always, parameters where there is something to stand over."""
        position = self.notation.positions.get(base.name) if base.is_Symbol else None
        return _is_constant(base) or (bool(below) and position is not None and position[0] == 0)

    def _side(self, number: int, powers: list[Power]) -> Box:
        """The numerator or denominator of a quotient."""
        if len(powers) == 1 and number == 1 and powers[0][1] == 1:
            return joined(self._sum(powers[0][0], 0))
        boxes = [] if number == 1 and powers else [self._magnitude(Fraction(number))]
        return concatenate(*boxes, *map(joined, self._factors(powers, 0)))

    def _magnitude(self, value: Fraction) -> Box:
        return magnitude(value, self.notation.decimals, digits=self.notation.digits)

    def _power(self, base: Any, exponent: Any, depth: int, closed: bool = False) -> Pieces:
        if exponent is _HALF:
            inner = joined(self._sum(base, 0))
            if inner.width <= WIDEST_FRACTION:
                return [Piece(Box(f"\\sqrt{{{inner.tex.rstrip()}}}", inner.width + 10.0), depth=depth)]
        raised = EMPTY
        if exponent.is_Rational and exponent is not _ONE:
            raised = Box(str(exponent), 5.0 * len(str(exponent)) + 3.0)
        elif exponent is not _ONE:
            raised = joined(self._sum(exponent, 0))
        if base.is_Symbol:
            return [Piece(self.notation.glyph(base.name).power(raised), depth=depth)]
        if base is pi:
            return [Piece(script(greek("pi"), sup=raised), depth=depth)]
        if base.is_Integer and base >= 0:
            return [Piece(script(italic(str(base)), sup=raised), depth=depth)]
        if base.is_Function:
            return self._function(base, raised, depth, closed)
        if not (base.is_Add or base.is_Mul or base.is_Pow or base.is_Rational):
            raise TargetError(f"no LaTeX for {base}", allowed="exact numbers, pi, symbols and functions of the grammar")
        return _bracket(self._sum(base, depth + 1), raised, depth)

    def _function(self, call: Any, exponent: Box, depth: int, closed: bool) -> Pieces:
        """A function; ``closed`` asks for a bracket around its argument."""
        name, argument = call.func.__name__, call.args[0]
        if name in ("cos", "sin") and self.notation.abbreviates:
            variables = self._abbreviated(argument)
            if variables:
                return [Piece(self.notation.abbreviation(name[0], variables, exponent), depth=depth)]
        if name not in _FUNCTIONS and name not in _CIRCULAR:
            raise TargetError(f"no LaTeX for the function {name}", remedy="use sin, cos, tan, sqrt or atan2")
        head = script(operator(_FUNCTIONS.get(name, name)), sup=exponent)
        head = Box(head.tex + (" " if head.tex[-1].isalpha() else ""), head.width)
        if len(call.args) == 1 and (argument.is_Symbol or argument.is_NumberSymbol) and not closed:
            return [Piece(concatenate(head, joined(self._power(argument, Integer(1), 0))), depth=depth)]
        inner = self._sum(argument, depth + 1)
        for other in call.args[1:]:
            inner += [Piece(Box(",\\, ", 5.0), depth=depth + 1), *self._sum(other, depth + 1)]
        row = [Piece(head, depth=depth), *_bracket(inner, EMPTY, depth)]
        box = joined(row)
        if self.notation.abbreviates or box.width > WIDEST_FRACTION:
            return row
        return [Piece(box, depth=depth, nest=_nested(row))]

    def _abbreviated(self, angle: Any) -> tuple[str, ...]:
        """The joint variables of a plain sum, in the order of the joints; empty for any other angle."""
        order = self.notation.label_order
        terms = angle.args if angle.is_Add else (angle,)
        if not all(term.is_Symbol and term.name in order for term in terms):
            return ()
        return tuple(sorted((term.name for term in terms), key=order.__getitem__))


def _bracket(inner: Pieces, exponent: Box, depth: int) -> Pieces:
    height = _nested(inner)
    left, right = _BRACKETS[height % len(_BRACKETS)]
    opening = Piece(Box(left, BRACKET_WIDTH), depth=depth, nest=height + 1)
    closing = Piece(script(Box(right, BRACKET_WIDTH), sup=exponent), depth=depth, nest=height + 1)
    return [opening, *inner, closing]


def _nested(pieces: Pieces) -> int:
    """Levels of brackets in the pieces."""
    return max((piece.nest for piece in pieces), default=0)


def _is_constant(base: Any) -> bool:
    """Whether it is a plain number, pi, or what a root is taken of."""
    return bool(base.is_Number or base.is_NumberSymbol)

"""SymPy expressions and cells of the robot file in the notation of lecture notes, as pieces of lines or plain text."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import chain
from typing import Any

import sympy
from sympy import Add, Basic, Integer, S, pi
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.str import StrPrinter

from derive.errors import TargetError
from derive.handouts.notation import pieces as typeset
from derive.handouts.notation.notation import Notation, Order, is_below
from derive.handouts.notation.pieces import EMPTY, MINUS, Box, Break, TexPiece, concatenate, joined, magnitude, script
from derive.lecture.shorthand import clear_labels
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.robot.description import Joint, Variable
from derive.robot.expression import Expression
from derive.robot.robot import Robot
from derive.robot.rounding import number_text, shown
from derive.robot.units import Unit, in_file_units, symbol_unit

WIDEST_FRACTION = 120.0  # of a numerator or denominator [pt]; a wider quotient has negative powers, which can be broken
_HALF, _ONE = S.Half, S.One
_CIRCULAR = ("cos", "sin", "tan")
_FUNCTIONS = {"sign": "sgn", "atan2": "atan2", "acos": "arccos", "asin": "arcsin", "atan": "arctan"}
_BRACKETS = (("(", ")"), ("[", "]"), ("\\{", "\\}"))  # by the levels of brackets inside; deeper ones begin again
Pieces = list[TexPiece]
Power = tuple[Any, Any]  # base and exponent


class LatexPrinter:
    """Prints the expressions of one robot."""

    def __init__(self, notation: Notation) -> None:
        self.notation = notation
        self._order = Order(notation)
        self._written: dict[tuple[Any, int], tuple[TexPiece, ...]] = {}

    def latex(self, expression: Any) -> str:
        """One line of LaTeX, for mathematics mode."""
        return joined(self.pieces(expression)).tex

    def pieces(self, expression: Any) -> Pieces:
        """The expression as pieces, from left to right."""
        terms = expression.args if expression.is_Add else ()
        is_angle = any(term.is_Symbol and term.name in self.notation.labels for term in terms)
        return self.angle(expression) if is_angle else self._sum(expression, 0)

    def angle(self, expression: Any, depth: int = 0) -> Pieces:
        """An angle as pieces; an added multiple of pi is in degrees where the robot file is."""
        # angle = turn pi + rest; the rational multiple of pi in degrees: 180 turn
        turn = expression.coeff(pi)
        rest = expression - turn * pi
        if not (self.notation.degrees and turn.is_Rational and turn) or rest.has(pi):
            return self._sum(expression, depth)
        size = Fraction(180 * abs(turn).p, turn.q)
        number = magnitude(size, decimals=True, digits=self.notation.digits, comma=self.notation.comma)
        degrees = TexPiece(Box(f"{number.tex}{_CIRCLE}", number.width + 5.0), depth=depth)
        if rest == 0:
            return [degrees] if turn > 0 else [MINUS, degrees]
        return [*self._sum(rest, depth), typeset.binary("+" if turn > 0 else "-", depth), degrees]

    def _sum(self, expression: Any, depth: int) -> Pieces:
        """Written once: a root inside a root is measured before it is placed, which doubles the work at each level."""
        if (key := (expression, depth)) not in self._written:
            terms = sorted(expression.args if expression.is_Add else (expression,), key=self._order.term)
            self._written[key] = tuple(typeset.signed_sum((self._term(term, depth) for term in terms), depth))
        return list(self._written[key])

    def _term(self, term: Any, depth: int) -> tuple[bool, Pieces]:
        """Whether the term is negative, and its absolute value."""
        coefficient, rest = term.as_coeff_Mul()
        if not coefficient.is_Rational:
            coefficient, rest = type(coefficient)(1), term
        factors = rest.args if rest.is_Mul else () if rest is _ONE else (rest,)
        powers = [factor.as_base_exp() for factor in sorted(factors, key=self._order.factor)]
        value = Fraction(int(coefficient.p), int(coefficient.q))
        # -(-a - b) is written a + b: a factor whose terms are all negative gives its sign to the number
        for index, (base, exponent) in enumerate(powers):
            if exponent is _ONE and base.is_Add and all(part.as_coeff_Mul()[0] < 0 for part in base.args):
                powers[index] = (Add(*(-part for part in base.args)), exponent)
                value = -value
        leading, powers = self._leading(abs(value), powers)
        row = [TexPiece(leading, depth=depth)] if leading.tex else []
        for pieces in self._factors(powers, depth):
            if row:
                pieces[0] = pieces[0]._replace(before=Break.FACTOR, depth=depth)
            row += pieces
        return value < 0, row or [TexPiece(typeset.italic("1"), depth=depth)]

    def _factors(self, powers: list[Power], depth: int) -> Iterator[Pieces]:
        """Each power; where functions are written in full and a factor follows, the argument ends with a bracket."""
        # \cos \theta_{1}\dot{\theta}_{1} could be the cosine of the product.
        for (base, exponent), following in zip(powers, (*powers[1:], None), strict=False):
            alone = following is None or (following[0].is_Function and following[0].func.__name__ in _CIRCULAR)
            yield self._power(base, exponent, depth, closed=not alone and not self.notation.abbreviates)

    def _leading(self, value: Fraction, powers: list[Power]) -> tuple[Box, list[Power]]:
        """The number, the quotient of parameters or both in front of a product, and the powers that remain."""
        # Numbers and parameters stand over each other if there is a denominator and both sides are short.
        # below: what divides; constants: roots and pi, which stand with the number
        below = [(base, -exponent) for base, exponent in powers if is_below(exponent)]
        constants = [p for p in powers if (p[0].is_Number or p[0].is_NumberSymbol) and not is_below(p[1])]
        number = EMPTY if value == 1 and powers else self._magnitude(value)
        if not below and not constants:
            return number, powers
        angle = any(base.is_NumberSymbol for base, _ in powers)  # multiples of pi are never decimals
        as_decimal = not angle and "frac" not in self._magnitude(value).tex
        if below or not (value.denominator == 1 or as_decimal):
            positions = self.notation.positions.items() if below else ()  # something for parameters to stand over
            names = {name for name, (rank, _) in positions if rank == 0}
            parameters = [p for p in powers if p[0].is_Symbol and p[0].name in names and not is_below(p[1])]
            above = [p for p in powers if p in constants or p in parameters]
            numerator, denominator = self._side(value.numerator, above), self._side(value.denominator, below)
            # One fraction, of which sines, rates and brackets stay behind; a wide one is written with negative powers.
            if max(numerator.width, denominator.width) <= WIDEST_FRACTION:
                rest = [power for power in powers if power not in above and not is_below(power[1])]
                return typeset.fraction(numerator, denominator, small=not below), rest
        boxes = (joined(self._power(base, exponent, 0)) for base, exponent in constants)
        return concatenate(number, *boxes), [power for power in powers if power not in constants]

    def _side(self, number: int, powers: list[Power]) -> Box:
        if len(powers) == 1 and number == 1 and powers[0][1] == 1:
            return joined(self._sum(powers[0][0], 0))
        boxes = [] if number == 1 and powers else [self._magnitude(Fraction(number))]
        return concatenate(*boxes, *map(joined, self._factors(powers, 0)))

    def _magnitude(self, value: Fraction) -> Box:
        return magnitude(value, self.notation.decimals, digits=self.notation.digits, comma=self.notation.comma)

    def _power(self, base: Any, exponent: Any, depth: int, closed: bool = False) -> Pieces:
        # no line breaks under a root: a wide one is a bracket to the power 1/2
        if exponent is _HALF and (inner := joined(self._sum(base, 0))).width <= WIDEST_FRACTION:
            return [TexPiece(Box(f"\\sqrt{{{inner.tex.rstrip()}}}", inner.width + 10.0), depth=depth)]
        raised = EMPTY
        if exponent.is_Rational and exponent is not _ONE:
            raised = Box(str(exponent), 5.0 * len(str(exponent)) + 3.0)
        elif exponent is not _ONE:
            raised = joined(self._sum(exponent, 0))
        if base.is_Symbol:
            return [TexPiece(self.notation.glyph(base.name).power(raised), depth=depth)]
        if base is pi:
            return [TexPiece(script(typeset.greek("pi"), sup=raised), depth=depth)]
        if base.is_Integer and base >= 0:
            return [TexPiece(script(typeset.italic(str(base)), sup=raised), depth=depth)]
        if base.is_Function:
            return self._function(base, raised, depth, closed)
        if not (base.is_Add or base.is_Mul or base.is_Pow or base.is_Rational):
            allowed = "allowed: exact numbers, pi, symbols and functions of the grammar"
            raise TargetError(f"no LaTeX for {base}", allowed=allowed)
        return _bracket(self._sum(base, depth + 1), raised, depth)

    def _function(self, call: Any, exponent: Box, depth: int, closed: bool) -> Pieces:
        """A function; ``closed`` asks for a bracket around its argument."""
        name, argument = call.func.__name__, call.args[0]
        if name in ("cos", "sin") and self.notation.abbreviates:
            labels, terms = list(self.notation.labels), argument.args if argument.is_Add else (argument,)
            if all(term.is_Symbol and term.name in labels for term in terms):  # a plain sum of joint angles
                variables = tuple(sorted((term.name for term in terms), key=labels.index))
                return [TexPiece(self.notation.abbreviation(name[0], variables, exponent), depth=depth)]
        if name == "Abs" and not exponent.tex:
            return [TexPiece(Box("\\lvert ", 5.0)), *self._sum(argument, depth + 1), TexPiece(Box(" \\rvert", 5.0))]
        if name not in _FUNCTIONS and name not in _CIRCULAR:
            raise TargetError(f"no LaTeX for the function {name}", remedy="use sin, cos, tan, sqrt or atan2")
        head = script(typeset.operator(_FUNCTIONS.get(name, name)), sup=exponent)
        head = Box(head.tex + (" " if head.tex[-1].isalpha() else ""), head.width)
        if len(call.args) == 1 and (argument.is_Symbol or argument.is_NumberSymbol) and not closed:
            return [TexPiece(concatenate(head, joined(self._power(argument, Integer(1), 0))), depth=depth)]
        write = self.angle if name in _CIRCULAR else self._sum
        inner, others = write(argument, depth + 1), [self._sum(other, depth + 1) for other in call.args[1:]]
        separator = typeset.list_separator(chain(inner, *others))
        for other in others:
            inner += [TexPiece(separator, depth=depth + 1), *other]
        row = [TexPiece(head, depth=depth), *_bracket(inner, EMPTY, depth)]
        box = joined(row)
        # Written in full, a function and its argument stay on one line where they are short.
        if self.notation.abbreviates or box.width > WIDEST_FRACTION:
            return row
        return [TexPiece(box, depth=depth, nest=_nested(row))]


def _bracket(inner: Pieces, exponent: Box, depth: int) -> Pieces:
    height = _nested(inner)
    left, right = (Box(mark, typeset.BRACKET_WIDTH) for mark in _BRACKETS[height % len(_BRACKETS)])
    opening = TexPiece(left, depth=depth, nest=height + 1)
    return [opening, *inner, TexPiece(script(right, sup=exponent), depth=depth, nest=height + 1)]


def _nested(pieces: Pieces) -> int:
    """Levels of brackets in the pieces."""
    return max((piece.nest for piece in pieces), default=0)


# -- cells of the robot file

DATA_DIGITS = 15  # significant digits of the numbers in tables, which are the user's
_CIRCLE = "^{\\circ}"
METRE, RADIAN = Box("\\,\\mathrm{m}", 11.0), Box("\\,\\mathrm{rad}", 18.0)
Cell = tuple[TexPiece, ...]  # a cell in print


class DataPrinter:
    """Prints cells of the robot file."""

    def __init__(self, robot: Robot, notation: Notation) -> None:
        self.robot = robot
        self._metres = Box("\\,\\mathrm{mm}", 19.0) if robot.units.millimetres else METRE
        self.notation = replace(notation, decimals=True, digits=DATA_DIGITS, degrees=robot.units.degrees)

    def driven(self, joint: Joint) -> "DataPrinter":
        """The same for the cell of a coupled joint, in which what is added stands before what is subtracted."""
        added = [name for name, factor in joint.drive if not _sympy(factor).could_extract_minus_sign()]
        first = {name: (1, k - len(added)) for k, name in enumerate(added)}
        return DataPrinter(self.robot, replace(self.notation, positions={**self.notation.positions, **first}))

    def value(self, cell: Expression | Expr) -> Cell:
        """A length, mass or other number."""
        return tuple(LatexPrinter(self.notation).pieces(_sympy(cell)))

    def angle(self, cell: Expression | Expr) -> Cell:
        """An angle, its multiples of pi as the robot file has them: with pi, or in degrees."""
        return tuple(LatexPrinter(self.notation).angle(_sympy(cell)))

    def length(self, cell: Expression) -> Cell:
        """A length, its numbers in the units of the robot file."""
        return self.value(in_file_units(cell, Unit.LENGTH, self.robot.units))

    def symbol(self, name: str, number: Expression) -> Cell:
        """The number of a symbol as the robot file has it, with its unit where that is not the SI unit."""
        if (unit := symbol_unit(self.robot, name) if self.robot.units.parameters else Unit.SI) is Unit.LENGTH:
            return (*self.length(number), TexPiece(self._metres))
        return self.angle(number) if unit is Unit.ANGLE else self.value(number)

    def position(self, joint: Joint | Variable, cell: Expression) -> Cell:
        """A value of a joint variable with its unit."""
        pieces, unit = self._position(joint, cell)
        if unit.tex and any(piece.before is Break.BINARY and not piece.depth for piece in pieces):
            pieces = tuple(_bracket(list(pieces), EMPTY, 0))  # the unit is that of all terms
        return (*pieces, TexPiece(unit)) if unit.tex else pieces

    def limits(self, joint: Joint | Variable) -> Cell:
        """Both limits of a joint with their unit."""
        if joint.limits is None:
            return (TexPiece(Box("\\text{--}", 6.0)),)
        # [lower, upper] unit: one unit for both, none where a limit is in degrees
        (lower, _), (upper, unit) = (self._position(joint, limit) for limit in joint.limits)
        opening, closing = (TexPiece(Box(bracket, typeset.BRACKET_WIDTH)) for bracket in "[]")
        end = [TexPiece(unit)] if unit.tex and _CIRCLE not in joined(lower).tex else []
        return (opening, *lower, TexPiece(typeset.list_separator((*lower, *upper))), *upper, closing, *end)

    def _position(self, joint: Joint | Variable, cell: Expression) -> tuple[Cell, Box]:
        """A value, and the unit behind it; degrees have their circle instead."""
        if not joint.is_revolute:
            return self.length(cell), self._metres
        if (value := _sympy(cell)) == 0 and self.notation.degrees:
            return (TexPiece(Box(f"0{_CIRCLE}", 10.0)),), EMPTY
        pieces = self.angle(value)
        return pieces, EMPTY if _CIRCLE in joined(pieces).tex else RADIAN


def _sympy(cell: Expression | Expr) -> Expr:
    return cell if isinstance(cell, sympy.Basic) else expression_to_sympy(cell)


# -- one line of plain text, in the shorthand and the order of lecture notes: ``a1*c1 + a2*c12``
#
# ``c12`` is cos(q1 + q2), labels being the digits of the joint variables' names. The shorthand is used for a robot only
# where it can be read one way: every label is a single digit, none occurs twice, and no symbol of the user looks like a
# token. Otherwise cosines and sines are spelled out.


class PlainPrinter(StrPrinter):  # type: ignore[misc]
    """SymPy's own text, with every subexpression printed once: those of long chains recur thousands of times."""

    def __init__(self) -> None:
        super().__init__()
        self._printed: dict[Any, str] = {}

    def _print(self, expression: Any, **options: Any) -> str:
        if options or not isinstance(expression, Basic):
            return str(super()._print(expression, **options))
        if (found := self._printed.get(expression)) is None:
            found = self._printed[expression] = str(super()._print(expression))
        return found

    def _print_Abs(self, expression: Any) -> str:
        return f"abs({self._print(expression.args[0])})"


class TextPrinter(PlainPrinter):
    """Prints the expressions of one robot."""

    def __init__(self, robot: Robot, rounded: Notation | None = None) -> None:
        super().__init__()
        self._labels = clear_labels(robot)
        self._order = Order(rounded or Notation.of(robot))
        self._rounded = rounded

    def _print_Rational(self, value: Any) -> str:
        number = Fraction(int(value.p), int(value.q))
        shape = self._rounded
        return number_text(number, decimals=shape.decimals, digits=shape.digits) if shape else str(number)

    _print_Integer = _print_Rational

    def _print_Add(self, expression: Any, order: Any = None) -> str:
        terms = [str(self._print(term)) for term in sorted(expression.args, key=self._order.term)]
        return terms[0] + "".join(f" - {term[1:]}" if term.startswith("-") else f" + {term}" for term in terms[1:])

    def _print_Mul(self, expression: Any) -> str:
        coefficient, rest = expression.as_coeff_Mul()
        if not coefficient.is_Rational:
            return str(super()._print_Mul(expression))
        above: list[str] = []
        below: list[str] = []
        factors = rest.args if rest.is_Mul else (rest,)
        for factor in sorted(factors, key=self._order.factor):
            divides = is_below(factor.as_base_exp()[1])
            text = str(self.parenthesize(1 / factor if divides else factor, PRECEDENCE["Mul"]))
            (below if divides else above).append(text)
        size = abs(coefficient)
        numerator, _, denominator = (str(size) if pi in factors else self._print_Rational(size)).partition("/")
        if numerator != "1" or not above:
            above.insert(0, numerator)
        if denominator:
            below.insert(0, denominator)
        return ("-" if coefficient < 0 else "") + "*".join(above) + "".join(f"/{factor}" for factor in below)

    def _print_cos(self, expression: Any) -> str:
        function, angle = expression.func.__name__, expression.args[0]
        labels = [self._labels.get(str(term), "") for term in (angle.args if angle.is_Add else (angle,))]
        return str(function[0] + "".join(sorted(labels))) if all(labels) else f"{function}({self._print(angle)})"

    _print_sin = _print_cos


def loses_digits(expressions: Iterable[Any], *, decimals: bool, digits: int) -> bool:
    """Whether a number is not what is printed of it."""
    stack, seen = list(expressions), set()
    while stack:
        if (expression := stack.pop()) in seen:
            continue
        seen.add(expression)
        if expression.is_Rational:
            number = Fraction(int(expression.p), int(expression.q))
            if shown(number, decimals=decimals, digits=digits) != number:
                return True
        stack.extend(expression.args)
    return False

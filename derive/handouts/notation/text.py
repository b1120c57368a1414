"""SymPy expressions as one line of plain text, in the shorthand and the order of lecture notes: ``a1*c1 + a2*c12``.

``c12`` is cos(q1 + q2), labels being the digits of the joint variables' names. The shorthand is used for a robot only
where it can be read one way: every label is a single digit, none occurs twice, and no symbol of the user looks like a
token. Otherwise cosines and sines are spelled out.
"""

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from sympy import Basic, pi
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.str import StrPrinter

from derive.handouts.notation.notation import Notation, Order, is_below
from derive.lecture.shorthand import clear_labels
from derive.robot.robot import Robot
from derive.robot.rounding import number_text, shown


class PlainPrinter(StrPrinter):  # type: ignore[misc]
    """SymPy's own text, with every subexpression printed once: those of long chains recur thousands of times."""

    def __init__(self) -> None:
        super().__init__()
        self._printed: dict[Any, str] = {}

    def _print(self, expression: Any, **options: Any) -> str:
        if options or not isinstance(expression, Basic):
            return str(super()._print(expression, **options))
        found = self._printed.get(expression)
        if found is None:
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
        rest = (f" - {term[1:]}" if term.startswith("-") else f" + {term}" for term in terms[1:])
        return terms[0] + "".join(rest)

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
        terms = angle.args if angle.is_Add else (angle,)
        labels = [self._labels.get(str(term), "") for term in terms]
        return str(function[0] + "".join(sorted(labels))) if all(labels) else f"{function}({self._print(angle)})"

    _print_sin = _print_cos


def loses_digits(expressions: Iterable[Any], *, decimals: bool, digits: int) -> bool:
    """Whether a number is not what is printed of it."""
    stack, seen = list(expressions), set()
    while stack:
        expression = stack.pop()
        if expression in seen:
            continue
        seen.add(expression)
        if expression.is_Rational:
            number = Fraction(int(expression.p), int(expression.q))
            if shown(number, decimals=decimals, digits=digits) != number:
                return True
        stack.extend(expression.args)
    return False

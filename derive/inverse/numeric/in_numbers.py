"""An arm and its solutions in numbers: with fifty digits to prove, as arrays of floats to look at."""

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import Any

import mpmath
import numpy as np
import sympy

from derive.inverse.words.elementary import PrintedLine
from derive.lecture.point import value_of
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.mechanics.floats import FloatDomain
from derive.robot.expression import Expression
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

Numbers = dict[Expr, Any]  # numbers by symbol
_FUNCTIONS: Mapping[Any, Callable[..., Any]] = {sympy.sin: np.sin, sympy.cos: np.cos, sympy.atan2: np.arctan2}


def parameter_numbers(robot: Robot, rng: random.Random) -> Numbers:
    """Numbers of all parameters: those of the robot file, random ones for the others, with the precision of mpmath."""
    known: Numbers = {}
    for name, expression in robot.parameters:
        known[sympy.Symbol(name)] = value_of(expression_to_sympy(expression), dict(known))
    for name in robot_symbols(robot):
        known.setdefault(sympy.Symbol(name), mpmath.mpf(rng.randint(20, 90)) / 97)
    return known


def array_value(e: Expr, known: Numbers) -> Any:
    """An expression as an array of floats; not a number where it has no real value."""
    if e in known:
        return known[e]
    arguments = [array_value(argument, known) for argument in e.args]
    if e.is_Number or e.is_NumberSymbol:
        found = np.float64(e)
    elif e.is_Add:
        found = sum(arguments[1:], arguments[0])
    elif e.is_Mul:
        found = prod(arguments[1:], start=arguments[0])
    elif e.is_Pow:
        found = np.sqrt(arguments[0]) if e.args[1] == sympy.S.Half else arguments[0] ** arguments[1]
    else:
        found = _FUNCTIONS[e.func](*arguments)
    known[e] = found
    return found


def with_lines(values: Numbers, lines: Iterable[PrintedLine]) -> Numbers:
    """Arrays of what is known and of lines that follow, each a symbol and its value; NaN where one has no value."""
    known = dict(values)
    with np.errstate(all="ignore"):
        for line in lines:
            known[line.symbol] = array_value(line.value, known)
    return known


class DigitsDomain(FloatDomain):
    """Cells of a robot and joint positions as numbers of mpmath, with its working precision."""

    functions = (mpmath.cos, mpmath.sin, mpmath.mpf)

    def __init__(self, robot: Robot, q: Sequence[Any], values: Numbers) -> None:
        super().__init__(robot, q, {})
        self._known = dict(values)

    def number(self, value: int | Fraction) -> Any:
        """A rational."""
        return self.functions[2](value.numerator) / value.denominator

    def constant(self, expression: Expression) -> Any:
        """The value of a cell."""
        return self.functions[2](value_of(expression_to_sympy(expression), self._known))

    def cosine_sine(self, angle: Expression) -> Any:
        """Cosine and sine of a constant angle."""
        value, number = expression_to_sympy(angle), self.functions[2]
        return tuple(number(value_of(function(value), self._known)) for function in (sympy.cos, sympy.sin))


class ArrayDomain(DigitsDomain):
    """The same at many configurations, as arrays of floats."""

    functions = (np.cos, np.sin, float)

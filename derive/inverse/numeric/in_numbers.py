"""An arm and its solutions in numbers: with fifty digits to prove, as arrays of floats to look at."""

import random
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import sympy

from derive.lecture.point import value_of
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.mechanics.floats import FloatDomain
from derive.robot.description import Joint
from derive.robot.expression import Expression
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

Numbers = dict[Expr, Any]  # numbers by symbol


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
        found = arguments[0]
        for argument in arguments[1:]:
            found = found * argument
    elif e.is_Pow:
        found = np.sqrt(arguments[0]) if e.args[1] == sympy.S.Half else arguments[0] ** arguments[1]
    else:
        found = _FUNCTIONS[e.func](*arguments)
    known[e] = found
    return found


_FUNCTIONS: Mapping[Any, Callable[..., Any]] = {sympy.sin: np.sin, sympy.cos: np.cos, sympy.atan2: np.arctan2}


class DigitsDomain(FloatDomain):
    """Cells of a robot and joint positions as numbers of mpmath, with its working precision."""

    functions: tuple[Any, Any] = (mpmath.cos, mpmath.sin)

    def __init__(self, robot: Robot, q: Sequence[Any], values: Numbers) -> None:
        super().__init__(robot, q, {})
        self._known = dict(values)

    def number(self, value: int | Fraction) -> Any:
        """A rational."""
        return mpmath.mpf(value.numerator) / value.denominator

    def constant(self, expression: Expression) -> Any:
        """The value of a cell."""
        return value_of(expression_to_sympy(expression), self._known)

    def cosine_sine(self, angle: Expression) -> Any:
        """Cosine and sine of a constant angle."""
        value = expression_to_sympy(angle)
        return value_of(sympy.cos(value), self._known), value_of(sympy.sin(value), self._known)

    def joint_cosine_sine(self, index: int, joint: Joint) -> Any:
        """Cosine and sine of the angle of a revolute joint."""
        cosine, sine = self.functions
        value = joint.sign * self.q[index] + self.constant(joint.theta)
        return cosine(value), sine(value)


class ArrayDomain(DigitsDomain):
    """The same at many configurations, as arrays of floats."""

    functions = (np.cos, np.sin)

    def number(self, value: int | Fraction) -> Any:
        """A rational."""
        return float(value)

    def constant(self, expression: Expression) -> Any:
        """The value of a cell."""
        return float(super().constant(expression))

    def cosine_sine(self, angle: Expression) -> Any:
        """Cosine and sine of a constant angle."""
        return tuple(map(float, super().cosine_sine(angle)))

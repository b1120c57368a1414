"""What is known of a robot's symbols, for SymPy's own simplifications: all are real, and masses are positive.

Closed forms are derived in plain symbols; these functions put the others in and take them out again.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from inspect import ismethod
from typing import Any

import sympy

from derive.lecture.sympy_conversion import Expr
from derive.robot.evaluate import parameter_values
from derive.robot.expression import Name
from derive.robot.robot import Robot


def plain(value: Any) -> Any:
    """A SymPy expression in plain symbols; what is none as it is."""
    if not isinstance(value, sympy.Basic | sympy.MatrixBase):
        return value
    return value.xreplace({symbol: type(symbol)(symbol.name) for symbol in value.free_symbols})


class Assumptions:
    """Puts symbols with assumptions into whatever a model gives out.

    A mass is a symbol that is by itself the mass of a link or rotor, unless the file gives it the number zero.
    """

    def __init__(self, robot: Robot) -> None:
        cells = [cell for link in robot.links for cell in (link.mass, link.motor.mass if link.motor else None)]
        numbers = parameter_values(robot)
        self._masses = {cell.name for cell in cells if isinstance(cell, Name) and numbers.get(cell.name, 1) > 0}
        self._written: dict[Expr, Expr] = {}

    def __getstate__(self) -> dict[str, Any]:
        return {"_masses": self._masses, "_written": {}}

    def __call__(self, value: Any) -> Any:
        """The value with these symbols: an expression, a matrix, a collection of them, or what has or returns them."""
        if isinstance(value, sympy.MatrixBase):
            return value.applyfunc(self._expression)
        if isinstance(value, sympy.Basic):
            return self._expression(value)
        if isinstance(value, Mapping):
            return {self(key): self(entry) for key, entry in value.items()}
        if isinstance(value, list | tuple):
            return type(value)(map(self, value))
        if ismethod(value) or isinstance(value, partial):
            return lambda *arguments, **named: self(
                value(*map(plain, arguments), **{name: plain(argument) for name, argument in named.items()})
            )
        is_ours = type(value).__module__.startswith(("derive.model.", "derive.inverse.", "derive.notebook"))
        return View(value, self) if is_ours else value

    def _expression(self, e: Expr) -> Expr:
        if e not in self._written:
            if isinstance(e, sympy.Symbol):
                made = type(e)(e.name, **{"positive" if e.name in self._masses else "real": True})
            else:
                arguments = [self._expression(argument) for argument in e.args]
                made = e.func(*arguments) if arguments else e
                # brackets stay where a number is outside
                if (e.is_Add or e.is_Mul) and set(made.args) != set(arguments):
                    made = e.func(*arguments, evaluate=False)
            self._written[e] = made
        return self._written[e]


class View:
    """Something that a model gives out, such as its inverse kinematics, with the symbols of `Assumptions`."""

    def __init__(self, value: Any, assumed: Assumptions) -> None:
        self._value, self._assumed = value, assumed

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name in ("_value", "_assumed"):  # asked for before there is anything, by pickle
            raise AttributeError(name)
        return self._assumed(getattr(self._value, name))

    def __getitem__(self, place: Any) -> Any:
        return self._assumed(self._value[place])

    def __repr__(self) -> str:
        return repr(self._value)

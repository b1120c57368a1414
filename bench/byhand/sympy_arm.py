"""The recursions by hand through SymPy and `sympy.cse`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import sympy

from bench.byhand.axis_arm import axis_arm
from bench.byhand.base_parameters import named
from bench.byhand.quantities import by_symbol
from bench.byhand.symbols import Arithmetic
from bench.quantities import BY_SYMBOL
from bench.robots import Case


def number(value: float) -> Any:
    """Whole numbers exact, others as floats."""
    return sympy.Integer(int(value)) if value == int(value) else sympy.Float(value)


SYSTEM = Arithmetic(
    number=number,
    functions={"sin": sympy.sin, "cos": sympy.cos, "tan": sympy.tan, "sqrt": sympy.sqrt},
    symbol=sympy.Symbol,
    is_number=lambda value: bool(sympy.sympify(value).is_Number),
)


@dataclass(frozen=True)
class SymPyProgram:
    """A quantity as assignments.

    Attributes:
        inputs: Symbols of q, qd, qdd as far as they are taken, in lists.
        parameters: What each parameter symbol stands for, as a number.
        assignments: Symbols and their values, in order.
        results: The entries, row by row.
    """

    inputs: list[list[Any]]
    parameters: dict[Any, float]
    assignments: list[tuple[Any, Any]]
    results: list[Any]


def programs(case: Case, symbols: tuple[str, ...] = ("tau", "g")) -> Iterator[tuple[str, SymPyProgram]]:
    """Programs of some quantities; the others are left out for their time."""
    free = {name: sympy.Symbol(name) for name in case.numbers}
    fixed = {name: number(value) for name, value in case.values.items() if name not in free}
    known = {symbol: case.numbers[name] for name, symbol in free.items()}
    parameters = dict(known)

    def record(symbol: Any, value: Any) -> None:
        parameters[symbol] = float(value.evalf(subs=known))

    arm = named(axis_arm(case.robot, SYSTEM, {**fixed, **free}), SYSTEM, record)
    motion = [[sympy.Symbol(f"{kind}_{i + 1}") for i in range(case.robot.n)] for kind in ("q", "qd", "qdd")]
    makers = by_symbol(arm, SYSTEM, motion)
    for symbol in symbols:
        entries = [sympy.sympify(entry) for row in makers[symbol]() for entry in row]
        names = sympy.numbered_symbols("t")
        assignments, results = sympy.cse(entries, symbols=names, order="none")
        yield symbol, SymPyProgram(motion[: len(BY_SYMBOL[symbol].arguments)], parameters, assignments, results)

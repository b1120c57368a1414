"""What derive generates, as one more tool of the tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache

import numpy as np

from bench.counting.counts import Counts
from bench.peers.peer import Counted, Peer
from bench.quantities import QUANTITIES, Quantity
from bench.robots import Array, Case
from derive.algebra.constants import to_float
from derive.programs.build import build_program
from derive.programs.program import Function, Program
from derive.programs.tape.tape import PARAMETER, evaluate
from derive.robot.robot import Robot

ARITHMETIC = {"number": to_float, "sin": np.sin, "cos": np.cos, "sqrt": np.sqrt, "sign": np.sign}


@cache
def program_of(robot: Robot) -> Program:
    """The tapes of a robot."""
    return build_program(robot)


def tape_counts(function: Function) -> Counts:
    """Operations of the body of a tape; work on parameters alone is done once, beforehand."""
    operations = function.operations
    other = operations.total - operations.arithmetic - operations.sin - operations.cos
    return Counts(operations.mul, operations.add, operations.div, operations.sin + operations.cos, other)


def _count(case: Case) -> Iterator[tuple[str, Callable[[], Counted]]]:
    program = program_of(case.robot)
    numbers = [case.numbers[name] for name in program.parameters]
    for quantity in QUANTITIES:
        function = program[quantity.function]
        yield quantity.symbol, lambda quantity=quantity, function=function: _counted(quantity, function, numbers)  # type: ignore[misc]


def _counted(quantity: Quantity, function: Function, numbers: list[float]) -> Counted:
    def value(*motion: Array) -> Array:
        inputs = dict(zip(quantity.arguments, motion, strict=True))
        results = evaluate(function.tape, {**inputs, PARAMETER: numbers}, ARITHMETIC)
        return np.array(results, dtype=float).reshape(function.shape)

    return Counted(tape_counts(function), value)


OURS = Peer("derive", (), _count)

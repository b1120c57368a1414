"""Tools that yield CasADi functions: counted by opcode, and evaluated."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import casadi
import numpy as np

from bench.counting.casadi_graph import count_casadi, shared
from bench.peers.peer import Counted
from bench.quantities import BY_SYMBOL
from bench.robots import Array, Case

Programs = Iterator[tuple[str, Callable[[], tuple[Any, Any]]]]
"""By quantity: a function (q, ..., parameters) -> matrix, the last input there always, and the parameters' numbers."""


def counted(case: Case, programs: Programs) -> Iterator[tuple[str, Callable[[], Counted]]]:
    """The programs with their counts."""
    for symbol, program in programs:
        yield symbol, lambda symbol=symbol, program=program: _counted(case, symbol, *program())  # type: ignore[misc]


def _counted(case: Case, symbol: str, function: Any, numbers: Any) -> Counted:
    merged = shared(function)
    shape = BY_SYMBOL[symbol].shape(case.robot.n)

    def evaluate(*motion: Array) -> Array:
        return np.asarray(merged(*motion, numbers).full()).reshape(shape)

    return Counted(count_casadi(merged), evaluate)


def of_motion(name: str, joints: int, build: Callable[..., Any]) -> tuple[Any, Any]:
    """A function of q, qd, qdd and no parameters from an expression of them."""
    inputs = [casadi.SX.sym(argument, joints) for argument in BY_SYMBOL[name].arguments]
    return casadi.Function(name, [*inputs, casadi.SX(0, 1)], [build(*inputs)]), casadi.DM(0, 1)

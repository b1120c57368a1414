"""SymPy by hand: a textbook Newton-Euler recursion through `sympy.cse`, printed as Python."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator

import numpy as np
import sympy

from bench.byhand.sympy_arm import SymPyProgram, programs
from bench.counting.python_source import count_nodes
from bench.peers.peer import Counted, Peer
from bench.quantities import BY_SYMBOL
from bench.robots import Array, Case


def _count(case: Case) -> Iterator[tuple[str, Callable[[], Counted]]]:
    for symbol, program in programs(case):
        yield symbol, lambda symbol=symbol, program=program: _counted(case, symbol, program)  # type: ignore[misc]


def _counted(case: Case, symbol: str, program: SymPyProgram) -> Counted:
    lines = [f"{name} = {sympy.pycode(value)}" for name, value in program.assignments]
    lines.append(f"result = [{', '.join(sympy.pycode(value) for value in program.results)}]")
    inputs = [*program.inputs, list(program.parameters)]
    merged = sympy.lambdify(inputs, program.results, "math", cse=lambda _: (program.assignments, program.results))
    numbers, shape = list(program.parameters.values()), BY_SYMBOL[symbol].shape(case.robot.n)

    def evaluate(*motion: Array) -> Array:
        return np.array(merged(*motion, numbers), dtype=float).reshape(shape)

    return Counted(count_nodes(ast.parse("\n".join(lines))), evaluate)


PEER = Peer("SymPy by hand", ("sympy",), _count)

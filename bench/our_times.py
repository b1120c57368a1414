"""The rows of what derive generates: NumPy, native, C, CasADi, and its tape as plain NumPy lines."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bench.built import build, imported, module
from bench.compilers import BUILD, library
from bench.native import FOLDER
from bench.ours import program_of
from bench.peers import casadi_times
from bench.peers.casadi_programs import Programs
from bench.peers.passes import filled, one_by_one, whole_batch
from bench.peers.peer import Peer, Row, Timed
from bench.peers.pinocchio_cpp import pointer
from bench.plain_lines import columns, plain_lines
from bench.quantities import BY_SYMBOL, QUANTITIES, Quantity, arguments
from bench.robots import Array, Case

NUMPY, NATIVE = "derive: model_numpy", "derive: model_native"
OUT = ", out="
"""Into an array that is there already, as a loop in C does; a fresh one of some megabytes costs page faults."""

LINES = "derive: the tape as plain NumPy lines"
C_BATCH, C_LOOP = "derive: model.c, batch function", "derive: model.c, C loop"


def _time(case: Case, motions: Sequence[Array]) -> Iterator[Row]:
    for quantity in QUANTITIES:
        taken = arguments(quantity, tuple(motions))
        for label, target in ((NUMPY, "numpy"), (NATIVE, "native")):
            yield Row(label, quantity.symbol, False, partial(_one, case, quantity, taken, target))
            yield Row(label, quantity.symbol, True, partial(_batch, case, quantity, taken, target))
            yield Row(f"{label}{OUT}", quantity.symbol, True, partial(_into, case, quantity, taken, target))
        yield Row(LINES, quantity.symbol, True, partial(_plain, case, quantity, taken))
        yield Row(C_BATCH, quantity.symbol, True, partial(_c_batch, case, quantity, taken))
        yield Row(C_LOOP, quantity.symbol, True, partial(_c_loop, case, quantity, motions))
    yield from casadi_times.rows("derive: model_casadi", case, _casadi(case), motions)


def _function(case: Case, quantity: Quantity, target: str) -> Callable[..., Any]:
    function: Callable[..., Any] = getattr(module(case.name, target, f"model_{target}.py"), quantity.function)
    return function


def _one(case: Case, quantity: Quantity, taken: Sequence[Array], target: str) -> Timed:
    return one_by_one(_function(case, quantity, target), taken, quantity.shape(case.robot.n))


def _batch(case: Case, quantity: Quantity, taken: Sequence[Array], target: str) -> Timed:
    return whole_batch(_function(case, quantity, target), taken)


def _into(case: Case, quantity: Quantity, taken: Sequence[Array], target: str) -> Timed:
    function = _function(case, quantity, target)
    out = np.empty((len(taken[0]), *quantity.shape(case.robot.n)))
    return filled(lambda: function(*taken, out=out), out)


def _plain(case: Case, quantity: Quantity, taken: Sequence[Array]) -> Timed:
    BUILD.mkdir(exist_ok=True)
    path = BUILD / f"lines_{case.name}_{quantity.function}.py"
    path.write_text(plain_lines(program_of(case.robot)[quantity.function]), encoding="utf-8")
    lines, inputs = imported(path).lines, [columns(array) for array in taken]
    out = np.empty((len(taken[0]), *quantity.shape(case.robot.n)))
    return filled(lambda: lines(out, *inputs), out)


def prefix(folder: Path) -> str:
    """What the C functions' names begin with.

    Args:
        folder: That of the robot.
    """
    found = re.search(r"(\w*)dof = \d+", (folder / "model.h").read_text(encoding="utf-8"))
    if found is None:
        raise ValueError("no dof in model.h")
    return found[1]


def _c_batch(case: Case, quantity: Quantity, taken: Sequence[Array]) -> Timed:
    folder = build(case.name, "c")
    function = getattr(library(folder / "model.c", ("-lm",)), f"{prefix(folder)}{quantity.function}_batch")
    out = np.empty((len(taken[0]), *quantity.shape(case.robot.n)))
    addresses = [pointer(array) for array in (*taken, out)]
    return filled(lambda: function(ctypes.c_size_t(len(out)), *addresses), out)


def _c_loop(case: Case, quantity: Quantity, motions: Sequence[Array]) -> Timed:
    folder, n = build(case.name, "c"), case.robot.n
    out = np.empty((len(motions[0]), *quantity.shape(n)))
    places = ", ".join(f"{name} + {n} * k" for name in quantity.arguments)
    call = f"{prefix(folder)}{quantity.function}({places}, out + {out[0].size} * k)"
    flags = (f'-DMODEL="{folder / "model.c"}"', f"-I{folder}", f"-DCALL={call}", "-lm")
    loop = library(FOLDER / "model_loop.c", flags, [folder / "model.c"]).loop
    addresses = [pointer(array) for array in (*motions, out)]
    return filled(lambda: loop(ctypes.c_long(len(out)), *addresses), out)


def _casadi(case: Case) -> Programs:
    """The generated CasADi functions, with an empty input for parameters."""
    import casadi

    def made(quantity: Quantity) -> tuple[Any, Any]:
        function = _function(case, quantity, "casadi")
        inputs = [casadi.SX.sym(name, case.robot.n) for name in quantity.arguments]
        return casadi.Function("f", [*inputs, casadi.SX(0, 1)], [function(*inputs)]), casadi.DM(0, 1)

    for symbol, quantity in BY_SYMBOL.items():
        yield symbol, partial(made, quantity)


PEER = Peer("derive", (), time=_time)

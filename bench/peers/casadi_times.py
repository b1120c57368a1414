"""Times of CasADi functions: called plainly, mapped over a batch, and as generated C in a C loop."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import casadi
import numpy as np

from bench.compilers import library
from bench.counting.casadi_graph import shared
from bench.floor import widest
from bench.native import FOLDER
from bench.peers.casadi_lanes import lanes_loop
from bench.peers.casadi_programs import Programs
from bench.peers.passes import filled, one_by_one, whole_batch
from bench.peers.peer import Row, Timed
from bench.quantities import BY_SYMBOL, arguments
from bench.robots import Array, Case


def rows(
    name: str, case: Case, programs: Programs, motions: Sequence[Array], vectorised: bool = False
) -> Iterator[Row]:
    """The rows of a tool that yields CasADi functions of numeric robots.

    Args:
        name: The tool.
        case: The robot.
        programs: Its functions.
        motions: q, qd, qdd of the batch.
        vectorised: Whether there is a row of its lines on short vectors.
    """
    for symbol, program in programs:
        made = cache(_bound(symbol, program))
        for way, batch, timed in (*_WAYS, _BY_LANES)[: None if vectorised else -1]:
            label = f"{name}: {way}"
            yield Row(label, symbol, batch, lambda t=timed, s=symbol, m=made: t(case, s, m(), motions))  # type: ignore[misc]


def _bound(symbol: str, program: Callable[[], tuple[Any, Any]]) -> Callable[[], Any]:
    """The function with its parameters' numbers in it, dense, equal subexpressions merged, its rows one after another.

    CasADi stores columns one after another, so the transpose is computed.
    """

    def make() -> Any:
        function, numbers = program()
        inputs = [casadi.SX.sym(k, function.size1_in(i)) for i, k in enumerate(BY_SYMBOL[symbol].arguments)]
        value = casadi.densify(function(*inputs, numbers).T)
        return shared(casadi.Function(symbol, inputs, [value]))

    return make


def _inputs(case: Case, symbol: str, motions: Sequence[Array]) -> tuple[tuple[Array, ...], tuple[int, ...]]:
    quantity = BY_SYMBOL[symbol]
    return arguments(quantity, tuple(motions)), quantity.shape(case.robot.n)


def _plain(case: Case, symbol: str, function: Any, motions: Sequence[Array]) -> Timed:
    inputs, shape = _inputs(case, symbol, motions)
    timed = one_by_one(function, inputs, shape)
    rows_first = one_by_one(lambda *row: function(*row).full().T, inputs, shape)
    return Timed(timed.run, timed.count, rows_first.values)


def _mapped(case: Case, symbol: str, function: Any, motions: Sequence[Array]) -> Timed:
    inputs, shape = _inputs(case, symbol, [array[:_MAPPED] for array in motions])
    mapped = function.map(len(inputs[0]))

    def run(*arrays: Array) -> Array:
        columns = mapped(*(array.T for array in arrays)).full()
        return np.asarray(columns.reshape(columns.shape[0], len(arrays[0]), -1).transpose(1, 2, 0)).reshape(-1, *shape)

    return whole_batch(run, inputs)


def _compiled(case: Case, symbol: str, function: Any, motions: Sequence[Array]) -> Timed:
    return _looped(case, symbol, _loop(function), motions)


def _lanes(case: Case, symbol: str, function: Any, motions: Sequence[Array]) -> Timed:
    return _looped(case, symbol, lanes_loop(function, widest()), motions)


def _looped(case: Case, symbol: str, compiled: ctypes.CDLL, motions: Sequence[Array]) -> Timed:
    inputs, shape = _inputs(case, symbol, motions)
    out = np.empty((len(inputs[0]), *shape))
    loop, keep = compiled.loop, [np.ascontiguousarray(array) for array in inputs]
    addresses = (ctypes.c_void_p * len(keep))(*(array.ctypes.data for array in keep))
    widths = (ctypes.c_long * len(keep))(*(array.shape[1] for array in keep))
    width, target = ctypes.c_long(int(np.prod(shape))), ctypes.c_void_p(out.ctypes.data)
    size, number = ctypes.c_long(len(out)), ctypes.c_long(len(keep))
    return filled(lambda: loop(size, number, widths, addresses, width, target), out)


def _loop(function: Any) -> ctypes.CDLL:
    with TemporaryDirectory() as folder:
        generator = casadi.CodeGenerator("generated.c")
        generator.add(function)
        generator.generate(folder + "/")
        generated = Path(folder) / "generated.c"
        name = function.name()
        flags = (f'-DGENERATED="{generated.name}"', f"-DFUNCTION={name}", f"-DWORK={name}_work", "-lm")
        source = Path(folder) / "casadi_loop.c"
        source.write_bytes((FOLDER / "casadi_loop.c").read_bytes())
        return library(source, flags, [generated])


_MAPPED = 20_000
_WAYS = (
    ("f(q, ...)", False, _plain),
    ("f.map(N), NumPy in and out", True, _mapped),
    ("generated C, C loop", True, _compiled),
)
_BY_LANES = ("lines vectorised by hand, C loop", True, _lanes)

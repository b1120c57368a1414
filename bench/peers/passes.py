"""Ways to pass configurations to a function, ready for the stopwatch."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bench.peers.peer import Timed
from bench.robots import Array

SINGLE = 100
"""Configurations of a pass that takes them one by one."""


def one_by_one(
    function: Callable[..., Any], inputs: Sequence[Array], shape: tuple[int, ...], count: int = SINGLE
) -> Timed:
    """Calls with one configuration each, of ``count`` different ones.

    Args:
        function: Takes rows of the inputs.
        inputs: (N, n) each.
        shape: Of a value.
        count: How many configurations a pass has.
    """
    rows = [tuple(np.ascontiguousarray(array[k]) for array in inputs) for k in range(min(count, len(inputs[0])))]

    def run() -> None:
        for row in rows:
            function(*row)

    def values() -> Array:
        return np.array([np.asarray(function(*row), dtype=float).reshape(shape) for row in rows])

    return Timed(run, len(rows), values)


def whole_batch(function: Callable[..., Any], inputs: Sequence[Array]) -> Timed:
    """One call with all configurations; the function's result is (N, ...)."""
    return Timed(lambda: function(*inputs), len(inputs[0]), lambda: np.asarray(function(*inputs)))


def filled(function: Callable[[], object], out: Array) -> Timed:
    """A call that fills ``out``, (N, ...)."""
    return Timed(function, len(out), lambda: out)

"""Frames and columns as SymPy matrices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sympy

from derive.mechanics.vectors import Frame, Vector

Matrix = Any
Write = Callable[[Any], Any]


def _as_is(value: Any) -> Any:
    return value


def frame_matrix(frame: Frame[Any], write: Write = _as_is) -> Matrix:
    """A frame as a 4x4 matrix, every entry written by ``write``."""
    rows = [[*map(write, frame.rotation[i]), write(frame.position[i])] for i in range(3)]
    return sympy.ImmutableMatrix([*rows, [0, 0, 0, 1]])


def columns_matrix(
    linear: Sequence[Vector[Any]], angular: Sequence[Vector[Any]] | None = None, write: Write = _as_is
) -> Matrix:
    """A Jacobian from its columns: 3xn, or 6xn with the linear rows first."""
    halves = [linear] if angular is None else [linear, angular]
    columns = [[write(x) for vector in parts for x in vector] for parts in zip(*halves, strict=True)]
    return sympy.ImmutableMatrix(columns).T


def symmetric_matrix(n: int, upper: Sequence[Any]) -> Matrix:
    """A symmetric nxn matrix from its upper triangle, row by row."""
    keys = [(i, j) for i in range(n) for j in range(i, n)]
    written = dict(zip(keys, upper, strict=True))
    return sympy.ImmutableMatrix([[written[min(i, j), max(i, j)] for j in range(n)] for i in range(n)])

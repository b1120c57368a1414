"""How ``derive show`` lays a quantity out: a scalar on a line, a matrix as a grid or, if too wide, by entries."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

WIDTH = 120
"""Widest grid; fixed, so that a page of documentation shows what a user gets."""

Printer = Callable[[Any], str]


def entries(value: Any) -> list[list[Any]] | None:
    """The rows of a matrix; None for a scalar."""
    if not hasattr(value, "tolist"):
        return None
    rows: list[Any] = value.tolist()
    return [row if isinstance(row, list) else [row] for row in rows]


def text_lines(name: str, value: Any, printer: Printer) -> list[str]:
    """``name = expression``, a grid of entries, or the entries that are not zero with their places."""
    rows = entries(value)
    if rows is None:
        return [f"{name} = {printer(value)}"]
    printed = [[printer(entry) for entry in row] for row in rows]
    return _grid(name, printed) or _places(name, printed)


def python_lines(name: str, value: Any, printer: Printer) -> list[str]:
    """An assignment that Python reads once the symbols are defined: a scalar, or a matrix as a list of rows."""
    rows = entries(value)
    target = re.sub(r"\W+", "_", name).strip("_")
    if rows is None:
        return [f"{target} = {printer(value)}"]
    body = [f"    [{', '.join(printer(entry) for entry in row)}]," for row in rows]
    return [f"{target} = [", *body, "]"]


def latex_lines(value: Any, printer: Printer) -> list[str]:
    """A scalar or a matrix for mathematics mode; amsmath's matrices take at most ten columns, an array any number."""
    rows = entries(value)
    if rows is None:
        return [printer(value)]
    body = [f"  {' & '.join(printer(entry) for entry in row)} \\\\" for row in rows]
    columns = "c" * len(rows[0])
    return [rf"\left[\begin{{array}}{{{columns}}}", *body, r"\end{array}\right]"]


def plain(value: Any, printer: Printer) -> Any:
    """A scalar as text, a matrix as a list of rows."""
    rows = entries(value)
    return printer(value) if rows is None else [[printer(entry) for entry in row] for row in rows]


def _grid(name: str, printed: list[list[str]]) -> list[str]:
    """The whole matrix in aligned columns; nothing where it is too wide."""
    widths = [max(len(row[j]) for row in printed) for j in range(len(printed[0]))]
    if 2 + sum(widths) + 2 * (len(widths) - 1) > WIDTH:
        return []
    aligned = ("  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in printed)
    return [f"{name} =", *(f"  {line}" for line in aligned)]


def _places(name: str, printed: list[list[str]]) -> list[str]:
    lines = [f"{name} = ({len(printed)} x {len(printed[0])}, row,column: entry)"]
    found = [(i, j, cell) for i, row in enumerate(printed, 1) for j, cell in enumerate(row, 1) if cell != "0"]
    lines += [f"  {i},{j}: {cell}" for i, j, cell in found]
    if len(found) < len(printed) * len(printed[0]):
        lines.append("  all other entries: 0")
    return lines

"""``derive show``: quantities of a robot as text, LaTeX, Python or JSON.

How ``derive show`` lays a quantity out: a scalar on a line, a matrix as a grid or, if too wide, by entries.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from derive.model.model import Model
    from derive.robot.robot import Robot


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


SUMMARY = "print quantities of a robot: T, J, B, C, g, A[1], ..."
DESCRIPTION = """\
Print quantities of a robot in the lecture form, for instance

  derive show scara-perugia T 'A[2]' J B 'christoffel[1,1,2]' C g tau

Indices count from 1; further indices pick an entry: 'B[1,2]', 'T[][1,4]'. A matrix is printed as a grid where it
fits, else entry by entry. Without QUANTITY, the quantities that the robot has are listed.
"""
FORMATS = ("text", "latex", "python", "json")
STYLES = ("compact", "by-geometry", "expanded")
CONTRACTIONS = ("aligned", "opposed")
ABBREVIATIONS = ("christoffel", "coefficients")


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, its quantities and the form of the output."""
    parser.add_argument("robot", metavar="ROBOT", help="robot file or catalogue name")
    parser.add_argument("quantities", metavar="QUANTITY", nargs="*", help="such as T, 'A[2]', B (default: list them)")
    parser.add_argument("--format", choices=FORMATS, default="text", help="form of the output (default text)")
    parser.add_argument("--style", choices=STYLES, help="how expressions are grouped (default: as the robot file says)")
    parser.add_argument(
        "--contraction", choices=CONTRACTIONS, help="which sums of angles are contracted (default: as the file says)"
    )
    parser.add_argument(
        "--abbreviate",
        choices=ABBREVIATIONS,
        help="short names for Christoffel symbols or for constants, with their definitions (B, C, N, Bdot, g, tau)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Derive the quantities and print them."""
    from derive.robot.robot import Robot

    robot = Robot.load(arguments.robot)
    if not arguments.quantities:
        return _list(robot, arguments.format)
    shown = [derived for name in dict.fromkeys(arguments.quantities) for derived in _derived(robot, name, arguments)]
    return _print(robot, shown, arguments.format)


def _derived(robot: Robot, name: str, arguments: argparse.Namespace) -> list[tuple[str, Any]]:
    """A quantity by its name, followed by the short names in it."""
    model = _model(robot, arguments.style, arguments.contraction)
    if arguments.abbreviate is None:
        return [(name, model.quantity(name))]
    value, definitions = model.abbreviated(name, by=arguments.abbreviate)
    return [(name, value), *((str(symbol), meaning) for symbol, meaning in definitions.items())]


@cache
def _model(robot: Robot, style: str | None, contraction: str | None) -> Model:
    from derive.model.model import Model

    return Model(robot, style=style, contraction=contraction)


def _print(robot: Robot, shown: list[tuple[str, Any]], form: str) -> int:
    if form == "json":
        from derive.cli.terminal import print_json
        from derive.handout.notation.text import PlainPrinter

        printer = PlainPrinter().doprint
        print_json({"robot": robot.name, "quantities": {name: plain(value, printer) for name, value in shown}})
        return 0
    layout = _layout(robot, form)
    print("\n\n".join("\n".join(layout(name, value)) for name, value in shown))
    return 0


def _list(robot: Robot, form: str) -> int:
    from derive.cli.terminal import print_columns, print_json
    from derive.model.quantities import REGISTRY

    known = [row for row in REGISTRY.values() if robot.has_dynamics or not row.dynamic]
    rows = [(_usage(row.name, min(row.indices)), row.summary) for row in known]
    if form == "json":
        print_json({"robot": robot.name, "quantities": dict(rows)})
    else:
        print_columns(rows)
    return 0


def _usage(name: str, indices: int) -> str:
    return f"{name}[{','.join('ijk'[:indices])}]" if indices else name


def _layout(robot: Robot, form: str) -> Callable[[str, Any], list[str]]:
    if form == "python":
        from derive.handout.notation.text import PlainPrinter

        python = PlainPrinter().doprint
        return lambda name, value: python_lines(name, value, python)
    if form == "latex":
        from derive.handout.notation.notation import Notation
        from derive.handout.notation.printer import LatexPrinter

        latex = LatexPrinter(Notation.of(robot)).latex
        return lambda _, value: latex_lines(value, latex)
    from derive.handout.notation.text import TextPrinter

    text = TextPrinter(robot).doprint
    return lambda name, value: text_lines(name, value, text)

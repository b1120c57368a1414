"""``derive show``: quantities of a robot as text, LaTeX, Python or JSON."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from derive.commands.quantity_text import latex_lines, plain, python_lines, text_lines

if TYPE_CHECKING:
    from derive.robot.robot import Robot

SUMMARY = "print quantities of a robot: T, J, B, C, g, A[1], ..."
DESCRIPTION = """\
Print quantities of a robot in the lecture form, for instance

  derive show scara-perugia T 'A[2]' J B 'christoffel[1,1,2]' C g tau

Indices count from 1; further indices pick an entry: 'B[1,2]', 'T[][1,4]'. A matrix is printed as a grid where it
fits, else entry by entry. Without QUANTITY, the quantities that the robot has are listed.
"""
FORMATS = ("text", "latex", "python", "json")


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, its quantities and the form of the output."""
    parser.add_argument("robot", metavar="ROBOT", help="robot file or catalogue name")
    parser.add_argument("quantities", metavar="QUANTITY", nargs="*", help="such as T, 'A[2]', B (default: list them)")
    parser.add_argument("--format", choices=FORMATS, default="text", help="form of the output (default text)")


def run(arguments: argparse.Namespace) -> int:
    """Derive the quantities and print them."""
    from derive.robot.robot import Robot

    robot = Robot.load(arguments.robot)
    if not arguments.quantities:
        return _list(robot, arguments.format)
    return _print(robot, arguments.quantities, arguments.format)


def _print(robot: Robot, quantities: list[str], form: str) -> int:
    from derive.commands.terminal import print_json
    from derive.emit.text_printer import PlainPrinter
    from derive.mechanics.model import Model

    model = Model(robot)
    values = {name: model.quantity(name) for name in quantities}
    if form == "json":
        printer = PlainPrinter().doprint
        print_json({"robot": robot.name, "quantities": {name: plain(value, printer) for name, value in values.items()}})
        return 0
    layout = _layout(robot, form)
    print("\n\n".join("\n".join(layout(name, value)) for name, value in values.items()))
    return 0


def _list(robot: Robot, form: str) -> int:
    from derive.commands.terminal import print_columns, print_json
    from derive.mechanics.quantities import REGISTRY

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
        from derive.emit.text_printer import PlainPrinter

        python = PlainPrinter().doprint
        return lambda name, value: python_lines(name, value, python)
    if form == "latex":
        from derive.emit.latex_notation import Notation
        from derive.emit.latex_printer import LatexPrinter

        latex = LatexPrinter(Notation.of(robot)).latex
        return lambda _, value: latex_lines(value, latex)
    from derive.emit.text_printer import TextPrinter

    text = TextPrinter(robot).doprint
    return lambda name, value: text_lines(name, value, text)

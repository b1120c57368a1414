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
Print quantities of a robot in the lecture form.

  A[i]  T  T[i]  T[i,j]  p  R  rpy  euler_zyz  J  J_end  J_analytic[rpy]
  Jv_com[i]  Jw_com[i]  Jv_motor[i]  Jw_motor[i]
  kinetic  potential  B  christoffel[i,j,k]  C  N  Bdot  g  tau

Indices count from 1. A matrix is printed as a grid where it fits, else entry by entry.
"""
FORMATS = ("text", "latex", "python", "json")


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, its quantities and the form of the output."""
    parser.add_argument("robot", metavar="ROBOT", help="robot file or catalogue name")
    parser.add_argument("quantities", metavar="QUANTITY", nargs="+", help="such as T, 'A[2]', 'christoffel[1,1,2]'")
    parser.add_argument("--format", choices=FORMATS, default="text", help="form of the output (default text)")


def run(arguments: argparse.Namespace) -> int:
    """Derive the quantities and print them."""
    from derive.commands.terminal import print_json
    from derive.mechanics.model import Model
    from derive.robot.robot import Robot

    robot = Robot.load(arguments.robot)
    model = Model(robot)
    values = {name: model.quantity(name) for name in arguments.quantities}
    if arguments.format == "json":
        print_json({"robot": robot.name, "quantities": {name: plain(value, str) for name, value in values.items()}})
        return 0
    layout = _layout(robot, arguments.format)
    print("\n\n".join("\n".join(layout(name, value)) for name, value in values.items()))
    return 0


def _layout(robot: Robot, form: str) -> Callable[[str, Any], list[str]]:
    if form == "python":
        return lambda name, value: python_lines(name, value, str)
    if form == "latex":
        from derive.emit.latex_notation import Notation
        from derive.emit.latex_printer import LatexPrinter

        latex = LatexPrinter(Notation.of(robot)).latex
        return lambda _, value: latex_lines(value, latex)
    from derive.emit.text_printer import TextPrinter

    text = TextPrinter(robot).doprint
    return lambda name, value: text_lines(name, value, text)

"""SymPy expressions as one line of plain text, in the shorthand of lecture notes: ``a1*c1 + a2*c12``.

``c12`` is cos(q1 + q2), labels being the digits of the joint variables' names. The shorthand is used for a robot only
where it can be read one way: every label is a single digit, none occurs twice, and no symbol of the user looks like a
token. Otherwise cosines and sines are spelled out.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from sympy.printing.str import StrPrinter

from derive.robot.names import joint_label, robot_symbols
from derive.robot.robot import Robot

_TOKEN = re.compile(r"[cs][0-9]+")


def text_printer(robot: Robot) -> TextPrinter:
    """The printer for the expressions of one robot."""
    return TextPrinter(_labels(robot))


class TextPrinter(StrPrinter):  # type: ignore[misc]
    """Prints cosines and sines of joint angles as tokens.

    Args:
        labels: Name of joint variable -> its digit; empty to spell everything out.
    """

    def __init__(self, labels: dict[str, str]) -> None:
        super().__init__()
        self.labels = labels

    def _print_cos(self, expression: Any) -> str:
        return self._circular("c", "cos", expression.args[0])

    def _print_sin(self, expression: Any) -> str:
        return self._circular("s", "sin", expression.args[0])

    def _circular(self, letter: str, function: str, angle: Any) -> str:
        labels = [self.labels.get(str(term), "") for term in angle.as_ordered_terms()]
        if all(labels):
            return letter + "".join(sorted(labels))
        return f"{function}({self._print(angle)})"


def _labels(robot: Robot) -> dict[str, str]:
    variables = [joint.variable for joint in robot.joints]
    labels = [joint_label(variable) for variable in variables]
    if not _readable(labels) or any(_TOKEN.fullmatch(name) for name in (*variables, *robot_symbols(robot))):
        return {}
    return dict(zip(variables, labels, strict=True))


def _readable(labels: Sequence[str]) -> bool:
    return all(len(label) == 1 for label in labels) and len(set(labels)) == len(labels)

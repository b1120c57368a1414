"""The robot's data on the sheet: the DH table, the links, the parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

import sympy

from derive.handout.language import Text
from derive.handout.layout.lines import Equation, equation_lines
from derive.handout.notation.names import Glyph
from derive.handout.notation.notation import Notation
from derive.handout.notation.pieces import Box, Break, Piece, italic, joined, script
from derive.handout.notation.printer import LatexPrinter
from derive.lecture.to_sympy import expression_to_sympy
from derive.robot.description import Joint, Link
from derive.robot.expression import ZERO, Expression
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.targets.escape import latex_text

TABLE_WIDTH = 470.0
"""Room for a table [pt]."""

LONGEST_TABLE = 30
"""Rows of a table that is kept on one page; a longer one needs two runs of LaTeX to align."""

_COLUMN_GAP = 12.0
_PLAIN_DENOMINATORS = frozenset({1, 2, 3, 4, 6})
"""Denominators of multiples of pi that are written with pi; other constant angles are in degrees."""


@dataclass(frozen=True, slots=True)
class JointTable:
    """The DH table.

    Attributes:
        rows: Cells of each row as LaTeX; empty if the table is too wide for the page.
        lines: The cells joint by joint, in that case.
        limits: Whether any joint has limits.
        long: Whether it may need more than a page.
    """

    rows: tuple[tuple[str, ...], ...]
    lines: tuple[str, ...]
    limits: bool
    long: bool


class DataPrinter:
    """Prints cells of the robot file.

    Args:
        robot: The robot.
        notation: Its notation.
    """

    def __init__(self, robot: Robot, notation: Notation) -> None:
        self.robot = robot
        self.notation = notation.for_data()

    def value(self, expression: Expression | Any) -> tuple[Piece, ...]:
        """A length, mass or other number."""
        return tuple(LatexPrinter(self.notation).pieces(_sympy(expression)))

    def angle(self, expression: Expression | Any) -> tuple[Piece, ...]:
        """An angle, in multiples of pi or in degrees."""
        value = _sympy(expression)
        turn = value.coeff(sympy.pi)
        if not turn.is_Rational or not turn or (value - turn * sympy.pi).has(sympy.pi):
            return self.value(value)
        if turn.q in _PLAIN_DENOMINATORS:
            return self.value(value)
        return self.degrees(value, turn)

    def degrees(self, value: Any, turn: Any) -> tuple[Piece, ...]:
        """An angle whose constant part is written in degrees."""
        size = abs(turn) * 180
        symbol = sympy.Symbol("_degrees")
        number = joined(LatexPrinter(self.notation).pieces(size))
        glyph = Glyph(Box(f"{number.tex}^{{\\circ}}", number.width + 5.0))
        replaced = value - turn * sympy.pi + (symbol if turn > 0 else -symbol)
        return tuple(LatexPrinter(self.notation.with_terms({"_degrees": glyph})).pieces(replaced))

    def limit(self, joint: Joint, expression: Expression) -> tuple[Piece, ...]:
        """A limit; angles that are rational multiples of pi in degrees."""
        value = _sympy(expression)
        turn = value.coeff(sympy.pi)
        if joint.is_revolute and turn.is_Rational and turn and value == turn * sympy.pi:
            return self.degrees(value, turn)
        return self.value(value)

    def limits(self, joint: Joint) -> tuple[Piece, ...]:
        """Both limits with their unit."""
        if joint.limits is None:
            return (Piece(Box("\\text{--}", 6.0)),)
        lower, upper = (self.limit(joint, bound) for bound in joint.limits)
        circles = joint.is_revolute and "\\circ" in joined((*lower, *upper)).tex
        unit = "m" if not joint.is_revolute else "" if circles else "rad"
        end = [Piece(Box(f"\\;\\mathrm{{{unit}}}", 22.0))] if unit else []
        return (Piece(Box("[", 5.0)), *lower, Piece(Box(",\\, ", 6.0)), *upper, Piece(Box("]", 5.0)), *end)


def _sympy(expression: Expression | Any) -> Any:
    return expression if isinstance(expression, sympy.Basic) else expression_to_sympy(expression)


def joint_table(data: DataPrinter) -> JointTable:
    """The table, or its cells joint by joint where it is too wide."""
    limits = any(joint.limits is not None for joint in data.robot.joints)
    rows = [_row(data, joint)[: None if limits else -1] for joint in data.robot.joints]
    boxes = [[joined(cell) for cell in row] for row in rows]
    width = 90.0 + sum(max(box.width for box in column) + _COLUMN_GAP for column in zip(*boxes, strict=True))
    if width <= TABLE_WIDTH:
        cells = tuple(tuple(box.tex.strip() for box in row) for row in boxes)
        return JointTable(cells, (), limits, len(rows) > LONGEST_TABLE)
    lines = [line for i, row in enumerate(rows, 1) for line in equation_lines(_row_equations(data.robot, i, row))]
    return JointTable((), tuple(lines), limits, long=False)


def _row(data: DataPrinter, joint: Joint) -> list[tuple[Piece, ...]]:
    variable = joint.sign * sympy.Symbol(joint.variable)
    theta, d = _sympy(joint.theta), _sympy(joint.d)
    theta, d = (theta + variable, d) if joint.is_revolute else (theta, d + variable)
    first = [data.angle(theta), data.value(d)]
    last = [data.value(joint.a), data.angle(joint.alpha)]
    cells = first + last if data.robot.convention == "standard" else last[::-1] + first
    return [*cells, data.limits(joint)]


def _row_equations(robot: Robot, index: int, row: list[tuple[Piece, ...]]) -> Iterator[Equation]:
    if robot.convention == "standard":
        names = ("\\theta", index), ("d", index), ("a", index), ("\\alpha", index)
    else:
        names = ("\\alpha", index - 1), ("a", index - 1), ("\\theta", index), ("d", index)
    for (letter, number), cell in zip(names, row, strict=False):
        yield Equation(script(Box(letter, 6.5), italic(str(number))), cell)
    if robot.joints[index - 1].limits is not None:
        yield Equation(Box(f"\\text{{limits {index}}}", 45.0), row[-1])


def link_equations(data: DataPrinter, link: Link, _: Text) -> Iterator[Equation]:
    """Mass, centre of mass, inertia, rotor and friction of a link, as far as they are not zero."""
    yield from _named(data, _("mass"), link.mass, always=True)
    yield Equation(_word(_("centre of mass")), _tuple([data.value(cell) for cell in link.com]))
    for item in fields(link.inertia):
        yield from _named(data, f"$I_{{{item.name}}}$", getattr(link.inertia, item.name))
    if link.motor is not None:
        yield from _named(data, _("rotor mass"), link.motor.mass)
        yield from _named(data, _("rotor inertia"), link.motor.inertia)
        yield from _named(data, _("gear ratio"), link.motor.ratio)
    yield from _named(data, _("armature"), link.armature)
    yield from _named(data, _("viscous friction"), link.viscous)
    yield from _named(data, _("Coulomb friction"), link.coulomb)


def _named(data: DataPrinter, label: str, cell: Expression, always: bool = False) -> Iterator[Equation]:
    if always or cell != ZERO:
        yield Equation(_word(label), data.value(cell))


def _word(text: str) -> Box:
    escaped = text if text.startswith("$") else latex_text(text)
    return Box(f"\\text{{{escaped}}}", 5.2 * len(text.strip("${}")))


def _tuple(cells: list[tuple[Piece, ...]]) -> tuple[Piece, ...]:
    row: list[Piece] = [Piece(Box("(", 5.0))]
    for index, cell in enumerate(cells):
        if index:
            row.append(Piece(Box(",\\, ", 6.0)))
            cell = (cell[0]._replace(before=Break.COMMA), *cell[1:])
        row += cell
    return (*row, Piece(Box(")", 5.0)))


def parameter_equations(data: DataPrinter) -> list[Equation]:
    """Every symbol with a number."""
    glyph = data.notation.glyph
    return [Equation(glyph(name).box, data.value(value)) for name, value in data.robot.parameters]


def free_boxes(data: DataPrinter) -> list[Box]:
    """Symbols that are arguments of the generated functions."""
    return [data.notation.glyph(name).box for name in free_symbols(data.robot)]

"""Cells of the robot file in print: lengths and masses with every digit, angles in multiples of pi or in degrees."""

from __future__ import annotations

import sympy

from derive.handouts.notation.names import Glyph
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import BRACKET_WIDTH, Box, Piece, joined
from derive.handouts.notation.printer import LatexPrinter
from derive.lecture.to_sympy import Expr, expression_to_sympy
from derive.robot.description import Joint
from derive.robot.expression import Expression
from derive.robot.robot import Robot

_PLAIN_DENOMINATORS = frozenset({1, 2, 3, 4, 6})
"""Denominators of multiples of pi that are written with pi; other constant angles are in degrees."""

Pieces = tuple[Piece, ...]


class DataPrinter:
    """Prints cells of the robot file.

    Args:
        robot: The robot.
        notation: Its notation.
    """

    def __init__(self, robot: Robot, notation: Notation) -> None:
        self.robot = robot
        self.notation = notation.for_data()

    def value(self, cell: Expression | Expr) -> Pieces:
        """A length, mass or other number.

        Args:
            cell: The cell, or a SymPy expression of cells.

        Returns:
            Its pieces.
        """
        return tuple(LatexPrinter(self.notation).pieces(_sympy(cell)))

    def angle(self, cell: Expression | Expr) -> Pieces:
        """An angle; its constant part in multiples of pi or, where the denominator is unusual, in degrees.

        Args:
            cell: The cell, or a SymPy expression of cells.

        Returns:
            Its pieces.
        """
        value = _sympy(cell)
        turn = value.coeff(sympy.pi)
        is_multiple = turn.is_Rational and turn and not (value - turn * sympy.pi).has(sympy.pi)
        return self._degrees(value, turn) if is_multiple and turn.q not in _PLAIN_DENOMINATORS else self.value(value)

    def limits(self, joint: Joint) -> Pieces:
        """Both limits of a joint with their unit, in degrees where they are rational multiples of pi.

        Args:
            joint: The joint.

        Returns:
            Pieces of an interval, or of a dash where there are no limits.
        """
        if joint.limits is None:
            return (Piece(Box("\\text{--}", 6.0)),)
        bounds = []
        for value in map(_sympy, joint.limits):
            turn = value.coeff(sympy.pi)
            is_multiple = turn.is_Rational and turn and value == turn * sympy.pi
            bounds.append(self._degrees(value, turn) if joint.is_revolute and is_multiple else self.value(value))
        lower, upper = bounds
        circles = joint.is_revolute and "\\circ" in joined((*lower, *upper)).tex
        unit = "m" if not joint.is_revolute else "" if circles else "rad"
        end = [Piece(Box(f"\\;\\mathrm{{{unit}}}", 22.0))] if unit else []
        opening, closing = (Piece(Box(bracket, BRACKET_WIDTH)) for bracket in "[]")
        return (opening, *lower, Piece(Box(",\\, ", 6.0)), *upper, closing, *end)

    def _degrees(self, value: Expr, turn: Expr) -> Pieces:
        """An angle whose constant part, ``turn`` times pi, is written in degrees."""
        symbol = sympy.Symbol("_degrees")
        number = joined(LatexPrinter(self.notation).pieces(abs(turn) * 180))
        glyph = Glyph(Box(f"{number.tex}^{{\\circ}}", number.width + 5.0))
        replaced = value - turn * sympy.pi + (symbol if turn > 0 else -symbol)
        return tuple(LatexPrinter(self.notation.with_terms({"_degrees": glyph})).pieces(replaced))


def _sympy(cell: Expression | Expr) -> Expr:
    return cell if isinstance(cell, sympy.Basic) else expression_to_sympy(cell)

"""Printers of solutions: a choice of sign is a plus-minus, and the pose and named quantities have their place."""

import re
from dataclasses import replace
from typing import Any

import sympy

from derive.handouts.notation.notation import Glyph, Notation, Order
from derive.handouts.notation.pieces import Box, TexPiece, fraction, italic, joined
from derive.handouts.notation.printer import LatexPrinter, Pieces, TextPrinter
from derive.inverse.words.elementary import Sign
from derive.inverse.words.solutions import InverseKinematics
from derive.robot.options.handout import PoseEntries
from derive.robot.robot import Robot

WIDEST_QUOTIENT = 380.0  # widest sum above a divisor [pt]


class SignPrinter(TextPrinter):
    """Text in which a choice of sign is ``+-``."""

    def __init__(self, robot: Robot, notation: Notation, pose: frozenset[str]) -> None:
        super().__init__(robot, notation)
        self._order = SolutionOrder(notation, pose)

    def _print_Mul(self, expression: Any) -> str:
        if any(isinstance(factor, Sign) for factor in expression.args):
            rest = sympy.Mul(*(factor for factor in expression.args if not isinstance(factor, Sign)), evaluate=False)
            return f"+-{self.parenthesize(rest, 50)}"
        above, below = sympy.fraction(expression)
        if not below.is_Mul:
            return super()._print_Mul(expression)
        if above.as_coeff_Mul()[0] < 0:
            return f"-{self._print_Mul(-expression)}"
        return f"{self.parenthesize(above, 50, strict=True)}/({self._print(below)})"

    def _print_Symbol(self, symbol: Any) -> str:
        return "+-1" if isinstance(symbol, Sign) else str(super()._print_Symbol(symbol))

    def _print_Add(self, expression: Any, order: Any = None) -> str:
        return re.sub(r" \+ \+-", " +- ", super()._print_Add(expression, order))


class SolutionOrder(Order):
    """The order in which solutions are written: what is added before what is subtracted, the pose before the arm."""

    def __init__(self, notation: Notation, pose: frozenset[str]) -> None:
        super().__init__(notation)
        self._pose = pose

    def term(self, term: Any) -> Any:
        """Sort key of a term of a sum."""
        symbols = term.free_symbols
        has_sign = any(isinstance(symbol, Sign) for symbol in symbols)
        is_negative = bool(term.as_coeff_Mul()[0] < 0)
        return has_sign, is_negative, self._pose.isdisjoint(symbol.name for symbol in symbols), super().term(term)


def pose_names(found: InverseKinematics) -> frozenset[str]:
    """Names of the entries of the pose, and of the pose within the arm."""
    within = (line.symbol for line in found.definitions)
    return frozenset(symbol.name for symbol in (*found.pose.free_symbols, *within))


def with_names(notation: Notation, found: InverseKinematics) -> Notation:
    """The notation in which the entries of the pose, then named quantities stand behind the parameters of the arm."""
    pose = [symbol.name for symbol in found.pose[:3, :].T] + [line.symbol.name for line in found.definitions]
    named = [line.symbol.name for line in found.lines if line.symbol.is_Symbol]
    positions = {name: (0, len(notation.positions) + k) for k, name in enumerate(dict.fromkeys((*pose, *named)))}
    # The rotation of the pose by its columns n, s and a, where that is wanted and no symbol looks like it.
    letters = {found.pose[i, j].name: Glyph(italic("nsa"[j]), italic("xyz"[i])) for j in range(3) for i in range(3)}
    is_free = all(glyph.box.tex not in notation.taken for glyph in letters.values())
    if notation.options.pose is PoseEntries.COLUMNS and is_free:
        notation = notation.with_terms(letters)
    return replace(notation, positions={**positions, **notation.positions})


class SignLatexPrinter(LatexPrinter):
    """LaTeX in which a choice of sign is a plus-minus, and a quotient on its own a fraction."""

    def __init__(self, notation: Notation, found: InverseKinematics, widest: float = WIDEST_QUOTIENT) -> None:
        self._widest = widest
        signs = {symbol.name: Glyph(Box("\\pm ", 8.0)) for line in found.lines for symbol in line.signs}
        # ``q23`` with the letter that the joint variables have.
        letter = next((notation.glyph(v).head for v in notation.labels), None)
        labels = {symbol.name: re.sub(r"^\D*", "", symbol.name) for symbol in found.sums.values()}
        sums = {name: Glyph(letter, Box(k, 5.0 * len(k))) for name, k in labels.items() if k and letter}
        super().__init__(notation.with_terms({**signs, **sums}))
        self._order = SolutionOrder(notation, pose_names(found))

    def latex(self, expression: Any) -> str:
        """One line of LaTeX, for mathematics mode."""
        return with_signs(super().latex(expression))

    def pieces(self, expression: Any) -> Pieces:
        """The expression as pieces; a quotient with a sum above as a fraction, where it is not too wide."""
        above, below = sympy.fraction(expression) if expression.is_Mul else (expression, sympy.S.One)
        if above.is_Add and not below.is_Integer:
            top, bottom = joined(super().pieces(above)), joined(super().pieces(below))
            if top.width <= self._widest:
                return [TexPiece(fraction(top, bottom))]
        return super().pieces(expression)


def with_signs(text: str) -> str:
    """LaTeX without a plus or minus before a plus-minus sign."""
    return re.sub(r"\+\s*\\pm", r"\\pm", re.sub(r"-\s*\\pm", r"\\mp", text))

"""The derivation of the inverse kinematics as lines of text, of LaTeX and of Python.

Every step says where its equation comes from, prints it, and then what follows: named quantities, the unknown as an
atan2 with its signs, when it exists and where it is free.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import sympy

from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import Box
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.notation.subscripts import Glyph
from derive.handouts.notation.text import PlainPrinter, TextPrinter
from derive.model.inverse.derivation import PrintedEquation, Step
from derive.model.inverse.elementary import Line, Sign
from derive.model.inverse.nodes import Kind, Source
from derive.model.inverse.solutions import InverseKinematics
from derive.robot.robot import Robot

Print = Callable[[Any], str]


class SignPrinter(TextPrinter):
    """Text in which a choice of sign is ``+-``, and of two arcs the one that is subtracted stands last."""

    def _print_Mul(self, expression: Any) -> str:
        signs = [factor for factor in expression.args if isinstance(factor, Sign)]
        if signs:
            rest = sympy.Mul(*(factor for factor in expression.args if not isinstance(factor, Sign)), evaluate=False)
            return f"+-{self.parenthesize(rest, 50)}"
        above, below = sympy.fraction(expression)
        if not below.is_Mul:
            return super()._print_Mul(expression)
        if above.as_coeff_Mul()[0] < 0:
            return f"-{self._print_Mul(-expression)}"
        return f"{self.parenthesize(above, 50)}/({self._print(below)})"

    def _print_Symbol(self, symbol: Any) -> str:
        return "+-1" if isinstance(symbol, Sign) else str(super()._print_Symbol(symbol))

    def _print_Abs(self, expression: Any) -> str:
        return f"abs({self._print(expression.args[0])})"

    def _print_Add(self, expression: Any, order: Any = None) -> str:
        terms = sorted(expression.args, key=lambda term: (_rank(term), self._order.term(term)))
        text = str(self._print(terms[0]))
        for term in map(self._print, terms[1:]):
            if term.startswith("+-"):
                text += f" +- {term[2:]}"
            else:
                text += f" - {term[1:]}" if term.startswith("-") else f" + {term}"
        return text


def _rank(term: Any) -> int:
    """Arcs that are added, then those that are subtracted or hold a sign; other terms before signs."""
    has_sign = any(isinstance(symbol, Sign) for symbol in term.free_symbols)
    if not term.has(sympy.atan2):
        return 3 if has_sign else 0
    return 2 if has_sign or term.as_coeff_Mul()[0] < 0 else 1


class LatexSigns:
    """LaTeX in which a choice of sign is a plus-minus.

    Args:
        notation: The robot's notation.
        found: Its inverse kinematics.
    """

    def __init__(self, notation: Notation, found: InverseKinematics) -> None:
        sign = Glyph(Box("\\pm ", 8.0))
        signs = {symbol.name: sign for step in found.steps for line in step.lines for symbol in line.signs}
        sums = {name.name: _subscripted(name.name, notation) for name in found.sums.values()}
        self._printer = LatexPrinter(notation.with_terms({**signs, **sums}))

    def latex(self, expression: Any) -> str:
        """An expression, a quotient at its top as a fraction.

        Args:
            expression: A SymPy expression.
        """
        above, below = sympy.fraction(expression) if expression.is_Mul else (expression, sympy.S.One)
        if expression.is_Add and expression.has(sympy.atan2):
            terms = sorted(expression.args, key=_rank)
            text = self.latex(terms[0])
            for term in map(self.latex, terms[1:]):
                text += term if term.startswith(("-", "\\pm", "\\mp")) else f" + {term}"
            return text
        if below.is_Integer or not above.is_Add:
            return _signed(self._printer.latex(expression))
        return f"\\frac{{{self._printer.latex(above)}}}{{{self._printer.latex(below)}}}"


def _subscripted(name: str, notation: Notation) -> Glyph:
    """``q23`` with the letter that the joint variables have."""
    labels = re.sub(r"^\D*", "", name)
    letter = next((notation.glyph(v).head for v in notation.labels), None)
    if not labels or letter is None:
        return notation.glyph(name)
    return Glyph(letter, Box(labels, 5.0 * len(labels)))


def _signed(text: str) -> str:
    """Plus or minus before a plus-minus sign."""
    return re.sub(r"\+\s*\\pm", r"\\pm", re.sub(r"-\s*\\pm", r"\\mp", text))


def derivation_text(found: InverseKinematics, write: Print) -> list[str]:
    """The derivation as plain text.

    Args:
        found: The inverse kinematics.
        write: Writes an expression, see `SignPrinter`.
    """
    lines = [headline(found)]
    if found.conditions:
        lines.append(f"a pose can be reached only if {', '.join(_equation(c, write) for c in found.conditions)}")
    if found.definitions:
        lines += ["", "pose within the arm, without base, tool and offsets at both ends:"]
        lines += [f"   {formula(line, write)}" for line in found.definitions]
    for number, step in enumerate(found.steps, 1):
        lines += ["", f"{number}. {write(step.unknown)}: {reason(found, step)}"]
        lines += [f"     {_equation(equation, write)}" for equation in step.equations]
        lines += [f"   {formula(line, write)}" for line in step.lines]
        if step.exists is not sympy.true:
            lines.append(f"   real for {_relation(step.exists, write)}")
        if step.free:
            lines.append(f"   free where {' and '.join(f'{write(e)} = 0' for e in step.free)}")
    return lines


def derivation_latex(found: InverseKinematics, write: Print) -> list[str]:
    """The formulas as rows of an ``aligned`` environment.

    Args:
        found: The inverse kinematics.
        write: Writes an expression, see `LatexSigns`.
    """
    rows = [_equation(condition, write).replace("=", "&=", 1) for condition in found.conditions]
    for line in (*found.definitions, *(line for step in found.steps for line in step.lines)):
        values = " \\text{ or } ".join(map(write, line.alternatives))
        rows.append(f"{write(line.symbol)} &= {values}")
    body = [f"  {row} \\\\" for row in rows]
    return ["\\begin{aligned}", *body, "\\end{aligned}"]


def derivation_python(found: InverseKinematics) -> list[str]:
    """The formulas as assignments; the signs are ``epsilon_1``, ..., each 1 or -1.

    Args:
        found: The inverse kinematics.
    """
    write, named = PlainPrinter().doprint, found.sums
    lines = []
    for line in (*found.definitions, *(line for step in found.steps for line in step.lines)):
        remark = "".join(f"  # {sign}: 1 or -1" for sign in line.signs)
        lines.append(f"{write(line.symbol)} = {write(line.value.xreplace(dict(named)))}{remark}")
    return lines


def headline(found: InverseKinematics) -> str:
    """How many solutions there are, in words.

    Args:
        found: The inverse kinematics.
    """
    if not found.graph.is_closed:
        return f"no closed form: {found.graph.why_not}"
    count = f"{found.count} solution{'s' if found.count != 1 else ''}"
    return f"{count}, and no more" if found.complete else f"at most {found.graph.leaves} solutions"


def reason(found: InverseKinematics, step: Step) -> str:
    """Where the equations of a step come from, in words.

    Args:
        found: The inverse kinematics.
        step: The step.
    """
    match step.kind:
        case Kind.GIVEN:
            return "given"
        case Kind.SUM:
            return "by the angles that are known"
    by_matrix: dict[str, list[str]] = {}
    for equation in step.equations:
        matrix = product_text(found.robot, equation.source, "W" if found.definitions else "T")
        by_matrix.setdefault(matrix, []).append(entry_text(equation.source))
    return "; ".join(f"{' and '.join(dict.fromkeys(entries))} of {matrix}" for matrix, entries in by_matrix.items())


def product_text(robot: Robot, source: Source, pose: str) -> str:
    """``A_1^-1 T A_6^-1``: the product that holds the joints first..last alone.

    Args:
        robot: The robot.
        source: Which joints.
        pose: What the pose is called.
    """
    before = [f"A_{i}^-1" for i in range(source.first - 1, 0, -1)]
    after = [f"A_{i}^-1" for i in range(robot.n, source.last, -1)]
    return " ".join((*before, pose, *after))


def entry_text(source: Source) -> str:
    """Which entry, or what of the entries.

    Args:
        source: Where an equation comes from.
    """
    name = source.entry
    places = ",".join(re.findall(r"\d", name))
    if name.startswith("R"):
        return f"entry ({places})"
    if name.startswith("p["):
        return f"entry ({places},4)"
    if name.startswith("u["):
        return f"entry ({places},4) of the inverse"
    if name == "p.p":
        return "the squared distance of the origin"
    if name in ("p.xy", "u.xy"):
        return f"the squares of entries (1,4) and (2,4){' of the inverse' if name[0] == 'u' else ''}, added,"
    return f"entry ({places}) of {'the moment p x R' if name[0] == 'm' else 'p.p R - 2 p p^T R'}"


def formula(line: Line, write: Print) -> str:
    """``theta2 = atan2(+-sqrt(1 - D**2), D)``; both values where a sign stands in it twice.

    Args:
        line: The line.
        write: Writes an expression.
    """
    return f"{write(line.symbol)} = {' or '.join(map(write, line.alternatives))}"


def _equation(equation: PrintedEquation, write: Print) -> str:
    return f"{write(equation.left)} = {write(equation.right)}"


def _relation(relation: Any, write: Print) -> str:
    return f"{write(relation.lhs)} {relation.rel_op} {write(relation.rhs)}"

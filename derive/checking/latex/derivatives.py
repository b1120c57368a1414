r"""Derivatives in print as what they stand for, such as ``\frac{d}{dt}\frac{\partial L}{\partial\dot\theta_1}``."""

import re
from collections.abc import Callable

import sympy

from derive.errors import CheckError
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.robot.expression import Expression, Name, expanded_terms, names
from derive.robot.names import acceleration_name, own_names, velocity_name
from derive.robot.robot import Robot

MAX_TERMS = 20_000  # of a formula that is differentiated, multiplied out
_INNER = r"(?:[^{}]|\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\})*"
_BRACKET = r"(?:\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)|\[(?:[^][]|\[[^][]*\])*\])"
_DEL = r"\\partial(?![A-Za-z])"
_PARTIAL = re.compile(
    rf"\\[dtc]?frac\s*\{{\s*{_DEL}(?P<above>{_INNER})\}}\s*\{{\s*{_DEL}(?P<below>{_INNER})\}}(?P<behind>\s*{_BRACKET})?"
)
_TOTAL = rf"\\dot\s*(?:(?P<sign>[%s])|(?P<bracket>{_BRACKET})|\{{\s*(?P<inner>[%s]|{_BRACKET})\s*\}})"


def without_derivatives(
    text: str, robot: Robot, read: Callable[[str], Expression], sign: Callable[[Expression], str]
) -> str:
    """A formula with one sign for each derivative in it, as long as before; read says what a part stands for."""
    signs = "\0"
    while match := _PARTIAL.search(text):
        above, end = match["above"], match.end()
        if above.strip():
            end -= len(match["behind"] or "")
        else:
            above = match["behind"] or ""
        variable = read(match["below"])
        by = variable.name if isinstance(variable, Name) else ""
        if by not in {name for joint in robot.joints for name in (joint.variable, velocity_name(joint.variable))}:
            raise CheckError("derivative by what is not a joint variable or its velocity")
        signs += (found := sign(_derivative(robot, read(above), by)))
        text = text[: match.start()] + found.ljust(end - match.start()) + text[end:]
    while match := re.search(_TOTAL % (signs, signs), text):
        signs += (found := sign(_derivative(robot, read(match["sign"] or match["bracket"] or match["inner"]))))
        text = text[: match.start()] + found.ljust(len(match[0])) + text[match.end() :]
    return text


def _derivative(robot: Robot, formula: Expression, by: str = "") -> Expression:
    """The derivative by a joint variable or a velocity; without one by time, the accelerations among the results."""
    joints = [joint.variable for joint in robot.joints]
    rates = {q: velocity_name(q) for q in joints} | {velocity_name(q): acceleration_name(q) for q in joints}
    if isinstance(formula, Name) and formula.name not in rates:
        raise CheckError("derivative of a symbol")
    if not own_names(robot).union(rates).issuperset(names(formula)):
        raise CheckError("derivative of what has other names than those of the robot")
    if expanded_terms(formula, MAX_TERMS) > MAX_TERMS:
        raise CheckError("derivative of a formula with too many terms")
    whole = expression_to_sympy(formula)
    if by:
        return expression_from_sympy(whole.diff(sympy.Symbol(by)))
    steps = (whole.diff(sympy.Symbol(name)) * sympy.Symbol(rate) for name, rate in rates.items())
    return expression_from_sympy(sympy.Add(*steps))

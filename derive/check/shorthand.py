"""Printed trees as text in the shorthand of lecture notes, grouping and order kept: ``s1*(a2*c2 - d3*s23)``."""

from __future__ import annotations

from collections.abc import Mapping

from derive.robot.arithmetic import add, multiply, power
from derive.robot.expression import Call, Expression, Name, Power, Product, Sum
from derive.robot.names import joint_label, robot_symbols
from derive.robot.printer import to_text
from derive.robot.robot import Robot

LETTER = {"cos": "c", "sin": "s"}


def notation_text(expression: Expression, robot: Robot) -> str:
    """A tree as one line; ``c12`` for cos(q1 + q2) where that can be read in one way only."""
    return to_text(with_tokens(expression, _labels(robot)))


def with_tokens(e: Expression, labels: Mapping[str, str]) -> Expression:
    """A tree with names such as c12 in the place of cosines and sines of labelled joint angles."""
    match e:
        case Call(function, (argument,)) if function in LETTER and (digits := _digits(argument, labels)):
            return Name(LETTER[function] + digits)
        case Call(function, arguments):
            return Call(function, tuple(with_tokens(a, labels) for a in arguments))
        case Sum(terms):
            return add(*(with_tokens(t, labels) for t in terms))
        case Product(factors):
            return multiply(*(with_tokens(f, labels) for f in factors))
        case Power(base, exponent):
            return power(with_tokens(base, labels), exponent)
        case _:
            return e


def _digits(angle: Expression, labels: Mapping[str, str]) -> str:
    terms = angle.terms if isinstance(angle, Sum) else (angle,)
    found = [labels.get(term.name, "") if isinstance(term, Name) else "" for term in terms]
    return "".join(sorted(found)) if all(found) and len(set(found)) == len(found) else ""


def _labels(robot: Robot) -> dict[str, str]:
    """Revolute variable -> its digit; empty where tokens would be ambiguous."""
    labels = [joint_label(joint.variable) for joint in robot.joints]
    taken = {*robot_symbols(robot), *(joint.variable for joint in robot.joints)}
    clear = all(len(label) == 1 for label in labels) and len(set(labels)) == len(labels)
    if not clear or any(name[0] in "cs" and name[1:].isdigit() for name in taken):
        return {}
    return {j.variable: label for j, label in zip(robot.joints, labels, strict=True) if j.is_revolute}

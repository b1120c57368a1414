"""A robot as an HTML table, for notebooks."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from derive.robot.expression import ZERO, Expression
from derive.robot.printer import to_text
from derive.robot.robot import Convention, Joint, Robot


def html_table(robot: Robot) -> str:
    """The DH table with joint types and limits, in radians and metres; every text of the user's escaped."""
    standard = robot.convention is Convention.STANDARD
    names = ("&theta;", "d", "a", "&alpha;")
    if not standard:
        names = ("&alpha;<sub>i&minus;1</sub>", "a<sub>i&minus;1</sub>", "&theta;", "d")
    head = "".join(f"<th>{name}</th>" for name in ("i", "joint", *names, "limits"))
    body = "".join(_row(i, joint, standard) for i, joint in enumerate(robot.joints, 1))
    caption = f"{escape(robot.title)} ({robot.convention.value} Denavit-Hartenberg convention)"
    return f"<table><caption>{caption}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _row(index: int, joint: Joint, standard: bool) -> str:
    theta = _moving(joint, joint.theta) if joint.is_revolute else to_text(joint.theta)
    d = to_text(joint.d) if joint.is_revolute else _moving(joint, joint.d)
    a, alpha = to_text(joint.a), to_text(joint.alpha)
    limits = "" if joint.limits is None else " to ".join(map(to_text, joint.limits))
    cells = (theta, d, a, alpha) if standard else (alpha, a, theta, d)
    return "<tr>" + "".join(_cells(str(index), joint.type.value, *cells, limits)) + "</tr>"


def _cells(*texts: str) -> Iterator[str]:
    return (f"<td>{escape(text)}</td>" for text in texts)


def _moving(joint: Joint, constant: Expression) -> str:
    """``sign*q + constant``."""
    variable = joint.variable if joint.sign > 0 else f"-{joint.variable}"
    if constant == ZERO:
        return variable
    rest = to_text(constant)
    return f"{variable} - {rest[1:]}" if rest.startswith("-") else f"{variable} + {rest}"

"""Remarks on bodies of a plan that no body is: loads, and links by the numbers that a plan gives their symbols."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from derive.errors import path_text
from derive.plans.points import Payload
from derive.robot.body_remarks import REMEDY, impossible_links, lack_of, too_large
from derive.robot.description import Remark
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import Expression
from derive.robot.reading.document import Document, KeyPath
from derive.robot.robot import Robot


def remarks_on_loads(
    document: Document,
    robot: Robot,
    numbers: tuple[Mapping[str, Expression], Mapping[str, Expression]],
    payloads: Mapping[KeyPath, Payload],
) -> Iterator[Remark]:
    """Of a plan with numbers of its own and such of the plant for the symbols of its robot."""
    values = dict(parameter_values(robot))
    told = impossible_links(robot, values) if robot.remarks else {}
    for key, given in zip(("values", "plant"), numbers, strict=True):
        values |= {name: evaluate(value, values) for name, value in given.items()}
        lacks = impossible_links(robot, values)
        if given and lacks and lacks != told:
            links = ", ".join(str(index + 1) for index in lacks)
            found = f"with these {key} links {links}, inertia: {too_large(lacks.values())}"
            yield Remark(document.location((key,)), found, REMEDY, is_of_bodies=True)
            told = lacks
    for path, payload in payloads.items():
        xx, yy, zz = (Fraction(evaluate(cell, values)) for cell in payload.inertia)
        if lack := lack_of((xx, yy, zz, Fraction(0), Fraction(0), Fraction(0))):
            found = f"{path_text(path)}, inertia: {too_large([lack])}"
            remedy = "write the moments of a body about its centre of mass"
            yield Remark(document.location((*path, "inertia")), found, remedy, is_of_bodies=True)

"""``frames.yaml``: products of elementary rotations and translations, through the public functions."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import sympy

from derive.checking.frames_file import compose, point, rotation, translation
from derive.errors import Location
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.model.equality import compare
from derive.robot.description import Convention
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from tests.lectures.results import Result, document, is_counted

NO_ROBOT = Robot(name="frames", title="", convention=Convention.STANDARD, joints=())
FACTOR = re.compile(r"(\w+)\((.*)\)")
FRAMES = document("frames.yaml")["items"]
Matrix = Any


@cache
def frame_results(name: str) -> tuple[Result, ...]:
    """One item, every printed form and every printed factor of it."""
    (item,) = (item for item in FRAMES if item["id"] == name)
    factors = [factor(text) for text in item["factors"]]
    right = substituted(item["at"], product(factors)) if "at" in item else product(factors)
    results = [result for rows in (item["matrix"], *item.get("forms", ())) for result in compared(item, rows, right)]
    for rows, derived in zip(item.get("printed_factors", ()), factors, strict="printed_factors" in item):
        results += compared({**item, "correct": {}}, rows, derived)
    return tuple(results)


def product(factors: list[Matrix]) -> Matrix:
    """Rotations alone are 3x3; everything else goes through `compose`."""
    return factors[0] if factors[0].shape == (3, 3) else compose(*factors)


def factor(text: str) -> Matrix:
    name, inner = FACTOR.fullmatch(text).groups()
    arguments = [argument.strip() for argument in inner.split(",")]
    match name:
        case "Ref":
            return reference(arguments[0])
        case "Rot":
            return rotation(arguments[0], scalar(arguments[1]))
        case "Rot3":
            return rotation(arguments[0], scalar(arguments[1]))[:3, :3]
        case "Trans":
            return translation(*map(scalar, arguments))
        case "Vec":
            return point(*map(scalar, arguments))
    raise ValueError(text)


def reference(name: str) -> Matrix:
    (item,) = (item for item in FRAMES if item["id"] == name)
    return compose(*map(factor, item["factors"]))


def substituted(values: Mapping[str, Any], matrix: Matrix) -> Matrix:
    return matrix.subs({sympy.Symbol(name): scalar(str(value)) for name, value in values.items()})


def scalar(text: str) -> Any:
    return expression_to_sympy(parse_expression(text, Location("frames.yaml")))


def compared(item: Mapping[str, Any], rows: list[list[str]], right: Matrix) -> Iterator[Result]:
    assert right.shape == (len(rows), len(rows[0])), item["id"]
    correct = {tuple(map(int, place.split(","))): text for place, text in item.get("correct", {}).items()}
    for i, row in enumerate(rows):
        for j, text in enumerate(row):
            correction = correct.get((i + 1, j + 1))
            yield Result(
                entry=f"{item['id']} ({i + 1},{j + 1})",
                item=item["id"],
                ok=correction is None,
                equal=is_equal(text, right[i, j]),
                corrected=None if correction is None else is_equal(correction, right[i, j]),
                counted=is_counted(item),
            )


def is_equal(text: str, right: Any) -> bool:
    formula = parse_expression(text, Location("frames.yaml"))
    verdict = compare(NO_ROBOT, expression_from_sympy(right), formula)
    return verdict.equal

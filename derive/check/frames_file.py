"""Files of printed frames: products of elementary rotations and translations, factor by factor and multiplied out.

``items:`` holds one mapping for each product: ``factors`` such as ``Trans(l1, 0, 0)``, ``Rot(z, pi/2)``, ``Rot3(x, a)``
(3x3), ``Vec(x, y, z)`` (a point) and ``Ref(id)`` (an earlier item), and the printed ``matrix``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import sympy

from derive.algebra.to_sympy import expression_to_sympy
from derive.check import tree
from derive.check.diagnosis import Question
from derive.check.findings import FileReport, Finding, Role
from derive.check.printed import Remark
from derive.check.remarks import printed_in, remark, text_of
from derive.errors import CheckError, DeriveError, Location
from derive.mechanics.elementary import compose, point, rotation, translation
from derive.mechanics.equality import compare, expression_from_sympy
from derive.robot import document
from derive.robot.document import Node, Scalar
from derive.robot.expression import Expression
from derive.robot.limits import FORMULA_LIMITS
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.robot import Convention, Robot
from derive.robot.wording import quoted

Matrix = Any

NO_ROBOT = Robot(name="frames", title="", convention=Convention.STANDARD, joints=())
"""Formulas about frames have symbols and no joints."""

FUNCTIONS = ("Rot", "Rot3", "Trans", "Vec", "Ref")
_FACTOR = re.compile(r"\s*([A-Za-z0-9]+)\((.*)\)\s*", re.DOTALL)
_PLACE = re.compile(r"\s*([0-9]{1,3})\s*,\s*([0-9]{1,3})\s*")
_KEYS = ("source", "printed_factors", "forms", "at", "status", "kind", "correct", "note", "ocr", "duplicate", "implied")


def check_frames(root: document.Mapping, source: str) -> FileReport:
    """Compare every printed product of a file with the product of its factors.

    Args:
        root: The file, with the key ``items``.
        source: Its name.

    Raises:
        CheckError: A factor, a formula or the structure around it cannot be read.
    """
    top = tree.mapping(root, "the file", ("items",), ("source", "notes"))
    reader = _Reader()
    findings = [f for item in tree.items(top.entries["items"][1], "items") for f in reader.item(item)]
    return FileReport(source, "frames", tuple(findings), document=printed_in(top))


class _Reader:
    def __init__(self) -> None:
        self.known: dict[str, Matrix] = {}

    def item(self, node: Node) -> Iterator[Finding]:
        item = tree.mapping(node, "an item", ("id", "factors", "matrix"), _KEYS)
        name = text_of(item, "id")
        factors = [self.factor(tree.scalar(f, "a factor")) for f in tree.items(item.entries["factors"][1], "factors")]
        try:
            product = _product(factors)
        except DeriveError as error:
            raise error.at(item.location) from None
        self.known[name] = product
        yield from _compared(item, name, tree.child(item, "matrix"), self.placed_at(item, product))
        for form in tree.items(tree.child(item, "forms"), "forms"):
            yield from _compared(item, name, form, self.placed_at(item, product))
        for i, (rows, factor) in enumerate(_printed_factors(item, factors), 1):
            yield from _compared(item, f"{name} factor {i}", rows, factor, {})

    def placed_at(self, item: document.Mapping, matrix: Matrix) -> Matrix:
        values = tree.child(item, "at")
        if values is None:
            return matrix
        pairs = tree.mapping(values, "at").entries.values()
        found = {sympy.Symbol(key.text): _value(tree.scalar(value, "a value")) for key, value in pairs}
        return matrix.subs(found)

    def factor(self, text: Scalar) -> Matrix:
        match = _FACTOR.fullmatch(text.text)
        if match is None or match[1] not in FUNCTIONS:
            raise CheckError(
                f"factor {quoted(text.text)}",
                allowed="allowed: Rot(z, angle), Rot3(z, angle), Trans(x, y, z), Vec(x, y, z), Ref(id)",
                location=text.location,
            )
        try:
            return self.elementary(match[1], _arguments(match[2]), text.location)
        except (DeriveError, TypeError) as error:
            shown = CheckError(f"factor {quoted(text.text)}: {error}") if isinstance(error, TypeError) else error
            raise shown.at(text.location) from None

    def elementary(self, name: str, arguments: list[str], where: Location) -> Matrix:
        if name == "Ref":
            if arguments[0] not in self.known:
                raise CheckError(f"Ref to {quoted(arguments[0])}", allowed="the id of an earlier item")
            return self.known[arguments[0]]
        numbers = [_formula(argument, where) for argument in arguments[name.startswith("Rot") :]]
        scalars = [expression_to_sympy(number) for number in numbers]
        if len(scalars) != (1 if name.startswith("Rot") else 3):
            raise CheckError(f"{name} with {len(arguments)} arguments", allowed="Rot takes 2, Trans and Vec take 3")
        match name:
            case "Trans":
                return translation(*scalars)
            case "Vec":
                return point(*scalars)
            case "Rot":
                return rotation(arguments[0], scalars[0])
            case _:
                return rotation(arguments[0], scalars[0])[:3, :3]


def _product(factors: list[Matrix]) -> Matrix:
    """Rotations alone are 3x3 and stand alone; everything else is composed."""
    return factors[0] if len(factors) == 1 and factors[0].shape == (3, 3) else compose(*factors)


def _printed_factors(item: document.Mapping, factors: list[Matrix]) -> Iterator[tuple[Node, Matrix]]:
    printed = tree.items(tree.child(item, "printed_factors"), "printed_factors")
    if printed and len(printed) != len(factors):
        raise CheckError(f"{len(printed)} printed factors of {len(factors)}", location=item.location)
    yield from zip(printed, factors, strict=False)


def _compared(
    item: document.Mapping,
    name: str,
    matrix: Node | None,
    right: Matrix,
    correct: Mapping[tuple[int, int], Scalar] | None = None,
) -> Iterator[Finding]:
    corrections = _corrections(item) if correct is None else correct
    said = remark(item)
    rows = [tree.items(row, "a row") for row in tree.items(matrix, "matrix")]
    if (len(rows), *{len(row) for row in rows}) != right.shape:
        raise CheckError(f"{name}: printed in another shape", allowed=f"{right.shape}", location=item.location)
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            correction = corrections.get((i + 1, j + 1))
            printed = tree.scalar(cell, "an entry")
            yield _finding(said, name, (i, j), printed, right[i, j], Role.PRODUCT, correction is not None)
            if correction is not None:
                yield _finding(said, name, (i, j), correction, right[i, j], Role.CORRECTION, False)


def _corrections(item: document.Mapping) -> dict[tuple[int, int], Scalar]:
    node = tree.child(item, "correct")
    found = {}
    for key, value in tree.mapping(node, "correct").entries.values() if node else ():
        match = _PLACE.fullmatch(key.text)
        if match is None:
            raise CheckError(f"place {quoted(key.text)}", allowed="row,column", location=key.location)
        found[int(match[1]), int(match[2])] = tree.scalar(value, "a correction")
    return found


def _finding(
    said: Remark, name: str, at: tuple[int, int], text: Scalar, right: Any, role: Role, erratum: bool
) -> Finding:
    question = Question(NO_ROBOT, _formula(text.text, text.inner), expression_from_sympy(right))
    try:
        verdict = compare(NO_ROBOT, question.right, question.printed)
    except DeriveError as error:
        raise error.at(text.location) from None
    row, column = at[0] + 1, at[1] + 1
    return Finding(name, row, column, role, text.text, verdict, right, text.inner, erratum, question, remark=said)


def _arguments(text: str) -> list[str]:
    """Arguments between commas; formulas of frames have no commas of their own."""
    return [argument.strip() for argument in text.split(",")]


def _value(text: Scalar) -> Any:
    return expression_to_sympy(_formula(text.text, text.inner))


def _formula(text: str, where: Location) -> Expression:
    return parse_expression(text, where, FORMULA_FUNCTIONS, FORMULA_LIMITS)

"""Files of printed frames: products of elementary rotations and translations, factor by factor and multiplied out.

``items:`` holds one mapping for each product: ``factors`` such as ``Trans(l1, 0, 0)``, ``Rot(z, pi/2)``, ``Rot3(x, a)``
(3x3), ``Vec(x, y, z)`` (a point) and ``Ref(id)`` (an earlier item), and the printed ``matrix``.

Elementary rotations and translations as exact 4x4 matrices, and their products.

What lectures draw before any table: Rot(z, pi/2), Trans(4, -3, 7), and a chain of them (Siciliano, Sciavicco, Villani,
Oriolo, Robotics, sections 2.2 and 2.7). Entries are plain SymPy; products are reduced by sin^2 + cos^2 = 1. Nothing is
rounded: a float stands for the decimal that it prints.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.from_sympy import expression_from_sympy
from derive.algebra.ring import Polynomial
from derive.check import reading
from derive.check.diagnosis import Question
from derive.check.findings import FileReport, Finding, Role
from derive.check.printed import Remark
from derive.check.reading import printed_in, remark, text_of
from derive.errors import CheckError, DeriveError, ExpressionError, Location, quoted
from derive.lecture.form import LectureForm
from derive.lecture.to_sympy import expression_to_sympy
from derive.model.equality import compare
from derive.robot import document
from derive.robot.description import Convention
from derive.robot.document import Node, YamlScalar
from derive.robot.expression import Expression
from derive.robot.limits import FORMULA_LIMITS
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.robot import Robot

Angle = Any

_NO_ROBOT = Robot(name="frames", title="", convention=Convention.STANDARD, joints=())
_FIRST_ROW = {"x": 1, "y": 2, "z": 0}
"""The row from which a turn about the axis goes to the next one: y to z, z to x, x to y."""


def rotation(axis: str, angle: Angle) -> Matrix:
    """Rot(axis, angle), 4x4: the turn about a coordinate axis, counter-clockwise seen from its tip.

    Args:
        axis: ``x``, ``y`` or ``z``.
        angle: Angle [rad], a number or a SymPy expression.

    Raises:
        ExpressionError: Another axis, or an angle that is neither.
    """
    if axis not in _FIRST_ROW:
        raise ExpressionError(f"axis {axis!r}", allowed="x, y or z")
    turn = _scalar(angle)
    i = _FIRST_ROW[axis]
    j = (i + 1) % 3
    matrix = sympy.eye(4)
    matrix[i, i] = matrix[j, j] = sympy.cos(turn)
    matrix[i, j], matrix[j, i] = -sympy.sin(turn), sympy.sin(turn)
    return sympy.ImmutableMatrix(matrix)


def translation(x: Angle, y: Angle, z: Angle) -> Matrix:
    """Trans(x, y, z), 4x4.

    Args:
        x: Displacement along x [m], a number or a SymPy expression.
        y: Along y.
        z: Along z.

    Raises:
        ExpressionError: A displacement that is neither.
    """
    matrix = sympy.eye(4)
    matrix[:3, 3] = sympy.Matrix([_scalar(x), _scalar(y), _scalar(z)])
    return sympy.ImmutableMatrix(matrix)


def point(x: Angle, y: Angle, z: Angle) -> Matrix:
    """The homogeneous coordinates (x, y, z, 1), 4x1, of a point [m]."""
    return translation(x, y, z)[:, 3]


def compose(*frames: Matrix) -> Matrix:
    """The product of frames from left to right, exact and reduced.

    Args:
        frames: 4x4 matrices; the last may be a point, 4x1.

    Returns:
        4x4, or 4x1 after a point.

    Raises:
        ExpressionError: No frame, or shapes that do not fit.
    """
    shapes = [getattr(frame, "shape", None) for frame in frames]
    if not frames or any(shape != (4, 4) for shape in shapes[:-1]) or shapes[-1] not in ((4, 4), (4, 1)):
        raise ExpressionError(f"frames of shapes {shapes}", allowed="4x4 matrices, the last one 4x4 or a point 4x1")
    factors = [_expressions(frame) for frame in frames]
    domain = PolynomialDomain(_NO_ROBOT, [e for rows in factors for row in rows for e in row], rates=False)
    product = [[domain.constant(e) for e in row] for row in factors[0]]
    for factor in factors[1:]:
        product = _matrix_product(product, [[domain.constant(e) for e in row] for row in factor])
    write = LectureForm(domain).kinematic
    return sympy.ImmutableMatrix([[write(entry) for entry in row] for row in product])


def _scalar(value: Angle) -> Angle:
    try:
        found = sympy.sympify(value, strict=True)
    except sympy.SympifyError:
        found = None
    if not isinstance(found, sympy.Expr) or found.is_Matrix:
        raise ExpressionError(f"value of type {type(value).__name__}", allowed="a number or a SymPy expression")
    return expression_to_sympy(expression_from_sympy(found))


def _expressions(frame: Matrix) -> list[list[Expression]]:
    return [[expression_from_sympy(entry) for entry in row] for row in frame.tolist()]


def _matrix_product(a: Sequence[Sequence[Polynomial]], b: Sequence[Sequence[Polynomial]]) -> list[list[Polynomial]]:
    ring = a[0][0].ring
    return [[ring.sum(x * row[j] for x, row in zip(left, b, strict=True)) for j in range(len(b[0]))] for left in a]


Matrix = Any

NO_ROBOT = Robot(name="frames", title="", convention=Convention.STANDARD, joints=())
"""Formulas about frames have symbols and no joints."""

FUNCTIONS = ("Rot", "Rot3", "Trans", "Vec", "Ref")
_FACTOR = re.compile(r"\s*([A-Za-z0-9]+)\((.*)\)\s*", re.DOTALL)
_PLACE = re.compile(r"\s*([0-9]{1,3})\s*,\s*([0-9]{1,3})\s*")
_KEYS = ("source", "printed_factors", "forms", "at", "status", "kind", "correct", "note", "ocr", "duplicate", "implied")


def check_frames(root: document.YamlMapping, source: str) -> FileReport:
    """Compare every printed product of a file with the product of its factors.

    Args:
        root: The file, with the key ``items``.
        source: Its name.

    Raises:
        CheckError: A factor, a formula or the structure around it cannot be read.
    """
    top = reading.mapping(root, "the file", ("items",), ("source", "notes"))
    reader = _Reader()
    findings = [f for item in reading.items(top.entries["items"][1], "items") for f in reader.item(item)]
    return FileReport(source, "frames", tuple(findings), document=printed_in(top))


class _Reader:
    def __init__(self) -> None:
        self.known: dict[str, Matrix] = {}

    def item(self, node: Node) -> Iterator[Finding]:
        item = reading.mapping(node, "an item", ("id", "factors", "matrix"), _KEYS)
        name = text_of(item, "id")
        factors = [
            self.factor(reading.scalar(f, "a factor")) for f in reading.items(item.entries["factors"][1], "factors")
        ]
        try:
            product = _product(factors)
        except DeriveError as error:
            raise error.at(item.location) from None
        self.known[name] = product
        yield from _compared(item, name, reading.child(item, "matrix"), self.placed_at(item, product))
        for form in reading.items(reading.child(item, "forms"), "forms"):
            yield from _compared(item, name, form, self.placed_at(item, product))
        for i, (rows, factor) in enumerate(_printed_factors(item, factors), 1):
            yield from _compared(item, f"{name} factor {i}", rows, factor, {})

    def placed_at(self, item: document.YamlMapping, matrix: Matrix) -> Matrix:
        values = reading.child(item, "at")
        if values is None:
            return matrix
        pairs = reading.mapping(values, "at").entries.values()
        found = {sympy.Symbol(key.text): _value(reading.scalar(value, "a value")) for key, value in pairs}
        return matrix.subs(found)

    def factor(self, text: YamlScalar) -> Matrix:
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


def _printed_factors(item: document.YamlMapping, factors: list[Matrix]) -> Iterator[tuple[Node, Matrix]]:
    printed = reading.items(reading.child(item, "printed_factors"), "printed_factors")
    if printed and len(printed) != len(factors):
        raise CheckError(f"{len(printed)} printed factors of {len(factors)}", location=item.location)
    yield from zip(printed, factors, strict=False)


def _compared(
    item: document.YamlMapping,
    name: str,
    matrix: Node | None,
    right: Matrix,
    correct: Mapping[tuple[int, int], YamlScalar] | None = None,
) -> Iterator[Finding]:
    corrections = _corrections(item) if correct is None else correct
    said = remark(item)
    rows = [reading.items(row, "a row") for row in reading.items(matrix, "matrix")]
    if (len(rows), *{len(row) for row in rows}) != right.shape:
        raise CheckError(f"{name}: printed in another shape", allowed=f"{right.shape}", location=item.location)
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            correction = corrections.get((i + 1, j + 1))
            printed = reading.scalar(cell, "an entry")
            yield _finding(said, name, (i, j), printed, right[i, j], Role.PRODUCT, correction is not None)
            if correction is not None:
                yield _finding(said, name, (i, j), correction, right[i, j], Role.CORRECTION, False)


def _corrections(item: document.YamlMapping) -> dict[tuple[int, int], YamlScalar]:
    node = reading.child(item, "correct")
    found = {}
    for key, value in reading.mapping(node, "correct").entries.values() if node else ():
        match = _PLACE.fullmatch(key.text)
        if match is None:
            raise CheckError(f"place {quoted(key.text)}", allowed="row,column", location=key.location)
        found[int(match[1]), int(match[2])] = reading.scalar(value, "a correction")
    return found


def _finding(
    said: Remark, name: str, at: tuple[int, int], text: YamlScalar, right: Any, role: Role, erratum: bool
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


def _value(text: YamlScalar) -> Any:
    return expression_to_sympy(_formula(text.text, text.inner))


def _formula(text: str, where: Location) -> Expression:
    return parse_expression(text, where, FORMULA_FUNCTIONS, FORMULA_LIMITS)

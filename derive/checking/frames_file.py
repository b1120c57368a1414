"""Files of printed frames: products of elementary rotations and translations, factor by factor and multiplied out.

``items:`` holds one mapping for each product: ``factors`` such as ``Trans(l1, 0, 0)``, ``Rot(z, pi/2)``, ``Rot3(x, a)``
(3x3), ``Vec(x, y, z)`` (a point) and ``Ref(id)`` (an earlier item), and the printed ``matrix`` (Siciliano, Sciavicco,
Villani, Oriolo, Robotics, sections 2.2 and 2.7). Products are exact, reduced by sin^2 + cos^2 = 1; a float stands for
the decimal that it prints.
"""

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from operator import mul

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.checking.formulas import reading
from derive.checking.formulas.diagnosis import Question
from derive.checking.formulas.findings import FileReport, Finding, Role, compared
from derive.errors import CheckError, ExpressionError, Location, placed, quoted
from derive.lecture.form import LectureForm
from derive.lecture.sympy_conversion import Expr, Matrix, expression_from_sympy, expression_to_sympy
from derive.robot.description import Convention
from derive.robot.expression import Expression
from derive.robot.parser import FORMULA_FUNCTIONS, parse_expression
from derive.robot.reading.document import Node, YamlMapping, YamlScalar
from derive.robot.reading.size_limits import FORMULA_LIMITS
from derive.robot.robot import Robot

# Formulas about frames have symbols and no joints.
NO_ROBOT = Robot(name="frames", title="", convention=Convention.STANDARD, joints=())
_KEYS = ("source", "printed_factors", "forms", "at", "status", "kind", "correct", "note", "ocr", "duplicate", "implied")
_TURNS = {"x": sympy.rot_ccw_axis1, "y": sympy.rot_ccw_axis2, "z": sympy.rot_ccw_axis3}  # of an angle, 3x3


def rotation(axis: str, angle: Expr) -> Matrix:
    """Rot(axis, angle), 4x4: the turn by an angle [rad] about an axis, counter-clockwise seen from its tip."""
    if axis not in _TURNS:
        raise ExpressionError(f"axis {axis!r}", allowed="allowed: x, y or z")
    return sympy.ImmutableMatrix(sympy.diag(_TURNS[axis](_scalar(angle)), 1))


def translation(x: Expr, y: Expr, z: Expr) -> Matrix:
    """Trans(x, y, z), 4x4, of displacements [m]."""
    matrix = sympy.eye(4)
    matrix[:3, 3] = sympy.Matrix([_scalar(x), _scalar(y), _scalar(z)])
    return sympy.ImmutableMatrix(matrix)


def point(x: Expr, y: Expr, z: Expr) -> Matrix:
    """The homogeneous coordinates (x, y, z, 1) of a point [m], 4x1."""
    return translation(x, y, z)[:, 3]


def compose(*frames: Matrix) -> Matrix:
    """The product of frames from left to right, exact and reduced."""
    shapes = [getattr(frame, "shape", None) for frame in frames]
    if not frames or any(shape != (4, 4) for shape in shapes[:-1]) or shapes[-1] not in ((4, 4), (4, 1)):
        allowed = "allowed: 4x4 matrices, the last one 4x4 or a point 4x1"
        raise ExpressionError(f"frames of shapes {shapes}", allowed=allowed)
    factors = [[[expression_from_sympy(entry) for entry in row] for row in frame.tolist()] for frame in frames]
    domain = PolynomialDomain(NO_ROBOT, [e for rows in factors for row in rows for e in row], rates=False)
    # multiplied in the ring modulo s^2 + c^2 = 1, not by SymPy, which reduces nothing
    product = [[domain.constant(e) for e in row] for row in factors[0]]
    for factor in factors[1:]:
        columns = list(zip(*([domain.constant(e) for e in row] for row in factor), strict=True))
        product = [[sum(map(mul, row, column), domain.ring.zero) for column in columns] for row in product]
    write = LectureForm(domain).kinematic
    return sympy.ImmutableMatrix([[write(entry) for entry in row] for row in product])


def _scalar(value: Expr) -> Expr:
    found = None
    with suppress(sympy.SympifyError):
        found = sympy.sympify(value, strict=True)
    if not isinstance(found, sympy.Expr) or found.is_Matrix:
        allowed = "allowed: a number or a SymPy expression"
        raise ExpressionError(f"value of type {type(value).__name__}", allowed=allowed)
    return expression_to_sympy(expression_from_sympy(found))


def check_frames(root: YamlMapping, source: str) -> FileReport:
    """Compare every printed product of a file with the product of its factors."""
    top = reading.mapping(root, "the file", ("items",), ("source", "notes"))
    known: dict[str, Matrix] = {}
    findings = [f for item in reading.items(top.entries["items"][1], "items") for f in _item(item, known)]
    return FileReport(source, "frames", tuple(findings), document=reading.printed_in(top))


def _item(node: Node, known: dict[str, Matrix]) -> Iterator[Finding]:
    """One product, as a whole, in its other printed forms and factor by factor; it becomes known by its id."""
    item = reading.mapping(node, "an item", ("id", "factors", "matrix"), _KEYS)
    name = reading.text_of(item, "id")
    texts = [reading.scalar(f, "a factor") for f in reading.items(item.entries["factors"][1], "factors")]
    factors = [_factor(text, known) for text in texts]
    with placed(item.location):  # rotations alone are 3x3 and stand alone; everything else is composed
        product = factors[0] if [factor.shape for factor in factors] == [(3, 3)] else compose(*factors)
    known[name] = product
    values = reading.pairs(item, "at", "a value")
    at = {sympy.Symbol(key.text): expression_to_sympy(_formula(text.text, text.inner)) for key, text in values}
    right = product.subs(at) if at else product
    corrections: dict[tuple[int, int], YamlScalar] = {}
    for key, text in reading.pairs(item, "correct", "a correction"):
        if (match := re.fullmatch(r"\s*([0-9]{1,3})\s*,\s*([0-9]{1,3})\s*", key.text)) is None:
            raise CheckError(f"place {quoted(key.text)}", allowed="allowed: row,column", location=key.location)
        corrections[int(match[1]), int(match[2])] = text
    yield from _compared(item, name, reading.child(item, "matrix"), right, corrections)
    for form in reading.items(reading.child(item, "forms"), "forms"):
        yield from _compared(item, name, form, right, corrections)
    printed = reading.items(reading.child(item, "printed_factors"), "printed_factors")
    if printed and len(printed) != len(factors):
        raise CheckError(f"{len(printed)} printed factors of {len(factors)}", location=item.location)
    for i, (rows, factor) in enumerate(zip(printed, factors, strict=False), 1):
        yield from _compared(item, f"{name} factor {i}", rows, factor, {})


def _factor(text: YamlScalar, known: Mapping[str, Matrix]) -> Matrix:
    match = re.fullmatch(r"(?s)\s*([A-Za-z0-9]+)\((.*)\)\s*", text.text)
    if match is None or match[1] not in ("Rot", "Rot3", "Trans", "Vec", "Ref"):
        allowed = "allowed: Rot(z, angle), Rot3(z, angle), Trans(x, y, z), Vec(x, y, z), Ref(id)"
        raise CheckError(f"factor {quoted(text.text)}", allowed=allowed, location=text.location)
    # formulas of frames have no commas of their own
    name, where, arguments = match[1], text.location, [argument.strip() for argument in match[2].split(",")]
    if name == "Ref":
        if arguments[0] not in known:
            allowed = "allowed: the id of an earlier item"
            raise CheckError(f"Ref to {quoted(arguments[0])}", allowed=allowed, location=where)
        return known[arguments[0]]
    turns = name.startswith("Rot")
    numbers = [expression_to_sympy(_formula(argument, where)) for argument in (arguments[1:] if turns else arguments)]
    if len(numbers) != (1 if turns else 3):
        allowed = "Rot takes 2, Trans and Vec take 3"
        raise CheckError(f"{name} with {len(arguments)} arguments", allowed=allowed, location=where)
    if not turns:
        return translation(*numbers) if name == "Trans" else point(*numbers)
    with placed(where):
        turn = rotation(arguments[0], numbers[0])
    return turn if name == "Rot" else turn[:3, :3]


def _compared(
    item: YamlMapping, name: str, matrix: Node | None, right: Matrix, corrections: Mapping[tuple[int, int], YamlScalar]
) -> Iterator[Finding]:
    """Every entry of a printed matrix, and its correction where there is one."""
    said = reading.remark(item)
    rows = reading.rows(matrix, "matrix", "a row")
    if (len(rows), *{len(row) for row in rows}) != right.shape:
        raise CheckError(f"{name}: printed in another shape", allowed=f"allowed: {right.shape}", location=item.location)
    for i, row in enumerate(rows, 1):
        for j, cell in enumerate(row, 1):
            correction, derived = corrections.get((i, j)), right[i - 1, j - 1]
            texts = [(reading.scalar(cell, "an entry"), Role.PRODUCT, correction is not None)]
            texts += [(correction, Role.CORRECTION, False)] if correction is not None else []
            for text, role, erratum in texts:
                question = Question(NO_ROBOT, _formula(text.text, text.inner), expression_from_sympy(derived))
                found = compared(question, name, (i, j), role, text.text, derived, text.inner)
                yield replace(found, erratum=erratum, remark=said)


def _formula(text: str, where: Location) -> Expression:
    return parse_expression(text, where, FORMULA_FUNCTIONS, FORMULA_LIMITS)

"""What lectures print, item by item, against what is derived."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import sympy
import yaml

from derive.checking.comparison import check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.findings import FileReport, Finding, Role
from derive.checking.formulas.printed import CorpusFile, PrintedQuantity
from derive.checking.frames_file import compose, point, rotation, translation
from derive.errors import Location
from derive.lecture.shorthand import read_formula
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.robot.description import Convention
from derive.robot.expression import ZERO, Call, Expression, add, multiply, negate, number, substitute
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from tests.places import CORPUS

ROBOT_FILES = tuple(sorted(path.name for path in CORPUS.glob("[0-9]*.yaml")))


@dataclass(frozen=True)
class Result:
    entry: str  # item and entry, for messages
    item: str  # the item it belongs to; the errata of one item count as one
    ok: bool  # whether the corpus says that the printed formula is right
    equal: bool  # whether it was found right
    corrected: bool | None = None  # whether the correction was found right; None without one
    counted: bool = True  # whether it counts

    @property
    def confirmed(self) -> bool:
        """The corpus is right about it: right as printed, or wrong as printed and right as corrected."""
        return self.equal if self.ok else not self.equal and self.corrected is True


def document(file: str) -> Any:
    """A file of the corpus as plain data."""
    return yaml.safe_load((CORPUS / file).read_text(encoding="utf-8"))


def is_counted(item: Mapping[str, Any]) -> bool:
    return not (item.get("duplicate") or item.get("implied"))


NO_ROBOT = Robot(name="frames", title="", convention=Convention.STANDARD, joints=())
FACTOR = re.compile(r"(\w+)\((.*)\)")
FRAMES = document("frames.yaml")["items"]
Matrix = Any


@cache
def frame_results(name: str) -> tuple[Result, ...]:
    """One item, every printed form and every printed factor of it."""
    (item,) = (item for item in FRAMES if item["id"] == name)
    factors = [factor(text) for text in item["factors"]]
    at = {sympy.Symbol(name): scalar(str(value)) for name, value in item.get("at", {}).items()}
    right = product(factors).subs(at)
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


def scalar(text: str) -> Any:
    return expression_to_sympy(parse_expression(text, Location("frames.yaml")))


def compared(item: Mapping[str, Any], rows: list[list[str]], right: Matrix) -> Iterator[Result]:
    assert right.shape == (len(rows), len(rows[0])), item["id"]
    correct = {tuple(map(int, place.split(","))): text for place, text in item.get("correct", {}).items()}
    for i, row in enumerate(rows):
        for j, text in enumerate(row):
            correction = correct.get((i + 1, j + 1))
            corrected = None if correction is None else is_equal(correction, right[i, j])
            entry, equal = f"{item['id']} ({i + 1},{j + 1})", is_equal(text, right[i, j])
            yield Result(entry, item["id"], correction is None, equal, corrected, is_counted(item))


def is_equal(text: str, right: Any) -> bool:
    return compare(NO_ROBOT, expression_from_sympy(right), parse_expression(text, Location("frames.yaml"))).equal


@cache
def corpus_file(file: str | Path) -> CorpusFile:
    """A file of the corpus, or of another one by its path."""
    return corpus_from_bytes((CORPUS / file).read_bytes(), str(CORPUS / file))


@cache
def report(file: str | Path) -> FileReport:
    return check_file(corpus_file(file))


@cache
def robot_results(file: str) -> tuple[Result, ...]:
    """Everything that is printed about one robot."""
    return (*_findings(file), *_inverse_kinematics(file), *_singularities(file))


def _findings(file: str) -> Iterator[Result]:
    items = {entry.location: item for item in corpus_file(file).expected for entry in item.entries}
    findings = report(file).findings
    corrections = {_key(f): f.verdict.equal for f in findings if f.role is Role.CORRECTION}
    for finding in findings:
        if finding.role is Role.PRINTED:
            yield _printed(finding, items[finding.location], corrections.get(_key(finding)))
    for finding in findings:
        if finding.role is Role.IDENTITY:
            yield Result(f"identity {finding.quantity}", "identities", not finding.erratum, finding.verdict.equal)
    product = [f.verdict.equal for f in findings if f.role is Role.FACTORISATION]
    if product:
        yield Result("factorisation", "factorisation", True, all(product))


def _key(finding: Finding) -> tuple[str, int, int]:
    return finding.quantity, finding.row, finding.column


def _printed(finding: Finding, item: PrintedQuantity, corrected: bool | None) -> Result:
    entry, counted = f"line {finding.location.line}: {finding.entry}", not (item.remark.duplicate or item.implied)
    return Result(entry, str(item.location), item.status == "ok", finding.verdict.equal, corrected, counted)


def _inverse_kinematics(file: str) -> Iterator[Result]:
    block = document(file).get("inverse_kinematics", {"formulas": []})
    robot = corpus_file(file).robot
    for formula in block["formulas"]:
        right = read_formula(formula["value"], robot)
        printed = _solves(robot, right, formula["printed"], formula["angle"])
        corrected = _solves(robot, right, formula["correct"], formula["angle"]) if "correct" in formula else None
        name = f"inverse kinematics {formula['unknown']}"
        yield Result(name, name, formula["status"] == "ok", printed, corrected=corrected)


def _solves(robot: Robot, right: Expression, text: str, is_angle: bool) -> bool:
    """Whether a formula in the entries of T is the unknown; an angle up to full turns."""
    formula = read_formula(text, robot, Location("inverse kinematics"), _pose_names(robot))
    if not is_angle:
        return compare(robot, right, formula).equal
    half = multiply(number("1/2"), add(right, negate(formula)))
    return compare(robot, ZERO, Call("sin", (half,))).equal


def _pose_names(robot: Robot) -> dict[str, Expression]:
    T = Model(robot).T
    entries = {"ox": T[0, 3], "oy": T[1, 3], "oz": T[2, 3], "r11": T[0, 0], "r12": T[0, 1]}
    names = {name: expression_from_sympy(entry) for name, entry in entries.items()}
    return {**names, "sgn": Call("sign", (read_formula("s2", robot),))}


def _singularities(file: str) -> Iterator[Result]:
    for item in document(file).get("singularities", ()):
        robot = corpus_file(file).robot
        block = Model(robot).det_J(rows=(1, 2, 3), columns=(1, 2, 3))
        determinant = expression_from_sympy(block)
        confirmed = compare(robot, determinant, read_formula(item["computed_determinant"], robot)).equal
        for variable, values in item["values"].items():
            for value in values:
                there = substitute(determinant, {variable: read_formula(str(value), robot)})
                confirmed = confirmed and compare(robot, there, ZERO).equal
        generic = not compare(robot, determinant, ZERO).equal
        yield Result(f"singularities of {item['of']}", "singularities", item["status"] == "ok", confirmed and generic)

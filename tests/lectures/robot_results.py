"""The robot files of the corpus: printed quantities, inverse kinematics and singularities."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from derive.checking.comparison import check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.findings import FileReport, Finding, Role
from derive.checking.formulas.printed import CorpusFile, PrintedQuantity
from derive.errors import Location
from derive.lecture.shorthand import read_formula
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.robot.expression import ZERO, Call, Expression, add, multiply, negate, number, substitute
from derive.robot.robot import Robot
from tests.lectures.results import CORPUS, Result, document


@cache
def corpus_file(file: str) -> CorpusFile:
    return corpus_from_bytes((CORPUS / file).read_bytes(), str(CORPUS / file))


@cache
def report(file: str) -> FileReport:
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
    return Result(
        entry=f"line {finding.location.line}: {finding.entry}",
        item=str(item.location),
        ok=item.status == "ok",
        equal=finding.verdict.equal,
        corrected=corrected,
        counted=not (item.remark.duplicate or item.implied),
    )


# -- inverse kinematics: formulas in the entries of T


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


# -- singularities


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

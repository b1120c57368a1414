"""Printed inverse kinematics: a formula in the entries of T must give back the joint variables.

The block ``inverse_kinematics:`` of corpus files, read and compared.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from derive.checking.formulas import reading
from derive.checking.formulas.diagnosis import Question
from derive.checking.formulas.findings import Finding, Role, undecidable, verdict_at
from derive.checking.formulas.printed import Printed, Solution
from derive.checking.formulas.reading import Abbreviations, read_printed, required_text
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.model.equality import evaluate
from derive.model.model import Model
from derive.robot.expression import ZERO, Call, Expression, Name, add, multiply, names, negate, number, substitute
from derive.robot.names import robot_symbols
from derive.robot.reading.document import Node, YamlMapping, YamlSequence
from derive.robot.robot import Robot

# Position and rotation of the end effector, and the printed plus-minus, in formulas of inverse kinematics.
POSE_NAMES = ("ox", "oy", "oz", *(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)), "sgn")
HALF = number("1/2")


def read_solutions(node: Node | None, robot: Robot) -> tuple[Solution, ...]:
    """The formulas of the block, whose names are entries of T."""
    if isinstance(node, YamlSequence):
        return tuple(found for block in node.items for found in read_solutions(block, robot))
    if node is None or (isinstance(node, YamlMapping) and "formulas" not in node.entries):
        return ()
    block = reading.mapping(node, "inverse_kinematics", ("formulas",), ("given", "notation", "note"))
    own = {*robot_symbols(robot), *(joint.variable for joint in robot.joints)}
    pose = Abbreviations({name: Name(name) for name in POSE_NAMES if name not in own})
    needed, optional = ("unknown", "value", "printed"), ("angle", "status", "correct", "kind", "printed_as", "note")
    found = []
    for formula in reading.items(block.entries["formulas"][1], "formulas"):
        item = reading.mapping(formula, "a formula", needed, optional)
        value = read_printed(required_text(item, "value"), robot)
        printed = read_printed(required_text(item, "printed"), robot, pose)
        correct = read_printed(required_text(item, "correct"), robot, pose) if "correct" in item.entries else None
        found.append(
            Solution(
                unknown=required_text(item, "unknown").text,
                value=value.formula,
                printed=_lacking(printed, value),
                is_angle=reading.flag(item, "angle"),
                correction=_lacking(correct, value) if correct else None,
                status=reading.status(item),
                remark=reading.remark(item),
            )
        )
    return tuple(found)


def _lacking(printed: Printed, value: Printed) -> Printed:
    """A formula about whose value nothing is known cannot be decided either."""
    return replace(printed, unknown=printed.unknown or value.unknown)


def solution_findings(model: Model, solutions: Sequence[Solution]) -> Iterator[Finding]:
    """Every formula of inverse kinematics against the variable it should give, and its correction."""
    for solution in solutions:
        yield _finding(model, solution, solution.printed, Role.SOLUTION)
        if solution.correction is not None:
            yield _finding(model, solution, solution.correction, Role.CORRECTION)


def _finding(model: Model, solution: Solution, printed: Printed, role: Role) -> Finding:
    erratum = role is Role.SOLUTION and solution.status == "erratum"
    if printed.unknown is not None:
        return undecidable(solution.unknown, (0, 0), role, printed.text, printed.unknown, erratum, solution.remark)
    definitions = _pose(model, solution, set(names(printed.formula)))
    question = Question(model.robot, printed.formula, solution.value, definitions)
    if solution.is_angle:
        # the sine of half the difference of two angles is zero where they are equal up to full turns
        question = replace(
            question,
            right=ZERO,
            compared=lambda e: Call("sin", (multiply(HALF, add(solution.value, negate(e))),)),
        )
    whole = substitute(question.compared(question.printed), definitions)
    verdict = verdict_at(printed.location, model.robot, question.right, whole)
    example = verdict.counter_example
    if example is not None and solution.is_angle:  # it shows the angles, not the sine of half their difference
        point: dict[str, Fraction] = dict(example.values)
        angle, found = evaluate(solution.value, point), evaluate(substitute(printed.formula, definitions), point)
        if angle is not None and found is not None:
            example = replace(example, printed=float(found), right=float(angle))
            verdict = replace(verdict, counter_example=example)
    right = solution.correction.text if solution.correction else expression_to_sympy(solution.value)
    where = printed.location
    return Finding(
        solution.unknown, 0, 0, role, printed.text, verdict, right, where, erratum, question, remark=solution.remark
    )


def _pose(model: Model, solution: Solution, used: set[str]) -> Mapping[str, Expression]:
    """The entries of T; sgn, the printed plus-minus, is the sign of the unknown, of its sine where it is an angle."""
    own = {*(str(symbol) for symbol in model.T.free_symbols)}
    found: dict[str, Expression] = {}
    for name in POSE_NAMES:
        if name == "sgn" or (name in own and name not in used):
            continue
        row, column = ("xyz".index(name[1]), 3) if name[0] == "o" else (int(name[1]) - 1, int(name[2]) - 1)
        found[name] = expression_from_sympy(model.T[row, column])
    signed = Call("sin", (solution.value,)) if solution.is_angle else solution.value
    return {**found, "sgn": Call("sign", (signed,))}

"""Printed inverse kinematics: a formula in the entries of T must give back the joint variables.

The block ``inverse_kinematics:`` of corpus files.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from derive.algebra.from_sympy import expression_from_sympy
from derive.check import reading
from derive.check.diagnosis import Question
from derive.check.findings import Finding, Role, undecidable
from derive.check.printed import Printed, Solution
from derive.check.reading import NO_NAMES, Vocabulary, read_printed, remark
from derive.errors import DeriveError
from derive.lecture.to_sympy import expression_to_sympy
from derive.model.equality import Verdict, compare, evaluate
from derive.model.model import Model
from derive.robot import document
from derive.robot.document import Node
from derive.robot.expression import ZERO, Call, Expression, Name, add, multiply, names, negate, number, substitute
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

POSE_NAMES = ("ox", "oy", "oz", *(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)), "sgn")
"""Position and rotation of the end effector, and the printed plus-minus, in formulas of inverse kinematics."""


class SolutionReader:
    """Reads formulas whose names are entries of T.

    Args:
        robot: A name of its own hides the pose's.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        own = {*robot_symbols(robot), *(joint.variable for joint in robot.joints)}
        self.pose = Vocabulary({name: Name(name) for name in POSE_NAMES if name not in own})

    def solutions(self, node: Node | None) -> tuple[Solution, ...]:
        """The formulas of the block.

        Raises:
            CheckError: A formula, or the structure around it, cannot be read.
        """
        if node is None:
            return ()
        block = reading.mapping(node, "inverse_kinematics", ("formulas",), ("given", "notation", "note"))
        return tuple(self._solution(item) for item in reading.items(block.entries["formulas"][1], "formulas"))

    def _solution(self, node: Node) -> Solution:
        needed = ("unknown", "value", "printed")
        item = reading.mapping(node, "a formula", needed, ("angle", "status", "correct", "kind", "printed_as", "note"))
        correct = reading.child(item, "correct")
        value = self._printed(item, "value", NO_NAMES)
        return Solution(
            unknown=reading.scalar(item.entries["unknown"][1], "unknown").text,
            value=value.formula,
            printed=_lacking(self._printed(item, "printed", self.pose), value),
            is_angle=reading.flag(item, "angle"),
            correction=_lacking(self._printed(item, "correct", self.pose), value) if correct else None,
            status=reading.word(item, "status", ("ok", "erratum"), "ok"),
            remark=remark(item),
        )

    def _printed(self, item: document.YamlMapping, key: str, further: Vocabulary) -> Printed:
        return read_printed(reading.scalar(item.entries[key][1], key), self.robot, further)


def _lacking(printed: Printed, value: Printed) -> Printed:
    """A formula about whose value nothing is known cannot be decided either."""
    return replace(printed, unknown=printed.unknown or value.unknown)


HALF = number("1/2")


def solution_findings(model: Model, solutions: Sequence[Solution]) -> Iterator[Finding]:
    """Every formula of inverse kinematics against the variable it should give, and its correction.

    Args:
        model: The robot's model.
        solutions: The printed formulas.

    Raises:
        CheckError: A formula that divides by zero.
    """
    for solution in solutions:
        yield _finding(model, solution, solution.printed, Role.SOLUTION)
        if solution.correction is not None:
            yield _finding(model, solution, solution.correction, Role.CORRECTION)


def _finding(model: Model, solution: Solution, printed: Printed, role: Role) -> Finding:
    erratum = role is Role.SOLUTION and solution.status == "erratum"
    if printed.unknown is not None:
        return undecidable(solution.unknown, (0, 0), role, printed.text, printed.unknown, erratum, solution.remark)
    question = _question(model, solution, printed.formula)
    whole = substitute(question.compared(question.printed), dict(question.definitions))
    try:
        verdict = compare(model.robot, question.right, whole)
    except DeriveError as error:
        raise error.at(printed.location) from None
    right = solution.correction.text if solution.correction else expression_to_sympy(solution.value)
    verdict = _with_values(verdict, question, solution.value)
    where = printed.location
    return Finding(
        solution.unknown, 0, 0, role, printed.text, verdict, right, where, erratum, question, remark=solution.remark
    )


def _question(model: Model, solution: Solution, formula: Expression) -> Question:
    """Angles are compared up to full turns: the sine of half the difference is zero."""
    definitions = _pose(model, solution, set(names(formula)))
    if not solution.is_angle:
        return Question(model.robot, formula, solution.value, definitions)
    return Question(model.robot, formula, ZERO, definitions, _turned_from(solution.value))


def _turned_from(value: Expression) -> Callable[[Expression], Expression]:
    return lambda printed: Call("sin", (multiply(HALF, add(value, negate(printed))),))


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


def _with_values(verdict: Verdict, question: Question, value: Expression) -> Verdict:
    """The counter-example of an angle shows the angles, not the sine of half their difference."""
    example = verdict.counter_example
    if example is None or question.is_plain:
        return verdict
    point: dict[str, Fraction] = dict(example.values)
    right = evaluate(value, point)
    printed = evaluate(substitute(question.printed, dict(question.definitions)), point)
    if right is None or printed is None:
        return verdict
    return replace(verdict, counter_example=replace(example, printed=float(printed), right=float(right)))

"""The block ``inverse_kinematics:`` of corpus files: formulas for single unknowns, and whole solutions.

A formula for one unknown stands in the entries of T and must give back the joint variables; it is compared here. Whole
solutions, as lines or as LaTeX, are only read; `check` compares them.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from derive.checking.formulas import reading
from derive.checking.formulas.diagnosis import Question
from derive.checking.formulas.findings import Finding, Role, undecidable, verdict_at
from derive.checking.formulas.printed import Asked, InverseText, Printed, Solution
from derive.checking.formulas.reading import Abbreviations, read_printed, required_text
from derive.errors import CheckError, DeriveError
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.model.equality import evaluate
from derive.model.model import Model
from derive.robot.expression import ZERO, Call, Expression, Name, add, multiply, names, negate, number, substitute
from derive.robot.names import own_names
from derive.robot.options.inverse import Task, chosen_task
from derive.robot.reading.document import Node, YamlMapping, YamlSequence
from derive.robot.robot import Robot

# Position and rotation of the end effector, and the printed plus-minus, in formulas of inverse kinematics.
POSE_NAMES = ("ox", "oy", "oz", *(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)), "sgn")
_FORMULA = ("angle", "status", "correct", "kind", "printed_as", "note")
_SOLUTION = ("task", "atan2", "status", "given", "notation", "note", "kind", "printed_as", "source")


def read_block(node: Node | None, robot: Robot, lines: Sequence[str]) -> tuple[list[Solution], list[InverseText]]:
    """The formulas and the solutions of the block, which may be a list of several."""
    blocks = node.items if isinstance(node, YamlSequence) else [node] if node is not None else []
    formulas: list[Solution] = []
    texts: list[InverseText] = []
    for block in blocks:
        if isinstance(block, YamlMapping) and "formulas" in block.entries:
            formulas += _formulas(block, robot)
        else:
            texts.append(_solution(block, lines))
    return formulas, texts


def _formulas(node: Node, robot: Robot) -> Iterator[Solution]:
    """Formulas for single unknowns, whose names are entries of T."""
    block = reading.mapping(node, "inverse_kinematics", ("formulas",), ("given", "notation", "note"))
    own = own_names(robot)
    pose = Abbreviations({name: Name(name) for name in POSE_NAMES if name not in own})
    for formula in reading.items(block.entries["formulas"][1], "formulas"):
        item = reading.mapping(formula, "a formula", ("unknown", "value", "printed"), _FORMULA)
        value = read_printed(required_text(item, "value"), robot)
        printed = read_printed(required_text(item, "printed"), robot, pose)
        correct = read_printed(required_text(item, "correct"), robot, pose) if "correct" in item.entries else None
        yield Solution(
            unknown=required_text(item, "unknown").text,
            value=value.formula,
            # a formula about whose value nothing is known cannot be decided either
            printed=replace(printed, unknown=printed.unknown or value.unknown),
            is_angle=reading.flag(item, "angle"),
            correction=replace(correct, unknown=correct.unknown or value.unknown) if correct else None,
            status=reading.status(item),
            remark=reading.remark(item),
        )


def _solution(node: Node, lines: Sequence[str]) -> InverseText:
    item = reading.mapping(node, "inverse_kinematics", (), ("lines", "latex", *_SOLUTION))
    if ("lines" in item.entries) is ("latex" in item.entries):
        found = "inverse_kinematics needs either 'lines', 'latex' or 'formulas'"
        remedy = 'write lines: ["theta2 = atan2(+-sqrt(1 - D**2), D)", ...]'
        raise CheckError(found, remedy=remedy, location=item.location)
    content = item.entries["lines" if "lines" in item.entries else "latex"][1]
    texts = content.items if isinstance(content, YamlSequence) else [content]
    parts = tuple(reading.printed_text(reading.scalar(text, "a line"), lines) for text in texts)
    order = reading.word(item, "atan2", ("yx", "xy"), "")  # of its arguments: the sine first, or the cosine
    asked = Asked(item.location, _task(item), order == "xy" if order else None)
    return InverseText(parts, asked, "latex" in item.entries, False, reading.status(item), reading.remark(item))


def _task(item: YamlMapping) -> Task | None:
    node = reading.child(item, "task")
    if node is None:
        return None
    if isinstance(node, YamlSequence):
        words = [reading.scalar(word, "a row of the task").text for word in node.items]
    else:
        words = reading.scalar(node, "task").text.replace(",", " ").split()
    try:
        return chosen_task(words, 6)
    except DeriveError as error:
        raise CheckError(error.found, allowed=error.allowed, remedy=error.remedy, location=node.location) from None


def solution_findings(model: Model, solutions: Sequence[Solution]) -> Iterator[Finding]:
    """Every formula of inverse kinematics against the variable it should give, and its correction."""
    for solution in solutions:
        found = _finding(model, solution, solution.printed, Role.SOLUTION)
        yield replace(found, erratum=solution.status == "erratum", remark=solution.remark)
        if solution.correction is not None:
            yield replace(_finding(model, solution, solution.correction, Role.CORRECTION), remark=solution.remark)


def _finding(model: Model, solution: Solution, printed: Printed, role: Role) -> Finding:
    if printed.unknown is not None:
        return undecidable(solution.unknown, (0, 0), role, printed.text, printed.unknown)
    definitions = _pose(model, solution, set(names(printed.formula)))
    question = Question(model.robot, printed.formula, solution.value, definitions)

    def half_sine(e: Expression) -> Expression:
        # the sine of half the difference of two angles is zero where they are equal up to full turns
        return Call("sin", (multiply(number("1/2"), add(solution.value, negate(e))),))

    if solution.is_angle:
        question = replace(question, right=ZERO, compared=half_sine)
    whole = substitute(half_sine(printed.formula) if solution.is_angle else printed.formula, definitions)
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
    return Finding(solution.unknown, 0, 0, role, printed.text, verdict, right, where, question=question)


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

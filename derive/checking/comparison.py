"""Printed formulas against derived ones, entry by entry, and of several robots the one that each is about."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from itertools import pairwise, product

import sympy

from derive.checking.formulas.diagnosis import Question, other_orders
from derive.checking.formulas.findings import FileReport, Finding, Role, Skipped, compared, undecidable, verdict_at
from derive.checking.formulas.printed import CorpusFile, Factorisation, Printed, PrintedQuantity, PrintedText, Solution
from derive.checking.inverse.check import check_inverse
from derive.checking.latex.check import LatexReport, check_latex
from derive.errors import CheckError, DeriveError, Location, UnknownNameError, placed
from derive.lecture.shorthand import read_formula
from derive.lecture.sympy_conversion import Matrix, expression_from_sympy, expression_to_sympy
from derive.model.equality import compare, evaluate, passive_positions, scalar_quantity
from derive.model.model import Model
from derive.model.quantity_names import of_one_end
from derive.robot.expression import ZERO, Call, Expression, add, multiply, names, negate, number, substitute

# Position and rotation of the end effector, and the printed plus-minus, in formulas of inverse kinematics.
POSE_NAMES = ("ox", "oy", "oz", *(f"r{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)), "sgn")


def check_file(file: CorpusFile) -> FileReport:
    """Compare everything that a corpus file prints."""
    model = Model(file.robot)
    findings: list[Finding] = []
    for item in file.expected:
        with placed(item.location):
            of_item = list(_quantity(model, item))
        # the status of an item is that of what is printed, not of its corrections
        is_erratum, not_printed = item.status == "erratum", (Role.CORRECTION, Role.REST)
        findings += (replace(f, erratum=is_erratum and f.role not in not_printed, remark=item.remark) for f in of_item)
    for identity in file.identities:
        left, right = identity.left, identity.right
        if unknown := left.unknown or right.unknown:
            found = undecidable(left.text, (0, 0), Role.IDENTITY, right.text, unknown)
        else:
            question = Question(model.robot, right.formula, left.formula)
            found = compared(question, left.text, (0, 0), Role.IDENTITY, right.text, left.text, right.location)
        findings.append(replace(found, erratum=identity.status == "erratum"))
    if file.factorisation is not None:
        with placed(file.factorisation.location):
            findings += _factorisation(model, file.factorisation)
    findings += solution_findings(model, file.solutions)
    for text in file.inverse:
        try:
            findings += check_inverse(model, text)[0]
        except UnknownNameError as error:
            whole = " ".join(" ".join(part.text.split()) for part in text.parts)
            found = undecidable("inverse", (0, 0), Role.SOLUTION, whole, error)
            findings.append(replace(found, erratum=text.status == "erratum", remark=text.remark))
    return FileReport(file.source, file.robot.name, tuple(findings), file.unread, file.document)


def check_expression(model: Model, quantity: str, text: str) -> Finding:
    """Compare one formula with a scalar quantity."""
    start = Location("--expression")
    formula = read_formula(text, model.robot, start)
    right = scalar_quantity(model, quantity)
    question = Question(model.robot, formula, expression_from_sympy(right), others=other_orders(model, quantity))
    return compared(question, quantity, (0, 0), Role.PRINTED, text, right, start)


def derived_matrix(model: Model, item: PrintedQuantity) -> Matrix:
    """The derived quantity that belongs to a printed item."""
    name = of_one_end(model, item.quantity)
    value = passive_positions(model) if name == "closure" else model.quantity(name)
    if item.shape == (1, 1) and getattr(value, "shape", (1, 1)) != (1, 1):
        value = scalar_quantity(model, item.quantity)
    return value if hasattr(value, "shape") else sympy.ImmutableMatrix([[value]])


def _latex(model: Model, item: PrintedQuantity, text: PrintedText) -> Iterator[Finding]:
    """The findings of an item in LaTeX; where offsets are not exact all of them stand at its beginning."""
    try:
        found = check_latex(model, text.text, item.quantity, text.location).findings
    except UnknownNameError as error:
        yield undecidable(item.quantity, (0, 0), Role.PRINTED, " ".join(text.text.split()), error)
        return
    except DeriveError as error:
        raise error if text.verbatim else error.moved(None) from None
    yield from found if text.verbatim else (replace(finding, location=text.location) for finding in found)


def _quantity(model: Model, item: PrintedQuantity) -> Iterator[Finding]:
    if item.latex is not None:
        yield from _latex(model, item, item.latex)
        if not item.corrections:
            return
    right = derived_matrix(model, item)
    if item.shape is not None and item.shape != right.shape:
        printed, allowed = ("{} rows and {} columns".format(*shape) for shape in (item.shape, right.shape))
        raise CheckError(f"{item.quantity}: printed with {printed}", allowed=f"allowed: {allowed}")
    places = set(product(range(1, right.shape[0] + 1), range(1, right.shape[1] + 1)) if item.rest_zero else ())
    rest = sorted(places - {(entry.row, entry.column) for entry in item.entries})
    zeros = [Printed(i, j, "0", number(0), item.location) for i, j in rest]
    entries = {Role.PRINTED: item.entries, Role.ABBREVIATED: item.abbreviated, Role.CORRECTION: item.corrections}
    for role, of_role in (*entries.items(), (Role.REST, zeros)):
        yield from (_entry(model, item, right, entry, role) for entry in of_role)


def _entry(model: Model, item: PrintedQuantity, right: Matrix, entry: Printed, role: Role) -> Finding:
    rows, columns = right.shape
    if entry.row > rows or entry.column > columns:
        found, allowed = f"entry {entry.row},{entry.column}", f"allowed: rows 1 to {rows}, columns 1 to {columns}"
        raise CheckError(f"{item.quantity}: {found}", allowed=allowed, location=entry.location)
    row = 0 if (rows, columns) == (1, 1) else entry.row
    column = 0 if columns == 1 else entry.column
    if entry.unknown is not None:
        return undecidable(item.quantity, (row, column), role, entry.text, entry.unknown)
    derived = right[entry.row - 1, entry.column - 1]
    others = other_orders(model, item.quantity)
    question = Question(model.robot, entry.formula, expression_from_sympy(derived), others=others)
    return compared(question, item.quantity, (row, column), role, entry.text, derived, entry.location)


def _factorisation(model: Model, item: Factorisation) -> Iterator[Finding]:
    whole, factors = model.quantity(item.of), [model.quantity(name) for name in item.factors]
    shapes = [getattr(factor, "shape", (0, 0)) for factor in factors]
    fits = all(a[1] == b[0] for a, b in pairwise(shapes))
    if not fits or (shapes[0][0], shapes[-1][1]) != getattr(whole, "shape", None):
        raise CheckError(f"factorisation of {item.of}: shapes {shapes} do not fit", remedy="check the names")
    multiplied = reduce(lambda a, b: a * b, (sympy.Matrix(factor) for factor in factors))
    text = "*".join(item.factors)
    for i, j in product(range(whole.shape[0]), range(whole.shape[1])):
        verdict = compare(model.robot, expression_from_sympy(whole[i, j]), expression_from_sympy(multiplied[i, j]))
        yield Finding(item.of, i + 1, j + 1, Role.FACTORISATION, text, verdict, whole[i, j], item.location)


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
    return Finding(solution.unknown, 0, 0, role, printed.text, verdict, right, printed.location, question=question)


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


def divided(names: Sequence[str], reports: Sequence[LatexReport], sections: Sequence[int]) -> Iterator[LatexReport]:
    """Of the reports on one document, one for each robot, the parts about it; by the section of each equation."""
    rows = list(zip(*map(_by_equation, reports), strict=True))
    verdicts = [[[finding.verdict.equal for finding in part.findings] for part in row] for row in rows]
    right = [[robot for robot, equal in enumerate(row) if equal and all(equal)] for row in verdicts]
    sure = {index: robots[0] for index, robots in enumerate(right) if len(robots) == 1}
    said = [_said(names, row, right[index], _beside(index, sure, sections)) for index, row in enumerate(rows)]
    for index, report in enumerate(reports):
        own = [part for robot, part in said if robot == index]
        findings = tuple(finding for part in own for finding in part.findings)
        yield replace(report, findings=findings, skipped=tuple(one for part in own for one in part.skipped))


def _said(
    names: Sequence[str], row: Sequence[LatexReport], right: Sequence[int], beside: Sequence[int]
) -> tuple[int, LatexReport]:
    """The robot that an equation is about, and what is said of it; beside are the robots before and behind it."""
    compared = [robot for robot, part in enumerate(row) if part.findings]
    around = [robot for robot in dict.fromkeys(beside) if robot in compared]
    if len(right) == 1 and len(beside) == 2 and len(around) == len(set(beside)) == 1 and around != list(right):
        reason = f"right for {names[right[0]]} and wrong for {names[around[0]]}, whose formulas stand around it"
        return around[0], _not_compared(row[around[0]], reason)
    if right:
        robot = next((robot for robot in beside if robot in right), right[0])
        return robot, row[robot]
    likely = compared if len(compared) == 1 else around if len(around) == len(set(beside)) else []
    if len(likely) == 1:
        return likely[0], row[likely[0]]
    if compared:
        reason = f"wrong for {' and for '.join(names[robot] for robot in compared)}; which is meant is not certain"
        return compared[0], _not_compared(row[compared[0]], reason)
    told = [robot for robot, part in enumerate(row) if part.skipped]
    robot = next((robot for robot in (*beside, *told) if robot in told), 0)
    return robot, row[robot]


def _by_equation(report: LatexReport) -> Iterator[LatexReport]:
    begins = [(place.line, place.column) for place in report.equations]
    for begin, end in pairwise([*begins, (10**9, 0)]):
        findings = tuple(f for f in report.findings if begin <= (f.location.line, f.location.column) < end)
        skipped = tuple(s for s in report.skipped if begin <= (s.location.line, s.location.column) < end)
        yield replace(report, findings=findings, skipped=skipped)


def _beside(index: int, sure: Mapping[int, int], sections: Sequence[int]) -> list[int]:
    """The robots of the nearest equations before and behind, of those in the same section where it has any."""
    others = {at: robot for at, robot in sure.items() if at != index}
    here = {at: robot for at, robot in others.items() if sections[at] == sections[index]} or others
    before = max((at for at in here if at < index), default=None)
    behind = min((at for at in here if at > index), default=None)
    return [here[at] for at in (before, behind) if at is not None]


def _not_compared(part: LatexReport, reason: str) -> LatexReport:
    first = part.findings[0]
    return replace(part, findings=(), skipped=(Skipped(first.location, reason, first.text), *part.skipped))

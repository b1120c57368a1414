"""What `derive check` understands, as it is reported: a file, a formula, or a document about one or several robots.

Corpus files have a block ``robot:`` and the list ``expected:`` of what some notes print; every formula has its place.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from derive.checking.comparison import POSE_NAMES, check_expression, check_file, divided
from derive.checking.documents import KINDS, Manuscript, document_of, is_document, read_document
from derive.checking.formulas import printed, reading
from derive.checking.formulas.findings import FileReport
from derive.checking.formulas.reading import NO_ABBREVIATIONS, Abbreviations, read_printed, required_text
from derive.checking.frames_file import NO_ROBOT, check_frames
from derive.checking.inverse.check import check_inverse, names_inverse
from derive.checking.inverse.reading import gives_joints
from derive.checking.latex.check import LatexReport, check_latex
from derive.checking.methods_file import SETS, check_methods
from derive.checking.report import Printout, all_lines, summary
from derive.errors import CheckError, DeriveError, Location, quoted
from derive.inverse.loops import without_parallelograms
from derive.model.model import Model
from derive.robot.expression import Name
from derive.robot.load import file_bytes, is_there
from derive.robot.names import own_names
from derive.robot.options.inverse import Task, chosen_task
from derive.robot.reading.document import Node, YamlMapping, YamlScalar, YamlSequence, read_tree
from derive.robot.robot import Robot

UNREAD = ("singularities", "trajectory")  # blocks with printed results of a kind that is not compared here
_BLOCKS = ("expected", "identities", "factorisation", "inverse_kinematics", *UNREAD)
_CONTENT = (
    "quantity", "latex", "matrix", "entries", "rest", "status", "kind", "correct", "abbreviations", "abbreviated",
)  # fmt: skip
_REMARKS = ("printed_as", "note", "duplicate", "implied")
_FORMULA = ("angle", "status", "correct", "kind", "printed_as", "note")
_SOLUTION = ("task", "atan2", "status", "given", "notation", "note", "kind", "printed_as", "source")


def file_printout(path: str | Path) -> Printout:
    """The comparison of everything that a file prints."""
    source, data = str(path) if str(path).isprintable() else quoted(str(path), 200), file_bytes(Path(path))
    root = read_tree(data, source)
    if isinstance(root, YamlMapping) and "robot" not in root.entries:
        if "items" in root.entries:
            return Printout(check_frames(root, source), NO_ROBOT)
        if any(name in root.entries for name in SETS):
            return Printout(check_methods(root, source), NO_ROBOT)
    file = corpus_from_bytes(data, source)
    return Printout(check_file(file), file.robot)


def corpus_from_bytes(data: bytes, source: str) -> printed.CorpusFile:
    """Read a robot and the formulas printed about it."""
    robot = without_parallelograms(Robot.from_bytes(data, source))
    node = read_tree(data, source)
    if not isinstance(node, YamlMapping) or "robot" not in node.entries:
        found = "no block 'robot:' beside the printed formulas"
        allowed = "allowed: robot: with the DH table, expected: with what is printed"
        remedy = "indent the robot under 'robot:' and add 'expected:'"
        raise CheckError(found, allowed=allowed, remedy=remedy, location=Location(source))
    root = reading.mapping(node, "the file", ("robot",), ("source", "notes", "ocr", "figure_configuration", *_BLOCKS))
    items = reading.items(reading.child(root, "expected"), "expected")
    identities = reading.items(reading.child(root, "identities"), "identities")
    product = reading.child(root, "factorisation")
    lines = data.decode("utf-8-sig").splitlines()
    solutions, inverse = read_block(reading.child(root, "inverse_kinematics"), robot, lines)
    equal = [reading.mapping(item, "an identity", ("left", "right"), ("status", *_REMARKS)) for item in identities]
    left, right = ([read_printed(required_text(item, side), robot) for item in equal] for side in ("left", "right"))
    expected = tuple(_quantity(item, robot, lines) for item in items)
    identical = tuple(map(printed.Identity, left, right, map(reading.status, equal)))
    factorisation = _factorisation(product) if product else None
    unread, cited = tuple(name for name in UNREAD if name in root.entries), reading.printed_in(root)
    forward = printed.CorpusFile(source, robot, expected, identical, factorisation, unread, document=cited)
    return replace(forward, solutions=tuple(solutions), inverse=tuple(inverse))


def _quantity(node: Node, robot: Robot, lines: Sequence[str]) -> printed.PrintedQuantity:
    latex = isinstance(node, YamlMapping) and "latex" in node.entries
    item = reading.mapping(node, "an item of expected", () if latex else ("quantity",), (*_CONTENT, *_REMARKS))
    name = required_text(item, "quantity").text if "quantity" in item.entries else ""
    in_latex = reading.printed_text(required_text(item, "latex"), lines) if latex else None
    entries, shape = _content(item, robot)
    corrections = tuple(_at_places(reading.pairs(item, "correct", "an entry"), "correct", robot))
    if corrections and not name:
        raise CheckError("corrections without a quantity", remedy="add quantity:", location=item.location)
    for correction in corrections if in_latex is None else ():
        if (correction.row, correction.column) not in {(entry.row, entry.column) for entry in entries}:
            found = f"correction of {correction.row},{correction.column}, which is not among the printed entries"
            raise CheckError(found, remedy="print the wrong entry too", location=correction.location)
    abbreviated: tuple[printed.Printed, ...] = ()
    if "abbreviated" in item.entries:  # the entries as they are printed with the abbreviations of the notes
        short = NO_ABBREVIATIONS
        for key, text in reading.pairs(item, "abbreviations", "an abbreviation"):
            short = short.defining(key.text, read_printed(text, robot, short))
        rows = reading.rows(item.entries["abbreviated"][1], "abbreviated", "a row of 'abbreviated'")
        abbreviated = tuple(_matrix_entries(rows, robot, short))
    rest_zero = reading.word(item, "rest", ("zero",), "") == "zero"
    plain = printed.PrintedQuantity(name, item.location, entries, shape, abbreviated, corrections, rest_zero)
    status, said = reading.status(item), reading.remark(item)
    return replace(plain, status=status, remark=said, implied=reading.flag(item, "implied"), latex=in_latex)


def _content(item: YamlMapping, robot: Robot) -> tuple[tuple[printed.Printed, ...], tuple[int, int] | None]:
    """The printed entries, and rows and columns where the whole matrix is printed."""
    matrix = reading.child(item, "matrix")
    if len([key for key in ("matrix", "entries", "latex") if key in item.entries]) != 1:
        found = "an item of expected needs either 'matrix' or 'entries' or 'latex'"
        remedy = 'write matrix: [["..."]] for all entries, or entries: {"1,4": "..."} for some, or latex: "..."'
        raise CheckError(found, remedy=remedy, location=item.location)
    if "latex" in item.entries:
        return (), None
    if matrix is None:
        return tuple(_at_places(reading.pairs(item, "entries", "an entry"), "entries", robot)), None
    rows = reading.rows(matrix, "matrix", "a row of the matrix")
    if not rows or not rows[0] or len({len(row) for row in rows}) > 1:
        remedy = 'write rows of equal length, a scalar as [["..."]]'
        raise CheckError("matrix whose rows differ in length or are empty", remedy=remedy, location=matrix.location)
    return tuple(_matrix_entries(rows, robot, NO_ABBREVIATIONS)), (len(rows), len(rows[0]))


def _matrix_entries(rows: list[list[Node]], robot: Robot, short: Abbreviations) -> Iterator[printed.Printed]:
    cells = ((i, j, reading.scalar(x, "an entry")) for i, row in enumerate(rows, 1) for j, x in enumerate(row, 1))
    yield from (read_printed(cell, robot, short, (i, j)) for i, j, cell in cells)


def _at_places(pairs: Iterable[tuple[YamlScalar, YamlScalar]], what: str, robot: Robot) -> Iterator[printed.Printed]:
    """Formulas under keys such as ``1,4``, or ``3`` for a vector."""
    seen: set[tuple[int, int]] = set()
    for key, text in pairs:
        match = re.fullmatch(r"\s*([0-9]{1,3})\s*(?:,\s*([0-9]{1,3})\s*)?", key.text)
        place = (int(match[1]), int(match[2] or 1)) if match else (0, 0)
        if 0 in place or place in seen:
            found = f"{what}: place {quoted(key.text)}" + (" twice" if place in seen else "")
            allowed = 'allowed: row,column from 1, such as "1,4"; "3" in a vector'
            raise CheckError(found, allowed=allowed, location=key.location)
        seen.add(place)
        yield read_printed(text, robot, place=place)


def _factorisation(node: Node) -> printed.Factorisation:
    item = reading.mapping(node, "factorisation", ("of", "factors"), _REMARKS)
    if not (factors := reading.items(item.entries["factors"][1], "factors")):
        raise CheckError("factorisation without factors", remedy="name two or more", location=item.location)
    names = tuple(reading.scalar(factor, "a factor").text for factor in factors)
    return printed.Factorisation(required_text(item, "of").text, names, item.location)


def read_block(
    node: Node | None, robot: Robot, lines: Sequence[str]
) -> tuple[list[printed.Solution], list[printed.InverseText]]:
    """The formulas and the solutions of the block, which may be a list of several."""
    blocks = node.items if isinstance(node, YamlSequence) else [node] if node is not None else []
    formulas, texts = list[printed.Solution](), list[printed.InverseText]()
    for block in blocks:
        if isinstance(block, YamlMapping) and "formulas" in block.entries:
            formulas += _formulas(block, robot)
        else:
            texts.append(_solution(block, lines))
    return formulas, texts


def _formulas(node: Node, robot: Robot) -> Iterator[printed.Solution]:
    """Formulas for single unknowns, whose names are entries of T."""
    block = reading.mapping(node, "inverse_kinematics", ("formulas",), ("given", "notation", "note"))
    own = own_names(robot)
    pose = Abbreviations({name: Name(name) for name in POSE_NAMES if name not in own})
    for formula in reading.items(block.entries["formulas"][1], "formulas"):
        item = reading.mapping(formula, "a formula", ("unknown", "value", "printed"), _FORMULA)
        value = read_printed(required_text(item, "value"), robot)
        found = read_printed(required_text(item, "printed"), robot, pose)
        correct = read_printed(required_text(item, "correct"), robot, pose) if "correct" in item.entries else None
        # a formula about whose value nothing is known cannot be decided either
        found = replace(found, unknown=found.unknown or value.unknown)
        correct = correct and replace(correct, unknown=correct.unknown or value.unknown)
        name, is_angle = required_text(item, "unknown").text, reading.flag(item, "angle")
        status, said = reading.status(item), reading.remark(item)
        yield printed.Solution(name, value.formula, found, is_angle, correct, status, said)


def _solution(node: Node, lines: Sequence[str]) -> printed.InverseText:
    item = reading.mapping(node, "inverse_kinematics", (), ("lines", "latex", *_SOLUTION))
    if ("lines" in item.entries) is ("latex" in item.entries):
        found = "inverse_kinematics needs either 'lines', 'latex' or 'formulas'"
        remedy = 'write lines: ["theta2 = atan2(+-sqrt(1 - D**2), D)", ...]'
        raise CheckError(found, remedy=remedy, location=item.location)
    content = item.entries["lines" if "lines" in item.entries else "latex"][1]
    texts = content.items if isinstance(content, YamlSequence) else [content]
    parts = tuple(reading.printed_text(reading.scalar(text, "a line"), lines) for text in texts)
    order = reading.word(item, "atan2", ("yx", "xy"), "")  # of its arguments: the sine first, or the cosine
    plain = printed.InverseText(parts, item.location, _task(item), order == "xy" if order else None)
    said, is_latex = reading.remark(item), "latex" in item.entries
    return replace(plain, latex=is_latex, status=reading.status(item), remark=said)


def _task(item: YamlMapping) -> Task | None:
    if (node := reading.child(item, "task")) is None:
        return None
    if isinstance(node, YamlSequence):
        words = [reading.scalar(word, "a row of the task").text for word in node.items]
    else:
        words = reading.scalar(node, "task").text.replace(",", " ").split()
    try:
        return chosen_task(words, 6)
    except DeriveError as error:
        raise CheckError(error.found, allowed=error.allowed, remedy=error.remedy, location=node.location) from None


def formula_printout(
    robot: Robot, quantity: str, formula: str | Manuscript, *, latex: bool = False, task: str = ""
) -> Printout:
    """The comparison of a formula or document with one robot; of LaTeX the quantity may be a matrix, or none."""
    model, document = Model(robot), formula if isinstance(formula, Manuscript) else None
    robot = model.robot  # whose parallelograms are coupled joints
    if latex or names_inverse(model, quantity):
        source = document.name if document else "--latex" if latex else "--expression"
        report = _compared(model, formula, source, quantity, task, latex=latex, alone=document is not None)
    else:
        source, report = robot.name, LatexReport((check_expression(model, quantity, str(formula)),))
    return Printout(_placed(report, document, robot, source), robot)


def document_printouts(robots: Sequence[Robot], document: Manuscript) -> list[Printout]:
    """The comparisons of a document about several robots: for each of them, in their order, the formulas about it."""
    names, found = [robot.name for robot in robots], []
    if len(set(names)) < len(names):
        raise CheckError(f"two robots are called {quoted(max(names, key=names.count))}", remedy="change one name")
    refused = None
    for robot in robots:
        try:
            found.append((robot, _compared(Model(robot), document, document.name, "", "", alone=False)))
        except CheckError as error:
            refused = error
    if refused is not None and not found:
        raise refused
    sections = [document.section_at(place) for place in found[0][1].equations]
    parts = divided([robot.name for robot, _ in found], [report for _, report in found], sections)
    pairs = ((robot, part) for (robot, _), part in zip(found, parts, strict=True))
    return [Printout(_placed(part, document, r, f"{document.name} ({r.name})"), r) for r, part in pairs]


def _compared(
    model: Model, formula: str | Manuscript, source: str, quantity: str, task: str, *, latex: bool = True, alone: bool
) -> LatexReport:
    """The comparison of LaTeX, or of a solution of the inverse kinematics."""
    document, where = formula if isinstance(formula, Manuscript) else None, Location(source)
    text, robot = document.text if document else str(formula), model.robot
    is_solution = not (document or quantity or robot.is_tree) and gives_joints(text, robot)
    try:
        if not (is_solution or names_inverse(model, quantity)):
            return check_latex(model, text, quantity, where, document=document is not None, alone=alone)
        rows = chosen_task(task.replace(",", " ").split(), model.n) if task else None
        parts = (printed.PrintedText(text, where),)
        solution = printed.InverseText(parts, where, rows, latex=latex, document=document is not None)
        return LatexReport(*check_inverse(model, solution))
    except CheckError as error:
        raise (document.moved(error) if document else error) from None


def _placed(report: LatexReport, document: Manuscript | None, robot: Robot, source: str) -> FileReport:
    """Comparisons as those of a file, at their places in the document if there is one."""
    placed, found = document.placed if document else lambda where: where, report.findings
    findings = tuple(replace(f, location=placed(f.location)) for f in found) if document else found
    unread = tuple(f"{placed(one.location)}: {one.reason}" for one in report.skipped)
    return FileReport(source, robot.name, findings, unread, readings=report.readings)


def document_named(text: str, lines: tuple[int, int] | None = None, section: str = "") -> Manuscript | None:
    """The document, or part of it, by its path or its text; None where a text is a formula itself."""
    document = None
    if "\n" not in text.strip() and not re.search(r"[\\{}=$]", text):
        looks_like_path = re.fullmatch(r"[\w./ ~-]+\.[A-Za-z]{3,5}", text) is not None
        is_path = looks_like_path or Path(text).suffix.lower() in KINDS or (len(text) < 4096 and is_there(Path(text)))
        document = read_document(text) if is_path else None
    elif is_document(text):
        document = document_of(text, "standard input")
    if document is None and (lines or section):
        raise CheckError("--lines and --section choose a part of a document", remedy="give a file")
    return document.within(lines, section) if document else None


def formula_lines(reported: Printout) -> list[str]:
    """The verdicts on what is given without a corpus file, right ones included; the count of several at the end."""
    report = reported.report
    lines = [f"{report.source}: {reading}" for reading in report.readings]
    lines += all_lines(reported)
    lines += [f"{place}: not compared: {reason}" for place, reason in (note.split(": ", 1) for note in report.unread)]
    if len(report.findings) > 1 or report.unread:
        more = f"; {len(report.unread)} not compared" if report.unread else ""
        lines.append(f"{report.source}: {summary(replace(report, unread=()))}{more}")
    return lines

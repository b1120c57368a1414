"""Printed solutions of the inverse kinematics, as text, as LaTeX and in files, read and compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from derive.checking.formulas import reading
from derive.checking.formulas.findings import Finding
from derive.checking.formulas.printed import Asked, InverseText, PrintedText
from derive.checking.inverse.check import inverse_findings
from derive.checking.inverse.latex import latex_equations
from derive.checking.inverse.reading import Refused, Side, assembled
from derive.checking.inverse.text import text_equations
from derive.checking.latex.names import PlusMinus
from derive.errors import CheckError, DeriveError, QuantityError
from derive.model.model import Model
from derive.model.quantity_names import parse
from derive.robot.options.inverse import Task, chosen_task
from derive.robot.reading.document import Node, YamlMapping, YamlSequence

ORDERS = ("yx", "xy")  # orders of the arguments of atan2: the sine first, or the cosine


def check_inverse(model: Model, solution: InverseText) -> tuple[tuple[Finding, ...], tuple[Refused, ...]]:
    r"""Compare a printed solution with the arm."""
    robot, signs = model.robot, PlusMinus()
    equations: list[list[Side]] = []
    words: list[str] = []
    if not any(part.text.strip() for part in solution.parts):
        where = solution.asked.location
        raise CheckError("empty solution", remedy="write theta1 = ..., one quantity a line", location=where)
    for part in solution.parts:
        try:
            if solution.latex:
                found = latex_equations(part.text, robot, part.location, signs, document=solution.document)
            else:
                found = text_equations(part.text, robot, part.location, signs)
        except CheckError as error:
            raise _placed(error, part) from None
        equations += found[0]
        words += found[1]
    refused: list[Refused] | None = [] if solution.document else None
    try:
        printed, vocabulary = assembled(robot, equations, words, refused)
        findings = tuple(inverse_findings(model, printed, vocabulary, solution.asked))
    except CheckError as error:
        if all(part.verbatim for part in solution.parts):
            raise
        raise _placed(error, solution.parts[0]) from None
    erratum = solution.status == "erratum"
    said = (replace(f, erratum=erratum and not f.verdict.equal, remark=solution.remark) for f in findings)
    return tuple(said), tuple(refused or ())


def _placed(error: CheckError, part: PrintedText) -> CheckError:
    """Columns of a text that does not stand in the file character by character are not those of the file."""
    if part.verbatim:
        return error
    return type(error)(error.found, allowed=error.allowed, remedy=error.remedy, location=part.location)


def read_inverse(node: Node | None, lines: Sequence[str]) -> Iterator[InverseText]:
    """The printed solutions of a block ``inverse_kinematics:``, which may be a list of several."""
    blocks = node.items if isinstance(node, YamlSequence) else [node] if node is not None else []
    for block in blocks:
        if isinstance(block, YamlMapping) and "formulas" in block.entries:
            continue
        item = reading.mapping(
            block,
            "inverse_kinematics",
            (),
            ("lines", "latex", "task", "atan2", "status", "given", "notation", "note", "kind", "printed_as", "source"),
        )
        if ("lines" in item.entries) is ("latex" in item.entries):
            raise CheckError(
                "inverse_kinematics needs either 'lines', 'latex' or 'formulas'",
                remedy='write lines: ["theta2 = atan2(+-sqrt(1 - D**2), D)", ...]',
                location=item.location,
            )
        content = item.entries["lines" if "lines" in item.entries else "latex"][1]
        texts = content.items if isinstance(content, YamlSequence) else [content]
        parts = tuple(reading.printed_text(reading.scalar(text, "a line"), lines) for text in texts)
        order = reading.word(item, "atan2", ORDERS, "")
        asked = Asked(item.location, _task(item), order == "xy" if order else None)
        yield InverseText(parts, asked, "latex" in item.entries, False, reading.status(item), reading.remark(item))


def _task(item: YamlMapping) -> Task | None:
    node = reading.child(item, "task")
    if node is None:
        return None
    words = (
        [reading.scalar(word, "a row of the task").text for word in node.items]
        if isinstance(node, YamlSequence)
        else reading.scalar(node, "task").text.replace(",", " ").split()
    )
    try:
        return chosen_task(words, 6)
    except DeriveError as error:
        raise CheckError(error.found, allowed=error.allowed, remedy=error.remedy, location=node.location) from None


def inverse_text(text: str, asked: Asked, *, latex: bool = False, document: bool = False) -> InverseText:
    """A printed solution that stands in no file of its own kind."""
    return InverseText((PrintedText(text, asked.location),), asked, latex, document)


def names_inverse(model: Model, quantity: str) -> bool:
    """Whether a quantity that is asked about is the inverse kinematics."""
    if not quantity:
        return False
    try:
        return parse(model, quantity)[0].name == "inverse"
    except QuantityError:
        return False

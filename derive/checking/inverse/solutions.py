"""Printed solutions of the inverse kinematics, as text, as LaTeX and in files, read and compared."""

from __future__ import annotations

from dataclasses import replace

from derive.checking.formulas.findings import Finding
from derive.checking.formulas.printed import Asked, InverseText, PrintedText
from derive.checking.inverse.check import inverse_findings
from derive.checking.inverse.latex import latex_equations
from derive.checking.inverse.reading import Refused, Side, assembled
from derive.checking.inverse.text import text_equations
from derive.checking.latex.names import PlusMinus
from derive.errors import CheckError, QuantityError
from derive.model.model import Model
from derive.model.quantity_names import parse


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
            raise error if part.verbatim else error.moved(part.location) from None
        equations += found[0]
        words += found[1]
    refused: list[Refused] | None = [] if solution.document else None
    try:
        printed, vocabulary = assembled(robot, equations, words, refused)
        findings = tuple(inverse_findings(model, printed, vocabulary, solution.asked))
    except CheckError as error:
        first = solution.parts[0]
        raise error if first.verbatim else error.moved(first.location) from None
    erratum = solution.status == "erratum"
    said = (replace(f, erratum=erratum and not f.verdict.equal, remark=solution.remark) for f in findings)
    return tuple(said), tuple(refused or ())


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

"""Printed formulas against derived ones, entry by entry."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import Enum
from functools import reduce
from itertools import pairwise
from typing import Any

import sympy

from derive.check.printed import CorpusFile, Factorisation, Identity, Printed, PrintedQuantity
from derive.errors import CheckError, DeriveError, Location
from derive.mechanics.equality import Verdict, compare, expression_from_sympy, scalar_quantity
from derive.mechanics.model import Model
from derive.robot.arithmetic import number
from derive.robot.notation import read_formula

Expr = Any
Matrix = Any


class Role(Enum):
    """What a compared formula is in its file."""

    PRINTED = "printed"
    ABBREVIATED = "abbreviated"
    REST = "rest"
    CORRECTION = "correction"
    IDENTITY = "identity"
    FACTORISATION = "factorisation"


@dataclass(frozen=True, slots=True)
class Finding:
    """One comparison.

    Attributes:
        quantity: What the formula is printed for, without the place of the entry.
        row: Row of the entry, from 1; 0 where the whole is one formula.
        column: Column of the entry, from 1; 0 where the whole is a vector or one formula.
        role: What the formula is in its file.
        text: The formula as printed.
        verdict: Whether it is right.
        right: The derived formula.
        location: Where it stands.
        erratum: Whether the file marks it as wrong.
    """

    quantity: str
    row: int
    column: int
    role: Role
    text: str
    verdict: Verdict
    right: Expr
    location: Location
    erratum: bool = False

    @property
    def entry(self) -> str:
        """The quantity with its place: ``B[1,2]``, ``A[1][2,4]``, ``g[3]``."""
        indices = ",".join(str(i) for i in (self.row, self.column) if i)
        bracket = "[]" if self.quantity == "T" else ""
        return f"{self.quantity}{bracket}[{indices}]" if indices else self.quantity


@dataclass(frozen=True, slots=True)
class FileReport:
    """Everything that was compared in one file.

    Attributes:
        source: Name of the file.
        robot: Name of its robot.
        findings: One for each comparison, in the order of the file.
        unread: Blocks that were not compared.
    """

    source: str
    robot: str
    findings: tuple[Finding, ...]
    unread: tuple[str, ...] = ()

    @property
    def wrong(self) -> tuple[Finding, ...]:
        """The comparisons that found a difference."""
        return tuple(finding for finding in self.findings if not finding.verdict.equal)

    @property
    def passed(self) -> bool:
        """Whether everything is right as printed."""
        return not self.wrong


def check_file(file: CorpusFile) -> FileReport:
    """Compare everything that a corpus file prints.

    Args:
        file: The robot and its printed formulas.

    Raises:
        QuantityError: An item names no quantity of this robot.
        CheckError: An item whose shape is not that of its quantity, or a formula that has no value.
    """
    model = Model(file.robot)
    findings = [finding for item in file.expected for finding in _placed(_quantity(model, item), item.location)]
    findings += [_identity(model, identity) for identity in file.identities]
    if file.factorisation is not None:
        findings += _placed(_factorisation(model, file.factorisation), file.factorisation.location)
    return FileReport(file.source, file.robot.name, tuple(findings), file.unread)


def check_expression(model: Model, quantity: str, text: str) -> Finding:
    """Compare one formula with a scalar quantity.

    Args:
        model: The robot's model.
        quantity: A scalar quantity such as ``T[1,4]`` (its entry) or ``christoffel[1,1,2]``.
        text: The formula, in the notation of lecture notes.

    Raises:
        QuantityError: No such quantity, or a matrix.
        CheckError: The formula cannot be read.
    """
    start = Location("--expression")
    formula = read_formula(text, model.robot, start)
    right = scalar_quantity(model, quantity)
    verdict = compare(model.robot, expression_from_sympy(right), formula)
    return Finding(quantity, 0, 0, Role.PRINTED, text, verdict, right, start)


def _placed(findings: Iterable[Finding], location: Location) -> Iterator[Finding]:
    """Errors about an item are placed at it."""
    try:
        yield from findings
    except DeriveError as error:
        raise error.at(location) from None


def _quantity(model: Model, item: PrintedQuantity) -> Iterator[Finding]:
    right = _derived(model, item)
    if item.shape is not None and item.shape != right.shape:
        raise CheckError(
            f"{item.quantity}: printed with {item.shape[0]} rows and {item.shape[1]} columns",
            allowed=f"{right.shape[0]} rows and {right.shape[1]} columns",
        )
    erratum = item.status == "erratum"
    for entry in item.entries:
        yield _entry(model, item, right, entry, Role.PRINTED, erratum)
    for entry in item.abbreviated:
        yield _entry(model, item, right, entry, Role.ABBREVIATED, erratum)
    for entry in item.corrections:
        yield _entry(model, item, right, entry, Role.CORRECTION)
    if item.rest_zero:
        yield from _rest(model, item, right)


def _derived(model: Model, item: PrintedQuantity) -> Matrix:
    """The quantity as a matrix; a single printed formula is an entry where the quantity is a matrix."""
    value = model.quantity(item.quantity)
    if item.shape == (1, 1) and getattr(value, "shape", (1, 1)) != (1, 1):
        value = scalar_quantity(model, item.quantity)
    return value if hasattr(value, "shape") else sympy.ImmutableMatrix([[value]])


def _entry(
    model: Model, item: PrintedQuantity, right: Matrix, entry: Printed, role: Role, erratum: bool = False
) -> Finding:
    if entry.row > right.shape[0] or entry.column > right.shape[1]:
        raise CheckError(
            f"{item.quantity}: entry {entry.row},{entry.column}",
            allowed=f"rows 1 to {right.shape[0]}, columns 1 to {right.shape[1]}",
            location=entry.location,
        )
    derived = right[entry.row - 1, entry.column - 1]
    verdict = _compared(model, derived, entry)
    row, column = _shown_place(right, entry)
    return Finding(item.quantity, row, column, role, entry.text, verdict, derived, entry.location, erratum)


def _compared(model: Model, derived: Expr, entry: Printed) -> Verdict:
    try:
        return compare(model.robot, expression_from_sympy(derived), entry.formula)
    except DeriveError as error:
        raise error.at(entry.location) from None


def _shown_place(right: Matrix, entry: Printed) -> tuple[int, int]:
    if right.shape == (1, 1):
        return 0, 0
    return entry.row, 0 if right.shape[1] == 1 else entry.column


def _rest(model: Model, item: PrintedQuantity, right: Matrix) -> Iterator[Finding]:
    printed = {(entry.row, entry.column) for entry in item.entries}
    for i in range(1, right.shape[0] + 1):
        for j in range(1, right.shape[1] + 1):
            if (i, j) not in printed:
                zero = Printed(i, j, "0", number(0), item.location)
                yield _entry(model, item, right, zero, Role.REST)


def _identity(model: Model, identity: Identity) -> Finding:
    left, right = identity.left, identity.right
    try:
        verdict = compare(model.robot, left.formula, right.formula)
    except DeriveError as error:
        raise error.at(right.location) from None
    erratum = identity.status == "erratum"
    return Finding(left.text, 0, 0, Role.IDENTITY, right.text, verdict, left.text, right.location, erratum)


def _factorisation(model: Model, item: Factorisation) -> Iterator[Finding]:
    whole, factors = model.quantity(item.of), [model.quantity(name) for name in item.factors]
    shapes = [getattr(factor, "shape", (0, 0)) for factor in factors]
    fits = all(a[1] == b[0] for a, b in pairwise(shapes))
    if not fits or (shapes[0][0], shapes[-1][1]) != getattr(whole, "shape", None):
        raise CheckError(f"factorisation of {item.of}: shapes {shapes} do not fit", remedy="check the names")
    product = reduce(lambda a, b: a * b, (sympy.Matrix(factor) for factor in factors))
    text = "*".join(item.factors)
    for i in range(whole.shape[0]):
        for j in range(whole.shape[1]):
            formula = expression_from_sympy(product[i, j])
            verdict = compare(model.robot, expression_from_sympy(whole[i, j]), formula)
            yield Finding(item.of, i + 1, j + 1, Role.FACTORISATION, text, verdict, whole[i, j], item.location)

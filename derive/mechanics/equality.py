"""Whether a printed formula equals a derived quantity, decided exactly in the polynomial ring wherever possible."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from derive.algebra.from_sympy import expression_from_sympy
from derive.algebra.quotients import QuotientRing
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.errors import CheckError, ExpressionError, QuantityError
from derive.mechanics.points import CounterExample, compare_at_points
from derive.mechanics.quantities import Quantity, parse, pick
from derive.robot.expression import Expression
from derive.robot.notation import read_formula
from derive.robot.robot import Robot

if TYPE_CHECKING:
    from derive.mechanics.model import Model

Expr = Any

__all__ = ["Verdict", "compare", "difference", "equal", "expression_from_sympy", "scalar_quantity", "verdict"]


@dataclass(frozen=True, slots=True)
class Verdict:
    """The outcome of a comparison.

    Attributes:
        equal: Whether the formulas are equal wherever both are defined.
        exact: Whether that was decided identically, by algebra; otherwise it was by their values with fifty digits at
            random points.
        counter_example: A point where they differ; None where they are equal.
    """

    equal: bool
    exact: bool
    counter_example: CounterExample | None = None


def difference(robot: Robot, ours: Expression, theirs: Expression) -> Polynomial:
    """A polynomial that is identically zero if the formulas are equal: the cross-multiplied difference.

    Args:
        robot: Its joints tell angles from lengths.
        ours: One formula, in the robot's own names.
        theirs: The other.

    Raises:
        CheckError: A formula divides by zero everywhere.
        ExpressionError: A formula that the ring cannot hold.
        TooManyTerms: A formula that is too long when multiplied out.
    """
    return QuotientRing(robot, (ours, theirs)).difference(ours, theirs)


def compare(robot: Robot, ours: Expression, theirs: Expression) -> Verdict:
    """Whether two formulas are equal wherever both are defined.

    Args:
        robot: Its joints tell angles from lengths.
        ours: The derived formula.
        theirs: The printed one.

    Raises:
        CheckError: A formula divides by zero, or has no real value at any of many points.
    """
    try:
        ring = QuotientRing(robot, (ours, theirs))
        zero, proves = not ring.difference(ours, theirs), ring.faithful
    except (ExpressionError, TooManyTerms):
        zero = proves = False
    if zero:
        return Verdict(True, True)
    points = compare_at_points(robot, ours, theirs)
    if not proves and not points.points:
        raise CheckError(
            "formula without a real value at any of many random points",
            remedy="check its roots and denominators",
        )
    return Verdict(not proves and points.differing is None, proves, points.differing)


def verdict(model: Model, quantity: str, expression: object) -> Verdict:
    """Whether an expression equals a scalar quantity.

    Args:
        model: The robot's model.
        quantity: A scalar quantity; ``T[1,4]`` is the entry in row 1, column 4 of T here, as no scalar equals a matrix.
        expression: Text in the notation of lecture notes (c12, qd1, ...) or a SymPy expression.

    Raises:
        QuantityError: No such quantity, or a matrix.
        CheckError: The expression cannot be read.
    """
    theirs = _read(model.robot, expression)
    return compare(model.robot, expression_from_sympy(scalar_quantity(model, quantity)), theirs)


def equal(model: Model, quantity: str, expression: object) -> bool:
    """Whether an expression equals a scalar quantity; see `verdict`."""
    return verdict(model, quantity, expression).equal


def _read(robot: Robot, expression: object) -> Expression:
    if isinstance(expression, str):
        return read_formula(expression, robot)
    try:
        return expression_from_sympy(expression)
    except ExpressionError as error:
        raise CheckError(error.found, allowed=error.allowed, remedy=error.remedy) from None


def scalar_quantity(model: Model, text: str) -> Expr:
    """A quantity that is one expression; the last two indices (one for a vector) may pick an entry of a matrix.

    Raises:
        QuantityError: No such quantity, or a matrix.
    """
    quantity, indices, entry = parse(model, text)
    if entry is not None:
        return pick(quantity.value(model, *indices), entry, text)
    for count, rest in _readings(quantity, indices):
        value = quantity.value(model, *indices[:count])
        shape = getattr(value, "shape", None)
        if shape is None and not rest:
            return value
        if shape == (1, 1) and not rest:
            return value[0, 0]
        if shape is not None and len(rest) == (1 if shape[1] == 1 else 2):
            return pick(value, rest, text)
    raise QuantityError(
        f"{text} is a matrix", allowed="a scalar here", remedy=f"name an entry, for instance {quantity.name}[...][1,1]"
    )


def _readings(quantity: Quantity, indices: tuple[int, ...]) -> Iterator[tuple[int, tuple[int, ...]]]:
    """How many indices name the quantity, and which are left for the entry; as many as possible first."""
    for count in sorted(quantity.indices, reverse=True):
        if count <= len(indices):
            yield count, indices[count:]

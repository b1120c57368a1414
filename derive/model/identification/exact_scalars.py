"""Scalars of the mechanics that lose nothing: rational numbers as long as everything is rational, else balls.

Cosines and sines of quarter turns are rational; those of other angles are balls of `derive.mechanics.space.BITS` bits.
Whoever computes with them does so inside `derive.mechanics.space.exactly`.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import Any

from flint import arb, fmpq

from derive.errors import ExpressionError
from derive.mechanics.space import NOTHING, cosine_sine
from derive.robot.description import Joint
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

Exact = Any  # a rational number (flint.fmpq) or a ball (flint.arb)


class ExactDomain:
    """Cells of a robot whose parameters all have numbers, every angle and offset of its joints zero."""

    def __init__(self, robot: Robot) -> None:
        self._values: dict[str, Exact] = {}
        for name, cell in dict(robot.parameters).items():
            self._values[name] = exact_value(cell, self._values)
        missing = [name for name in robot_symbols(robot) if name not in self._values]
        if missing:
            found = f"{robot.name}: no number for {', '.join(missing)}"
            raise ExpressionError(found, remedy="give them under parameters of the robot file")

    def number(self, value: int | Fraction) -> Exact:
        """A rational."""
        return fmpq(value.numerator, value.denominator)

    def constant(self, expression: Expression) -> Exact:
        """The value of a cell."""
        found = exact_value(expression, self._values)
        if isinstance(found, arb) and not found.is_finite():
            raise ExpressionError("an expression has no finite value")
        return found

    def cosine_sine(self, angle: Expression) -> tuple[Exact, Exact]:
        """Cosine and sine of a constant angle, rational where it is a multiple of pi/2."""
        # Quarter turns exactly, so that planar arms stay rational.
        cosine, sine = (fmpq(int(float(c))) if c.is_integer() else c for c in cosine_sine(arb(self.constant(angle))))
        return cosine, sine

    def joint_cosine_sine(self, index: int, joint: Joint) -> tuple[Exact, Exact]:
        """Those of zero: nothing that is asked of these scalars depends on where the joints stand."""
        return fmpq(1), fmpq(0)

    def joint_offset(self, index: int, joint: Joint) -> Exact:
        """Zero, see `joint_cosine_sine`."""
        return fmpq(0)


def exact_value(expression: Expression, values: Mapping[str, Exact]) -> Exact:
    """The value of a cell by those of its symbols."""
    match expression:
        case Number(value):
            return fmpq(value.numerator, value.denominator)
        case Pi():
            return arb.pi()
        case Name(name):
            if name not in values:
                raise ExpressionError(f"the parameter {name!r} has no number", remedy="give it one")
            return values[name]
        case Sum(parts):
            return sum((exact_value(part, values) for part in parts), fmpq(0))
        case Product(parts):
            return prod((exact_value(part, values) for part in parts), start=fmpq(1))
        case Power(base, exponent):
            number = exact_value(base, values)
            if exponent < 0 and is_zero(number):
                raise ExpressionError("an expression has no finite value: division by zero")
            return number**exponent
        case Call(function, arguments):
            return getattr(arb(exact_value(arguments[0], values)), function)()  # of sin, cos, tan and sqrt


def is_zero(value: Exact) -> bool:
    """Whether a scalar is zero; of a ball, whether it is within `NOTHING` of it."""
    return bool(value == 0) if isinstance(value, fmpq) else bool(abs(value) < NOTHING)


def as_fraction(value: Exact) -> Fraction:
    """A scalar as a rational number; of a ball its middle."""
    if isinstance(value, fmpq):
        return Fraction(int(value.p), int(value.q))
    # The middle of a ball is a dyadic rational.
    mantissa, exponent = value.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def null_space(rows: Sequence[Sequence[Exact]], width: int) -> dict[int, list[Exact]]:
    """Vectors that span what all rows send to zero, by elimination with the largest pivots."""
    matrix = [list(row) for row in rows]
    pivots: list[int] = []
    for column in range(width):
        at = len(pivots)
        candidates = [k for k in range(at, len(matrix)) if not is_zero(matrix[k][column])]
        if not candidates:
            continue
        # Largest pivot: balls lose fewest bits.
        best = max(candidates, key=lambda k: abs(float(matrix[k][column])))
        matrix[at], matrix[best] = matrix[best], matrix[at]
        pivot = matrix[at][column]
        matrix[at] = [entry / pivot for entry in matrix[at]]
        for k, row in enumerate(matrix):
            if k != at and not is_zero(row[column]):
                factor = row[column]
                matrix[k] = [entry - factor * own for entry, own in zip(row, matrix[at], strict=True)]
        pivots.append(column)
    # One vector for each column without a pivot: 1 there, and minus its entries at the pivots.
    basis = {}
    for free in (column for column in range(width) if column not in pivots):
        vector: list[Exact] = [fmpq(int(column == free)) for column in range(width)]
        for row, pivot_column in zip(matrix, pivots, strict=False):
            vector[pivot_column] = -row[free]
        basis[free] = vector
    return basis

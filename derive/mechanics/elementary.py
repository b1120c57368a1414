"""Elementary rotations and translations as exact 4x4 matrices, and their products.

What lectures draw before any table: Rot(z, pi/2), Trans(4, -3, 7), and a chain of them (Siciliano, Sciavicco, Villani,
Oriolo, Robotics, sections 2.2 and 2.7). Entries are plain SymPy; products are reduced by sin^2 + cos^2 = 1. Nothing is
rounded: a float stands for the decimal that it prints.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.from_sympy import expression_from_sympy
from derive.algebra.lecture_form import LectureForm
from derive.algebra.ring import Polynomial
from derive.algebra.to_sympy import expression_to_sympy
from derive.errors import ExpressionError
from derive.robot.expression import Expression
from derive.robot.robot import Convention, Robot

Scalar = Any
Matrix = Any

_NO_ROBOT = Robot(name="frames", title="", convention=Convention.STANDARD, joints=())
_FIRST_ROW = {"x": 1, "y": 2, "z": 0}
"""The row from which a turn about the axis goes to the next one: y to z, z to x, x to y."""


def rotation(axis: str, angle: Scalar) -> Matrix:
    """Rot(axis, angle), 4x4: the turn about a coordinate axis, counter-clockwise seen from its tip.

    Args:
        axis: ``x``, ``y`` or ``z``.
        angle: Angle [rad], a number or a SymPy expression.

    Raises:
        ExpressionError: Another axis, or an angle that is neither.
    """
    if axis not in _FIRST_ROW:
        raise ExpressionError(f"axis {axis!r}", allowed="x, y or z")
    turn = _scalar(angle)
    i = _FIRST_ROW[axis]
    j = (i + 1) % 3
    matrix = sympy.eye(4)
    matrix[i, i] = matrix[j, j] = sympy.cos(turn)
    matrix[i, j], matrix[j, i] = -sympy.sin(turn), sympy.sin(turn)
    return sympy.ImmutableMatrix(matrix)


def translation(x: Scalar, y: Scalar, z: Scalar) -> Matrix:
    """Trans(x, y, z), 4x4.

    Args:
        x: Displacement along x [m], a number or a SymPy expression.
        y: Along y.
        z: Along z.

    Raises:
        ExpressionError: A displacement that is neither.
    """
    matrix = sympy.eye(4)
    matrix[:3, 3] = sympy.Matrix([_scalar(x), _scalar(y), _scalar(z)])
    return sympy.ImmutableMatrix(matrix)


def point(x: Scalar, y: Scalar, z: Scalar) -> Matrix:
    """The homogeneous coordinates (x, y, z, 1), 4x1, of a point [m]."""
    return translation(x, y, z)[:, 3]


def compose(*frames: Matrix) -> Matrix:
    """The product of frames from left to right, exact and reduced.

    Args:
        frames: 4x4 matrices; the last may be a point, 4x1.

    Returns:
        4x4, or 4x1 after a point.

    Raises:
        ExpressionError: No frame, or shapes that do not fit.
    """
    shapes = [getattr(frame, "shape", None) for frame in frames]
    if not frames or any(shape != (4, 4) for shape in shapes[:-1]) or shapes[-1] not in ((4, 4), (4, 1)):
        raise ExpressionError(f"frames of shapes {shapes}", allowed="4x4 matrices, the last one 4x4 or a point 4x1")
    factors = [_expressions(frame) for frame in frames]
    domain = PolynomialDomain(_NO_ROBOT, [e for rows in factors for row in rows for e in row], rates=False)
    product = [[domain.constant(e) for e in row] for row in factors[0]]
    for factor in factors[1:]:
        product = _product(product, [[domain.constant(e) for e in row] for row in factor])
    write = LectureForm(domain).kinematic
    return sympy.ImmutableMatrix([[write(entry) for entry in row] for row in product])


def _scalar(value: Scalar) -> Scalar:
    try:
        found = sympy.sympify(value, strict=True)
    except sympy.SympifyError:
        found = None
    if not isinstance(found, sympy.Expr) or found.is_Matrix:
        raise ExpressionError(f"value of type {type(value).__name__}", allowed="a number or a SymPy expression")
    return expression_to_sympy(expression_from_sympy(found))


def _expressions(frame: Matrix) -> list[list[Expression]]:
    return [[expression_from_sympy(entry) for entry in row] for row in frame.tolist()]


def _product(a: Sequence[Sequence[Polynomial]], b: Sequence[Sequence[Polynomial]]) -> list[list[Polynomial]]:
    ring = a[0][0].ring
    return [[ring.sum(x * row[j] for x, row in zip(left, b, strict=True)) for j in range(len(b[0]))] for left in a]

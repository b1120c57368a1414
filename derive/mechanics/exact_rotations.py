"""Whether the constant transforms of a robot are rotations exactly.

A file may write them in decimals with six places; then identities of rotations hold to six places only.
"""

from __future__ import annotations

from collections.abc import Mapping

from derive.robot.evaluate import evaluate
from derive.robot.names import free_symbols, number_of, robot_symbols
from derive.robot.robot import Matrix, Robot

_TOLERANCE = 1e-14
_TRIALS = (0.37, 0.83)
"""Values of the first free symbol; the others are spread above."""


def has_exact_rotations(robot: Robot) -> bool:
    """Whether base and tool are rotations to rounding, whatever the values of free symbols."""
    numbers = number_of(robot)
    fixed = {name: evaluate(numbers[name], {}) for name in robot_symbols(robot) if name in numbers}
    for first in _TRIALS:
        values = fixed | {name: first + 0.071 * k for k, name in enumerate(free_symbols(robot))}
        if not (_is_rotation(robot.base, values) and _is_rotation(robot.tool, values)):
            return False
    return True


def _is_rotation(matrix: Matrix, values: Mapping[str, float]) -> bool:
    try:
        rows = [[evaluate(cell, values) for cell in row[:3]] for row in matrix[:3]]
    except ArithmeticError:
        return False
    products = ((i, j, sum(a * b for a, b in zip(rows[i], rows[j], strict=True))) for i in range(3) for j in range(3))
    return all(abs(product - (i == j)) <= _TOLERANCE for i, j, product in products)

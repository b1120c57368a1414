"""How the joints of a robot follow its variables.

Joint positions are S q and constants, S a constant matrix. Rows of S that belong to passive joints of closed loops are
not constant: they stand for the derivatives of their positions.
"""

from collections.abc import Callable, Sequence
from itertools import combinations_with_replacement
from typing import Any

from derive.robot.description import Description, Joint
from derive.robot.expression import ONE, ZERO, Expression, Name, add, multiply, negate


def drives(joint: Joint) -> tuple[tuple[str, Expression], ...]:
    """The variables of a joint with their factors in its cell."""
    return joint.drive or ((joint.variable, ONE if joint.sign > 0 else negate(ONE)),)


def position(joint: Joint) -> Expression:
    """What is variable of a joint's cell."""
    return add(*(multiply(factor, Name(variable)) for variable, factor in drives(joint)))


def second_derivative(joint: Joint, one: str, other: str) -> Name:
    """The name of the second derivative of a passive joint's variable by two variables that it follows."""
    first, second = (name for name, _ in joint.follows if name in (one, other)) if one != other else (one, one)
    return Name(f"H_{joint.variable}_{first}_{second}")


def derivatives(robot: Description) -> dict[tuple[str, ...], Name]:
    """The names of first and second derivatives by passive joint and variables: of (q3, q1) G_q3_q1."""
    found: dict[tuple[str, ...], Name] = {}
    found |= {(joint.variable, name): factor for joint in robot.passive for name, factor in joint.follows}
    for joint in robot.passive:
        for pair in combinations_with_replacement([name for name, _ in joint.follows], 2):
            found[joint.variable, *pair] = second_derivative(joint, *pair)
    return found


def coupling(robot: Description, scalar: Callable[[Expression], Any] = lambda factor: factor) -> list[list[Any]]:
    """S, a row for each joint and a column for each variable."""
    rows = (dict(joint.drive or joint.follows) or {joint.variable: ONE} for joint in robot.joints)
    return [[scalar(row.get(variable.variable, ZERO)) for variable in robot.variables] for row in rows]


def projected(values: Sequence[Any], matrix: Sequence[Sequence[Any]], zero: Any) -> list[Any]:
    """S^T v: what joints feel, as the variables feel it."""
    return [
        sum((row[k] * value for row, value in zip(matrix, values, strict=True) if row[k]), zero)
        for k in range(len(matrix[0]))
    ]

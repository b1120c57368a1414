"""Names of velocities and accelerations, labels of joints, and the symbols of a robot with their numbers."""

from collections.abc import Iterator
from dataclasses import replace
from typing import TypeVar

from derive.robot.description import Description
from derive.robot.expression import Expression, names
from derive.robot.units import are_units_clear, located_expressions

Some = TypeVar("Some", bound=Description)


def velocity_name(variable: str) -> str:
    """Name of the velocity of a joint variable."""
    digits = joint_label(variable)
    return f"{variable.removesuffix(digits)}d{digits}"


def acceleration_name(variable: str) -> str:
    """Name of the acceleration of a joint variable."""
    return velocity_name(velocity_name(variable))


def joint_label(variable: str) -> str:
    """What tells a joint from others of its letter."""
    return variable[len(variable.rstrip("0123456789")) :]


def joint_labels(robot: Description) -> dict[str, str]:
    """Joint variable -> its label; its number where no variable has a digit, as in q_hip and q_knee."""
    labels = {joint.variable: joint_label(joint.variable) for joint in robot.movers}
    return labels if any(labels.values()) else {variable: str(i) for i, variable in enumerate(labels, 1)}


def expressions(robot: Description) -> Iterator[Expression]:
    """Every expression that enters a quantity, from the base to the tools, then gravity and links; no limits."""
    located = list(located_expressions(robot))
    for blocks in (("base",), ("joints",), ("tool", "ends", "loops"), ("gravity", "links", "root")):
        yield from (cell for path, cell in located if path[0] in blocks and path[2:3] != ("limits",))


def robot_symbols(robot: Description) -> tuple[str, ...]:
    """Parameters of kinematics and dynamics; joint variables are none."""
    variables = {joint.variable for joint in robot.movers}
    found = dict.fromkeys(name for expression in expressions(robot) for name in names(expression))
    return tuple(name for name in found if name not in variables)


def own_names(robot: Description) -> frozenset[str]:
    """Symbols and joint variables, which no printed formula may mean otherwise."""
    return frozenset((*robot_symbols(robot), *(joint.variable for joint in robot.movers)))


def limit_symbols(robot: Description) -> tuple[str, ...]:
    """Symbols in the limits of joints."""
    limits = [limit for movers in (robot.joints, robot.coupled) for mover in movers for limit in mover.limits or ()]
    return tuple(dict.fromkeys(name for limit in limits for name in names(limit)))


def file_symbols(robot: Description) -> tuple[str, ...]:
    """Symbols in any cell of a robot file: of quantities and of limits; largest speeds and torques are numbers."""
    return tuple(dict.fromkeys((*robot_symbols(robot), *limit_symbols(robot))))


def without_lost_symbols(before: Description, after: Some) -> Some:
    """A changed robot without numbers of symbols that went with the change: a file may hold none that no cell has."""
    # Where a symbol has no clear unit any more, a file can give their numbers in SI units alone.
    lost = {*file_symbols(before)} - {*file_symbols(after)}
    return replace(
        after,
        units=replace(after.units, parameters=after.units.parameters and are_units_clear(after)),
        parameters=tuple(pair for pair in after.parameters if pair[0] not in lost),
        runtime=tuple(name for name in after.runtime if name not in lost),
        figure=replace(after.figure, values=tuple(pair for pair in after.figure.values if pair[0] not in lost)),
    )


def free_symbols(robot: Description) -> tuple[str, ...]:
    """Symbols that stay arguments of generated code: without a number, or named in ``runtime``."""
    baked = dict(robot.parameters).keys() - set(robot.runtime)
    return tuple(name for name in robot_symbols(robot) if name not in baked)

"""Checks that need the whole robot: names, parameters, and numbers that must make sense."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping

from derive.errors import RobotFileError, near_miss
from derive.robot.cells import Cells
from derive.robot.description import Description, Joint, Link
from derive.robot.document import Document, KeyPath
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, names
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.table import check_rotation

_SEED = 560
"""Any fixed seed: the same file must be accepted or refused everywhere alike."""

_TRIALS = 8
"""Enough that an entry such as sqrt(1 - k1**2 - k2**2) is real in some of them."""


_SCALES = (0.2, 0.5, 0.9, 3.0, 10.0, 100.0, 1000.0) * 4
"""Sizes of the numbers of either sign with which a cell is tried before it is called impossible."""

_HUGE = 1e12
"""What is larger can only be a division by a rounding error."""


_ROUNDING = 1e-12
"""A configuration at a limit is within it, whatever a float makes of pi/2."""


def validate(document: Document, cells: Cells, robot: Description) -> None:
    """Refuse a robot whose parts contradict each other.

    Raises:
        RobotFileError: At the first contradiction.
    """
    _check_derived_names(document, cells, robot)
    _check_constants(document, cells, robot)
    _check_parameters_used(document, cells, robot)
    _check_runtime(document, cells, robot)
    values = _numbers(document, robot)
    for path, expression in located_expressions(robot):
        _check_finite(document, path, expression, values)
        _check_possible(document, path, expression, values)
    for row, joint in enumerate(robot.joints):
        _check_limits(document, ("joints", row, "limits"), joint, values)
        _check_drawn(document, row, robot, values)
    for row, link in enumerate(robot.links):
        _check_masses(document, ("links", row), link, values)
    for key, matrix in (("base", robot.base), ("tool", robot.tool)):
        check_rotation(document, key, matrix, _trials(robot, cells, values))


def located_expressions(robot: Description) -> Iterator[tuple[KeyPath, Expression]]:
    """Every expression of the robot with its path in the file."""
    for key, matrix in (("base", robot.base), ("tool", robot.tool)):
        yield from (((key, i, j), entry) for i, row in enumerate(matrix) for j, entry in enumerate(row))
    for index, joint in enumerate(robot.joints):
        row: KeyPath = ("joints", index)
        cells = (("theta", joint.theta), ("d", joint.d), ("a", joint.a), ("alpha", joint.alpha))
        yield from (((*row, key), expression) for key, expression in cells)
        yield from (((*row, "limits", k), limit) for k, limit in enumerate(joint.limits or ()))
    yield from ((("gravity", k), entry) for k, entry in enumerate(robot.gravity or ()))
    for index, link in enumerate(robot.links):
        yield from _located_link(("links", index), link)


def _located_link(row: KeyPath, link: Link) -> Iterator[tuple[KeyPath, Expression]]:
    yield (*row, "mass"), link.mass
    yield from (((*row, "com", k), entry) for k, entry in enumerate(link.com))
    for key in ("xx", "yy", "zz", "xy", "xz", "yz"):
        yield (*row, "inertia", key), getattr(link.inertia, key)
    if link.motor is not None:
        for key in ("mass", "inertia", "ratio"):
            yield (*row, "motor", key), getattr(link.motor, key)
    yield (*row, "armature"), link.armature
    yield (*row, "friction", "viscous"), link.viscous
    yield (*row, "friction", "coulomb"), link.coulomb


def _check_derived_names(document: Document, cells: Cells, robot: Description) -> None:
    """Velocities and accelerations get names of their own; nothing else may have them."""
    taken: dict[str, str] = {joint.variable: "joint variable" for joint in robot.joints}
    taken |= {name: "symbol" for name in cells.first_use if name not in taken}
    for row, joint in enumerate(robot.joints):
        for kind, derived in (
            ("velocity", velocity_name(joint.variable)),
            ("acceleration", acceleration_name(joint.variable)),
        ):
            if derived in taken:
                raise RobotFileError(
                    f"the {kind} of '{joint.variable}' is called '{derived}', and that is a {taken[derived]} already",
                    remedy=f"rename '{derived}' or the joint variable '{joint.variable}'",
                    location=cells.first_use.get(derived, document.location(("joints", row, "q"))),
                )
            taken[derived] = f"{kind}"


def _check_constants(document: Document, cells: Cells, robot: Description) -> None:
    """Joint variables belong to the table's moving cells and nowhere else."""
    variables = {joint.variable for joint in robot.joints}
    for path, expression in located_expressions(robot):
        for name in names(expression):
            if name in variables:
                raise document.error(
                    path, f"joint variable '{name}'", "allowed: numbers and parameters", "use another name"
                )


def _check_parameters_used(document: Document, cells: Cells, robot: Description) -> None:
    variables = {joint.variable for joint in robot.joints}
    for name, _ in robot.parameters:
        path = ("parameters", name)
        if name in variables:
            raise document.error(
                path, "a joint variable has no fixed number", remedy="remove it; bounds go to limits: [lower, upper]"
            )
        if name not in cells.first_use:
            raise document.error(
                path,
                "no cell uses this parameter",
                remedy=near_miss(name, cells.first_use.keys() - variables) or "remove it, or use it",
            )


def _check_runtime(document: Document, cells: Cells, robot: Description) -> None:
    variables = {joint.variable for joint in robot.joints}
    for index, name in enumerate(robot.runtime):
        path = ("runtime", index)
        if name in robot.runtime[:index]:
            raise document.error(path, f"'{name}' twice", remedy="remove one")
        if name in variables:
            raise document.error(path, f"'{name}' is a joint variable", remedy="remove it: it is an argument anyway")
        if name not in cells.first_use:
            raise document.error(
                path,
                f"unknown symbol '{name}'",
                "allowed: symbols that a cell uses",
                near_miss(name, cells.first_use.keys() - variables),
            )


def _numbers(document: Document, robot: Description) -> dict[str, float]:
    for name, value in robot.parameters:
        _check_finite(document, ("parameters", name), value, {})
    return {name: evaluate(value, {}) for name, value in robot.parameters}


def _trials(robot: Description, cells: Cells, values: Mapping[str, float]) -> Iterator[dict[str, float]]:
    """Sets of numbers for all symbols, random for those without a number and those that may change at run time."""
    source = random.Random(_SEED)
    open_names = sorted(name for name in cells.first_use if name not in values or name in robot.runtime)
    for _ in range(_TRIALS):
        yield {**values, **{name: source.uniform(0.1, 0.9) for name in open_names}}


def _value(expression: Expression, values: Mapping[str, float]) -> float | None:
    """The number of an expression, or None while a symbol has none."""
    if any(name not in values for name in names(expression)):
        return None
    return evaluate(expression, values)


def _check_finite(document: Document, path: KeyPath, expression: Expression, values: Mapping[str, float]) -> None:
    try:
        _value(expression, values)
    except ArithmeticError as error:
        raise document.error(path, str(error), "allowed: expressions with a finite real value") from None


def _check_possible(document: Document, path: KeyPath, expression: Expression, values: Mapping[str, float]) -> None:
    """Refuse a cell that has no value whatever its names stand for, such as 1/(a - a)."""
    open_names = sorted({name for name in names(expression) if name not in values})
    if not open_names:
        return
    source = random.Random(_SEED)
    for scale in _SCALES:
        numbers = {name: scale * source.uniform(-1, 1) for name in open_names}
        try:
            if abs(evaluate(expression, {**values, **numbers})) < _HUGE:
                return
        except ArithmeticError:
            continue
    raise document.error(
        path,
        "no real value, whatever its names stand for",
        "allowed: expressions with a finite real value",
        "look for a division by zero or the root of a negative number",
    )


def _check_limits(document: Document, path: KeyPath, joint: Joint, values: Mapping[str, float]) -> None:
    if joint.limits is None:
        return
    lower, upper = (_value(limit, values) for limit in joint.limits)
    if lower is not None and upper is not None and not lower < upper:
        raise document.error(
            path, "lower limit is not below the upper", "allowed: [lower, upper]", "exchange or correct them"
        )


def _check_drawn(document: Document, row: int, robot: Description, values: Mapping[str, float]) -> None:
    """The configuration that is drawn must be one that the joint can take."""
    limits = robot.joints[row].limits
    if robot.figure.q is None or limits is None:
        return
    drawn = evaluate(robot.figure.q[row], {})
    lower, upper = (_value(limit, values) for limit in limits)
    if (lower is not None and drawn < lower - _ROUNDING) or (upper is not None and drawn > upper + _ROUNDING):
        variable = robot.joints[row].variable
        raise document.error(
            ("figure", "q", row), f"outside of the limits of '{variable}'", remedy="draw another configuration"
        )


def _check_masses(document: Document, path: KeyPath, link: Link, values: Mapping[str, float]) -> None:
    masses: list[tuple[KeyPath, Expression]] = [((*path, "mass"), link.mass)]
    if link.motor is not None:
        masses.append(((*path, "motor", "mass"), link.motor.mass))
    for place, mass in masses:
        value = _value(mass, values)
        if value is not None and value < 0:
            raise document.error(place, f"negative mass {value:g}", "allowed: zero or more", "correct the sign")

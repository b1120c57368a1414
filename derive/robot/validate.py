"""Checks that need the whole robot: names, parameters, and numbers that must make sense."""

import random
from collections.abc import Iterable, Mapping
from dataclasses import replace

from derive.errors import RobotFileError, listed, near_miss
from derive.robot.cells import Cells
from derive.robot.coupling import coupling
from derive.robot.description import Description, Joint, Variable
from derive.robot.evaluate import evaluate
from derive.robot.expression import ONE, ZERO, Expression, names
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.reading.document import Document, KeyPath
from derive.robot.table import check_rotation
from derive.robot.tree import joint_places, located_links
from derive.robot.units import located_expressions, located_frames

_SEED = 560  # any fixed seed: the same file must be accepted or refused everywhere alike
_TRIALS = 8  # enough that an entry such as sqrt(1 - k1**2 - k2**2) is real in some of them
# Sizes of the numbers of either sign with which a cell is tried before it is called impossible.
_SCALES = (0.2, 0.5, 0.9, 3.0, 10.0, 100.0, 1000.0) * 4
_HUGE = 1e12  # what is larger can only be a division by a rounding error
_ROUNDING = 1e-12  # a configuration at a limit is within it, whatever a float makes of pi/2
_REAL = "allowed: expressions with a finite real value"


def validate(document: Document, cells: Cells, robot: Description) -> None:
    """Refuse a robot whose parts contradict each other."""
    _check_derived_names(document, cells, robot)
    variables = {joint.variable for joint in (*robot.variables, *robot.passive)}
    for path, expression in located_expressions(robot):
        if moving := [name for name in names(expression) if name in variables]:
            found = f"joint variable '{moving[0]}'"
            raise document.error(path, found, "allowed: numbers and parameters", "use another name")
    _check_symbols(document, cells, robot)
    values: dict[str, float] = {}
    for name, expression in robot.parameters:
        number = _number(document, ("parameters", name), expression, {})
        values |= {} if number is None else {name: number}
    for path, expression in located_expressions(robot):
        if _number(document, path, expression, values) is None:
            _check_possible(document, path, expression, values)
    for place, joint in zip(joint_places(robot), robot.joints, strict=True):
        _check_limits(document, place, joint, values)
    for variable in robot.coupled:
        _check_limits(document, ("variables", variable.variable), variable, values)
    for index, (mover, cell) in enumerate(zip(robot.variables, robot.figure.q or (), strict=False)):
        if mover.limits is None:
            continue
        lower, upper = (_value(limit, values) for limit in mover.limits)
        drawn = evaluate(cell, {})
        if (lower is not None and drawn < lower - _ROUNDING) or (upper is not None and drawn > upper + _ROUNDING):
            found = f"outside of the limits of '{mover.variable}'"
            raise document.error(("figure", "q", index), found, remedy="draw another configuration")
    for place, link in located_links(robot):
        masses = {("mass",): link.mass} | ({("motor", "mass"): link.motor.mass} if link.motor else {})
        for key, mass in masses.items():
            if (value := _value(mass, values)) is not None and value < 0:
                found = f"negative mass {value:g}"
                raise document.error((*place, *key), found, "allowed: zero or more", "correct the sign")
        for k, cell in enumerate(link.dry if isinstance(link.coulomb, tuple) else ()):
            if (value := _value(cell, values)) is not None and value < 0:
                found = f"negative friction {value:g} where the joint moves {('forwards', 'backwards')[k]}"
                remedy = f"write {-value:g}: both numbers are magnitudes against the motion, [f_plus, f_minus]"
                path = (*place, "friction", "coulomb", k)
                raise document.error(path, found, "allowed: zero or more", remedy)
    # numbers for all symbols, random for those without one and those that may change at run time
    source = random.Random(_SEED)
    open_names = sorted(name for name in cells.first_use if name not in values or name in robot.runtime)
    trials = [{**values, **{name: source.uniform(0.1, 0.9) for name in open_names}} for _ in range(_TRIALS)]
    if robot.coupled:
        _check_coupling(document, robot, trials)
    for path, matrix in located_frames(robot):
        check_rotation(document, path, matrix, trials)


def _check_derived_names(document: Document, cells: Cells, robot: Description) -> None:
    """Velocities and accelerations get names of their own; nothing else may have them."""
    taken: dict[str, str] = {joint.variable: "joint variable" for joint in (*robot.variables, *robot.passive)}
    taken |= {name: "symbol" for name in cells.first_use if name not in taken}
    places = [("variables",)] * robot.dof if robot.coupled else joint_places(robot)
    # Passive joints are variables of the arm that their loop is solved as.
    passive = [pair for pair in zip(joint_places(robot), robot.joints, strict=True) if pair[1].follows]
    for place, joint in (*zip(places, robot.variables, strict=True), *passive):
        derived = {"velocity": velocity_name(joint.variable), "acceleration": acceleration_name(joint.variable)}
        for kind, name in derived.items():
            if name in taken:
                found = f"the {kind} of '{joint.variable}' is called '{name}', and that is a {taken[name]} already"
                remedy = f"rename '{name}' or the joint variable '{joint.variable}'"
                location = cells.first_use.get(name, document.location((*place, "q")))
                raise RobotFileError(found, remedy=remedy, location=location)
            taken[name] = kind


def _check_coupling(document: Document, robot: Description, trials: Iterable[Mapping[str, float]]) -> None:
    """Refuse variables that move the joints only together with others."""
    active = replace(robot, joints=tuple(joint for joint in robot.joints if not joint.follows))
    for values in trials:
        rows = coupling(active, lambda factor: evaluate(factor, values))  # noqa: B023 - called at once
        lost = list(range(robot.dof))
        for row in rows:  # elimination: each row that is left takes the first variable that it still has
            pivot = next((k for k in lost if abs(row[k]) > _ROUNDING), None)
            if pivot is None:
                continue
            lost.remove(pivot)
            for other in rows:
                if other is not row and (share := other[pivot] / row[pivot]):
                    other[:] = [a - share * b for a, b in zip(other, row, strict=True)]
        if not lost:
            return
    names = listed(robot.coupled[k].variable for k in lost)
    found, remedy = f"joint positions do not determine {names}", "leave one out, or write it into a row of its own"
    raise document.error(("joints",), found, "allowed: variables that joint positions determine", remedy)


def _check_symbols(document: Document, cells: Cells, robot: Description) -> None:
    """Parameters and run-time parameters are symbols that some cell uses, the latter named once."""
    variables = {joint.variable for joint in (*robot.variables, *robot.passive)}
    symbols = cells.first_use.keys() - variables
    for name, _ in robot.parameters:
        path: KeyPath = ("parameters", name)
        if name in variables:
            remedy = "remove it; bounds go to limits: [lower, upper]"
            raise document.error(path, "a joint variable has no fixed number", remedy=remedy)
        if name not in symbols:
            remedy = near_miss(name, symbols) or "remove it, or use it"
            raise document.error(path, "no cell uses this parameter", remedy=remedy)
    for index, name in enumerate(robot.runtime):
        path = ("runtime", index)
        if name in robot.runtime[:index]:
            raise document.error(path, f"'{name}' twice", remedy="remove one")
        if name in variables:
            raise document.error(path, f"'{name}' is a joint variable", remedy="remove it: it is an argument anyway")
        if name not in symbols:
            found, allowed = f"unknown symbol '{name}'", "allowed: symbols that a cell uses"
            raise document.error(path, found, allowed, near_miss(name, symbols))


def _value(expression: Expression, values: Mapping[str, float]) -> float | None:
    return evaluate(expression, values) if all(name in values for name in names(expression)) else None


def _number(document: Document, path: KeyPath, expression: Expression, values: Mapping[str, float]) -> float | None:
    """The number of a cell, or None while a symbol has none; a number that does not exist is refused."""
    try:
        return _value(expression, values)
    except ArithmeticError as error:
        raise document.error(path, str(error), _REAL) from None


def _check_possible(document: Document, path: KeyPath, expression: Expression, values: Mapping[str, float]) -> None:
    """Refuse a cell that has no value whatever its names stand for, such as 1/(a - a)."""
    open_names = sorted({name for name in names(expression) if name not in values})
    source = random.Random(_SEED)
    for scale in _SCALES:
        numbers = {name: scale * source.uniform(-1, 1) for name in open_names}
        try:
            if abs(evaluate(expression, {**values, **numbers})) < _HUGE:
                return
        except ArithmeticError:
            continue
    remedy = "look for a division by zero or the root of a negative number"
    raise document.error(path, "no real value, whatever its names stand for", _REAL, remedy)


def _check_limits(document: Document, place: KeyPath, joint: Joint | Variable, values: Mapping[str, float]) -> None:
    """The limits of a joint or a variable are in order."""
    lower, upper = (_value(limit, values) for limit in joint.limits or (ZERO, ONE))
    if lower is not None and upper is not None and not lower < upper:
        found, remedy = "lower limit is not below the upper", "exchange or correct them"
        raise document.error((*place, "limits"), found, "allowed: [lower, upper]", remedy)

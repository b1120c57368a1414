"""Checks that need the whole robot: what is refused, and remarks on what is accepted but surely holds a slip.

An angle is exact in this program: ``1.5708`` is not pi/2, and its cosine is not 0. Likewise on inertia tensors that no
body has. The second moments of a body about its centre of mass, tr(I)/2 - I, have no negative eigenvalue: no principal
moment of inertia is larger than the sum of the other two. Published tensors often break this; torques may be right all
the same, since they know base parameters alone, but simulators refuse such a body.
"""

import random
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from math import pi, tau

from derive.errors import ExpressionError, RobotFileError, listed, near_miss, path_text
from derive.robot import expression as tree
from derive.robot.cells import Cells
from derive.robot.description import INERTIA, Description, FileUnits, Joining, Joint, Remark, Variable, coupling
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import ONE, ZERO, Expression, Name, is_constant, names
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.reading.document import Document, KeyPath
from derive.robot.table import check_rotation
from derive.robot.tree import joint_places, located_links
from derive.robot.units import Unit, cell_unit, located_expressions, located_frames, symbolic_factors, turned_angles

NEAR = 1e-3  # relative distance (absolute below 1) within which a number is taken for a rounded multiple of pi/12
# Limits of up to so many turns to either side are those of real wrists; an angle of the table is within one.
TURNS_OF_A_JOINT = 2
LARGEST_ARM, LEAST_ARM = 20.0, 0.01  # between them all lengths of an arm together are taken as meant [m]
# Among degrees only a number with so many decimals is taken for radians: 0.52 degrees is a calibrated angle.
DEGREE_DECIMALS = 3
_LIKE_PI = ("Pi", "PI", "pI", "M_PI")
_PARAMETERS = "; numbers of parameters are in radians unless units: {angle: deg, parameters: file} is written"
_UNITS = ", or units: {angle: deg} for the whole file"


def remarks_on(document: Document, robot: Description) -> tuple[Remark, ...]:
    """What is remarkable about the angles of a robot file.

    A number in an angle cell beyond 2 pi rad (in limits and drawn configurations beyond two turns) is taken for
    degrees; one within 1e-3 of a multiple of pi/12 for a rounded one; in a file in degrees, the latter for radians.
    Numbers of parameters that stand in angle cells, and arguments of sin, cos and tan, are angles too. Among
    millimetres a parameter that makes the arm larger than 20 m or smaller than 1 cm is taken for one of the other unit.
    """
    cells = Cells(document, robot.units)
    found: dict[KeyPath, Remark] = {}
    angles: list[tuple[KeyPath, Expression]] = []
    paths = [path for path, _ in located_expressions(robot)]
    for path in (*paths, *(("figure", "q", row) for row in range(robot.dof))):
        cell = cells.raw(path)
        angles += [(path, angle) for angle in turned_angles(cell)]
        angles += [(path, cell)] if cell_unit(path, robot) is Unit.ANGLE else []
        if lookalike := next((name for name in names(cell) if name in _LIKE_PI), None):
            what = f"{path_text(path)}: '{lookalike}' is a name like any other"
            found[path] = Remark(document.location(path), what, "the constant is written pi")
    named = {term.name for _, angle in angles for _, term in tree.linear_terms(angle) if isinstance(term, Name)}
    angles += [(path, cells.raw(path)) for path in _symbol_paths(robot) if path[-1] in named]
    for path, slip in [*((path, _slip(path, angle, robot.units)) for path, angle in angles), *_sizes(robot)]:
        if path not in found and slip is not None:
            found[path] = Remark(document.location(path), f"{path_text(path)}: {slip[0]}", slip[1])
    return tuple(sorted(found.values(), key=lambda remark: (remark.location.line, remark.location.column)))


def _symbol_paths(robot: Description) -> list[KeyPath]:
    drawn: list[KeyPath] = [("figure", "values", name) for name, _ in robot.figure.values]
    return [*(("parameters", name) for name, _ in robot.parameters), *drawn]


def _sizes(robot: Description) -> Iterator[tuple[KeyPath, tuple[str, str]]]:
    """Parameters that make an arm whose lengths are millimetres as large or as small as no arm is."""
    if not robot.units.millimetres:
        return
    numbers = parameter_values(robot) | {name: evaluate(value, {}) for name, value in robot.figure.values}
    lengths = [cell for path, cell in located_expressions(robot) if cell_unit(path, robot) is Unit.LENGTH]
    known: list[tuple[Expression, float]] = []
    for cell in lengths:
        with suppress(ArithmeticError, ExpressionError):  # a symbol without a number, or a cell without a value
            known.append((cell, abs(evaluate(cell, numbers))))
    factors = [factor for cell in lengths for _, term in tree.linear_terms(cell) for factor in symbolic_factors(term)]
    sizes = {name: abs(float(numbers[name])) for factor in factors for name in names(factor) if name in numbers}
    large = sum(size for cell, size in known if not is_constant(cell)) > LARGEST_ARM and not robot.units.parameters
    small = len(known) == len(lengths) and sum(size for _, size in known) < LEAST_ARM
    if not any(sizes.values()) or not (large or small):
        return
    what = f"more than {LARGEST_ARM:g} m" if large else f"less than {1000 * LEAST_ARM:g} mm"
    remedy = "numbers of parameters are in metres, or in millimetres with units: {length: mm, parameters: file}"
    if robot.units.parameters:
        remedy = "numbers of parameters are in millimetres, or in metres without parameters: file"
    for path in _symbol_paths(robot):
        size = sizes.get(str(path[-1]), 0.0)
        if size == max(sizes.values()) or size > LARGEST_ARM:
            yield path, (f"{size:.10g} m makes the lengths of this arm together {what}", remedy)


def _slip(path: KeyPath, angle: Expression, units: FileUnits) -> tuple[str, str] | None:
    """What is found and what to write, where the plain number in an angle is hardly meant as it stands."""
    parameter, motion = path[-2] in ("parameters", "values"), path[2:3] == ("limits",) or path[:2] == ("figure", "q")
    known = ((c, term) for c, term in tree.linear_terms(angle) if is_constant(term) and not tree.contains_pi(term))
    try:
        value = evaluate(tree.add(*(tree.multiply(tree.number(c), term) for c, term in known)), {})
    except ArithmeticError:
        return None
    shown, twelfths = f"{value:.10g}", round(12 * value / pi)
    near = twelfths != 0 and abs(value - twelfths * pi / 12) <= NEAR * max(1.0, abs(value)) and abs(twelfths) <= 24
    exact = tree.multiple_of_pi(Fraction(twelfths, 12))
    if units.degrees and (units.parameters or not parameter):
        if not near or motion or len(shown.partition(".")[2]) < DEGREE_DECIMALS:
            return None
        found = f"{shown} is nearly {exact}, but angles of this file are in degrees"
        return found, f"if radians are meant write {15 * twelfths}"
    if near and not motion:
        return f"{shown} rad is nearly {exact}, but not exactly", f"did you mean {exact}?"
    if abs(value) <= tau * (TURNS_OF_A_JOINT if motion else 1) * (1 + NEAR):
        return None
    in_radians = tree.multiple_of_pi(Fraction(shown) / 180) if "e" not in shown else f"{shown}*pi/180"
    found = f"{shown} rad is more than {'two turns' if motion else 'a turn'}"
    return found, f"if degrees are meant write {in_radians}{_PARAMETERS if parameter else _UNITS}"


ROUNDING = Fraction(1, 10**9)  # part of the largest principal moment that rounding may have taken from A + B - C
REMEDY = "derive export --inertia possible finds consistent inertias with the same torques"

# xx, yy, zz, xy, xz, yz about the centre of mass [kg m^2].
Tensor = tuple[Fraction, Fraction, Fraction, Fraction, Fraction, Fraction]


def remarks_on_bodies(document: Document, robot: Description) -> tuple[Remark, ...]:
    """Which links of a robot file have a tensor of numbers that no body has."""
    try:
        lacks = impossible_links(robot, parameter_values(robot))
    except ArithmeticError:
        return ()
    if not lacks:
        return ()
    path: KeyPath = (*next(iter(lacks)), "inertia")
    found = f"links {'entries' if len(lacks) > 1 else 'entry'} {numbered(lacks)}, inertia: {too_large(lacks.values())}"
    return (Remark(document.location(path), found, REMEDY, is_of_bodies=True),)


def numbered(links: Iterable[KeyPath]) -> str:
    """Places of links as numbers."""
    return listed(str(at + 1) if isinstance(at := place[1], int) else "of the root" for place in links)


def too_large(lacks: Iterable[float]) -> str:
    """What is wrong with tensors by `missing_moment`."""
    amounts = ", ".join(f"{lack:.3g}" for lack in lacks)
    return f"physically inconsistent: one principal moment exceeds the sum of the other two by {amounts} kg m^2"


def impossible_links(robot: Description, values: Mapping[str, Fraction | float]) -> dict[KeyPath, float]:
    """By place of a link what `lack_of` its tensor is, where it has numbers and is physically inconsistent."""
    lacks: dict[KeyPath, float] = {}
    for place, link in located_links(robot):
        cells = [getattr(link.inertia, key) for key in INERTIA]
        if any(name not in values for cell in cells for name in names(cell)):
            continue
        try:
            xx, yy, zz, xy, xz, yz = (Fraction(evaluate(cell, values)) for cell in cells)
        except ArithmeticError:
            continue
        if lack := lack_of((xx, yy, zz, xy, xz, yz)):
            lacks[place] = lack
    return lacks


def lack_of(tensor: Tensor) -> float:
    """`missing_moment` but of planar bodies, which have one moment: their tensors are not meant to be whole."""
    is_planar = sum(moment != 0 for moment in tensor[:3]) < 2 and min(tensor[:3]) >= 0
    return 0.0 if is_planar else missing_moment(tensor)


def missing_moment(tensor: Tensor) -> float:
    """By how much the largest principal moment is beyond the sum of the others; 0 where a body has the tensor."""
    # Whether it is, is decided exactly, by the principal minors of the second moments.
    # Second moments about the centre of mass: S = tr(I)/2 - I, with diagonal tr(I)/2 - I_xx, ... and entries -I_xy, ...
    xx, yy, zz, xy, xz, yz = tensor
    half, slack = (xx + yy + zz) / 2, ROUNDING * max(map(abs, tensor))
    a, b, c = half - xx + slack, half - yy + slack, half - zz + slack
    determinant = a * (b * c - yz * yz) - xy * (xy * c + yz * xz) - xz * (xy * yz + b * xz)
    # S is positive semidefinite if and only if all of its principal minors are not negative (Sylvester).
    minors = (a, b, c, a * b - xy * xy, a * c - xz * xz, b * c - yz * yz, determinant)
    if all(minor >= 0 for minor in minors):
        return 0.0
    # An eigenvalue s of S belongs to the principal moment tr(I)/2 - s, which exceeds the sum of the others by -2 s.
    import numpy as np  # files that are right are read without it

    rows = ((half - xx, -xy, -xz), (-xy, half - yy, -yz), (-xz, -yz, half - zz))
    return -2 * float(np.linalg.eigvalsh(np.array(rows, dtype=float))[0])


# -- what is refused

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
    variables = {joint.variable for joint in robot.movers}
    for path, expression in located_expressions(robot):
        if moving := [name for name in names(expression) if name in variables]:
            found = f"joint variable '{moving[0]}'"
            raise document.error(path, found, "allowed: numbers and parameters", "use another name")
    _check_symbols(document, cells, robot)
    _check_wrench(document, robot)
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
    _check_rods(document, robot, values)
    # numbers for all symbols, random for those without one and those that may change at run time
    source = random.Random(_SEED)
    open_names = sorted(name for name in cells.first_use if name not in values or name in robot.runtime)
    trials = [{**values, **{name: source.uniform(0.1, 0.9) for name in open_names}} for _ in range(_TRIALS)]
    if robot.coupled:
        _check_coupling(document, robot, trials)
    for path, matrix in located_frames(robot):
        check_rotation(document, path, matrix, trials)


def _check_rods(document: Document, robot: Description, values: Mapping[str, float]) -> None:
    for k, loop in enumerate(robot.loops):
        if loop.by is Joining.DISTANCE and (value := _value(loop.length, values)) is not None and value <= 0:
            remedy = "write by: spherical where the origins coincide"
            raise document.error(("loops", k, "length"), f"a rod of {value:g} m", "allowed: more than zero", remedy)


def _check_derived_names(document: Document, cells: Cells, robot: Description) -> None:
    """Velocities and accelerations get names of their own; nothing else may have them."""
    taken: dict[str, str] = {joint.variable: "joint variable" for joint in robot.movers}
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
    variables = {joint.variable for joint in robot.movers}
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


def _check_wrench(document: Document, robot: Description) -> None:
    """Functions under a wrench need bodies, and one end effector that no loop holds."""
    for index, axes in enumerate(robot.wrench):
        if axes in robot.wrench[:index]:
            raise document.error(("wrench", index), f"'{axes}' twice", remedy="remove one")
    if robot.wrench and (robot.is_tree or not robot.links):
        lacks, remedy = ("one chain of joints", "remove it; wrench_torques_END is there for each end")
        if not robot.links:
            lacks, remedy = "links", "add links, or remove it; wrench_torques needs none"
        raise document.error(("wrench",), f"dynamics under a wrench are only of robots with {lacks}", remedy=remedy)


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
    lower, upper = (_value(limit, values) for limit in joint.limits or (ZERO, ONE))
    if lower is not None and upper is not None and not lower < upper:
        found, remedy = "lower limit is not below the upper", "exchange or correct them"
        raise document.error((*place, "limits"), found, "allowed: [lower, upper]", remedy)

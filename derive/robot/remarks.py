"""Remarks on a robot file that is accepted but surely holds a slip: degrees among radians, or a rounded pi/2.

An angle is exact in this program: ``1.5708`` is not pi/2, and its cosine is not 0. Likewise on inertia tensors that no
body has. The second moments of a body about its centre of mass, tr(I)/2 - I, have no negative eigenvalue: no principal
moment of inertia is larger than the sum of the other two. Published tensors often break this; torques may be right all
the same, since they know base parameters alone, but simulators refuse such a body.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from math import pi, tau

from derive.errors import ExpressionError, listed, path_text
from derive.robot import expression as tree
from derive.robot.cells import Cells
from derive.robot.description import INERTIA, Description, FileUnits, Remark
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import Expression, Name, is_constant, names
from derive.robot.reading.document import Document, KeyPath
from derive.robot.tree import located_links
from derive.robot.units import Unit, cell_unit, located_expressions, symbolic_factors, turned_angles

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
    plain = (tree.multiply(tree.number(c), term) for c, term in known)
    try:
        value = evaluate(tree.add(*plain), {})
    except ArithmeticError:
        return None
    shown, twelfths = f"{value:.10g}", round(12 * value / pi)
    near = twelfths != 0 and abs(value - twelfths * pi / 12) <= NEAR * max(1.0, abs(value)) and abs(twelfths) <= 24
    exact = tree.multiple_of_pi(Fraction(twelfths, 12))
    if units.degrees and (units.parameters or not parameter):
        decimals = len(shown.partition(".")[2])
        if not near or motion or decimals < DEGREE_DECIMALS:
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

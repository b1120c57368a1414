"""The part with an example: T, J, B and g in numbers at one configuration, with units.

Matrices and vectors of numbers on the handout.

The configuration of the example: that of the figure, or a generic one within the limits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.handout.context import Context, Numbers
from derive.handout.document import Block, Entry, Formula, Paragraph, Rows, Section
from derive.handout.layout.lines import EQUALS, Equation, equation_lines, fits, matrix, pack
from derive.handout.notation.numbers import magnitude
from derive.handout.notation.pieces import EMPTY, MINUS_WIDTH, Box, Piece, concatenate, italic, joined, script
from derive.handout.notation.symbols import bold
from derive.robot.description import Joint
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, Number, Pi, Product
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

DIGITS = 5
"""Significant digits in print."""

COPIED_DIGITS = 12
"""Significant digits of what is copied: beyond them machines differ."""

NOISE = 1e-12
"""Part of the largest entry below which an entry is zero up to rounding."""

Values = Sequence[Sequence[float]]


def cleaned(rows: Values) -> list[list[float]]:
    """The entries without what only rounding left over."""
    threshold = NOISE * max(1.0, *(abs(value) for row in rows for value in row))
    return [[value if abs(value) > threshold else 0.0 for value in row] for row in rows]


def number(value: float) -> Box:
    """A number with a few significant digits."""
    rounded = Fraction(f"{value:.{DIGITS}g}")
    size = magnitude(rounded, decimals=True, digits=DIGITS)
    return concatenate(Box("-", MINUS_WIDTH), size) if rounded < 0 else size


def matrix_formula(context: Context, symbol: Box, rows: Values, function: str) -> Formula:
    """A matrix; column by column if it is too wide.

    Args:
        context: The handout.
        symbol: Its name.
        rows: Its entries.
        function: The generated function that computes it.
    """
    rows = cleaned(rows)
    box = concatenate(symbol, EQUALS, matrix([[number(value) for value in row] for row in rows]))
    copied = (Entry(symbol.tex, box.tex[len(symbol.tex + EQUALS.tex) :], _python(rows)),)
    blanks = (symbol.tex,)
    if fits(box, len(rows)):
        return Formula((Rows((box.tex,)),), function=function, entries=copied, blanks=blanks)
    lines = tuple(pack(_columns(symbol, rows)))
    note = context.text("Column by column.")
    return Formula((Rows(lines),), note=note, function=function, entries=copied, blanks=blanks)


def vector_formula(names: Sequence[Box], values: Sequence[float], units: Sequence[Box], function: str) -> Formula:
    """Components one by one, each with its unit."""
    values = [row[0] for row in cleaned([[value] for value in values])]
    boxes = [
        concatenate(name, EQUALS, number(value), unit) for name, value, unit in zip(names, values, units, strict=True)
    ]
    entries = tuple(
        Entry(name.tex, number(value).tex, _copied(value)) for name, value in zip(names, values, strict=True)
    )
    return Formula(
        (Rows(tuple(pack(boxes))),), function=function, entries=entries, blanks=tuple(name.tex for name in names)
    )


def _columns(symbol: Box, rows: Values) -> Iterator[Box]:
    for k, column in enumerate(zip(*rows, strict=True), 1):
        entries = matrix([[number(value)] for value in column])
        yield concatenate(script(symbol, italic(str(k))), EQUALS, entries)


def _python(rows: Values) -> str:
    return "[" + ", ".join("[" + ", ".join(map(_copied, row)) + "]" for row in rows) + "]"


def _copied(value: float) -> str:
    return f"{value:.{COPIED_DIGITS}g}"


ANGLES = (1, 2, -1, 3, -2, 4)
"""Joint angles in sixths of pi, and again from the first: generic, so that few entries vanish."""

OFFSET = Number(Fraction(1, 10))
"""Displacement of prismatic joints [m]."""


@dataclass(frozen=True, slots=True)
class Configuration:
    """Values of the joint variables.

    Attributes:
        cells: Exact.
        q: In floats [rad or m].
        stated: Whether the robot file gives them.
    """

    cells: tuple[Expression, ...]
    q: tuple[float, ...]
    stated: bool


def numbers_of(robot: Robot) -> dict[str, float]:
    """Every symbol that has a number, from the parameters or for the figure."""
    found: dict[str, float] = {}
    for name, value in (*robot.parameters, *robot.figure.values):
        if name not in found:
            found[name] = evaluate(value, found)
    return found


def unnumbered(robot: Robot) -> tuple[str, ...]:
    """Symbols of a robot without any number."""
    known = {name for name, _ in (*robot.parameters, *robot.figure.values)}
    return tuple(name for name in robot_symbols(robot) if name not in known)


def configuration(robot: Robot) -> Configuration:
    """Where the example is evaluated."""
    values = numbers_of(robot)
    if robot.figure.q is not None:
        cells = robot.figure.q
    else:
        cells = tuple(_within(joint, _generic(joint, i), values) for i, joint in enumerate(robot.joints))
    q = tuple(evaluate(cell, values) for cell in cells)
    return Configuration(cells, q, robot.figure.q is not None)


def _generic(joint: Joint, index: int) -> Expression:
    if not joint.is_revolute:
        return OFFSET
    return Product((Number(Fraction(ANGLES[index % len(ANGLES)], 6)), Pi()))


def _within(joint: Joint, cell: Expression, values: Mapping[str, float]) -> Expression:
    """The value, or the limit that it exceeds; limits in symbols without numbers do not count."""
    if joint.limits is None:
        return cell
    try:
        lower, upper = (evaluate(limit, values) for limit in joint.limits)
    except (ArithmeticError, KeyError):
        return cell
    value = evaluate(cell, values)
    if value < lower and not math.isclose(value, lower):
        return joint.limits[0]
    if value > upper and not math.isclose(value, upper):
        return joint.limits[1]
    return cell


LARGEST = 24
"""Joints of the largest inertia matrix that is printed in numbers."""

_METRE = Box("\\,\\mathrm{m}", 11.0)
_NEWTON = Box("\\,\\mathrm{N}", 10.0)
_NEWTON_METRE = Box("\\,\\mathrm{N\\,m}", 20.0)
_RADIAN = Box("\\,\\mathrm{rad}", 18.0)


def section(context: Context) -> Section | None:
    """The example; a sentence in its place where symbols have no number."""
    if context.numbers is None:
        return None
    _ = context.text
    return Section("example", _("Example in numbers"), tuple(_blocks(context, context.numbers)))


def _blocks(context: Context, numbers: Numbers) -> Iterator[Block]:
    _ = context.text
    missing = unnumbered(_kinematic(context.robot))
    if missing:
        yield _needs_numbers(context, missing)
        return
    chosen = configuration(context.robot)
    yield from _configuration(context, chosen)
    yield Paragraph(_("The end effector; lengths are in metres:"))
    yield matrix_formula(context, bold("T"), numbers("T", chosen.q), "forward_kinematics")
    yield Paragraph(_jacobian_text(context))
    yield matrix_formula(context, bold("J"), numbers("J", chosen.q), "jacobian")
    if context.robot.has_dynamics:
        yield from _dynamics(context, numbers, chosen.q)


def _kinematic(robot: Robot) -> Robot:
    return replace(robot, links=(), gravity=None)


def _needs_numbers(context: Context, missing: Sequence[str]) -> Block:
    _ = context.text
    symbols = ", ".join(f"${context.notation.glyph(name).box.tex}$" for name in missing)
    return Paragraph(
        _(
            "An example needs numbers for %(symbols)s; they can be given under `parameters:` or `figure: values:` in "
            "the robot file.",
            symbols=symbols,
        )
    )


def _configuration(context: Context, chosen: Configuration) -> Iterator[Block]:
    _ = context.text
    if chosen.stated:
        yield Paragraph(_("At the configuration of the figure:"))
    else:
        yield Paragraph(_("At a configuration without symmetry, within the limits:"))
    yield Rows(tuple(equation_lines(_variables(context, chosen))))
    given = _figure_values(context)
    if given:
        yield Paragraph(_("with these numbers for symbols that have none in the robot file's parameters:"))
        yield Rows(tuple(equation_lines(given)))


def _variables(context: Context, chosen: Configuration) -> Iterator[Equation]:
    data = context.data
    for joint, cell in zip(context.robot.joints, chosen.cells, strict=True):
        pieces = data.angle(cell) if joint.is_revolute else data.value(cell)
        unit = _METRE if not joint.is_revolute else EMPTY if "\\circ" in joined(pieces).tex else _RADIAN
        yield Equation(context.notation.glyph(joint.variable).box, (*pieces, Piece(unit)))


def _figure_values(context: Context) -> list[Equation]:
    """Symbols that have a number for the figure alone."""
    robot, data = context.robot, context.data
    known = {name for name, _ in robot.parameters}
    used = set(robot_symbols(robot)) - known
    return [
        Equation(data.notation.glyph(name).box, data.value(value))
        for name, value in robot.figure.values
        if name in used
    ]


def _jacobian_text(context: Context) -> str:
    _ = context.text
    if all(joint.is_revolute for joint in context.robot.joints):
        return _("The Jacobian; rows 1 to 3 are in metres, rows 4 to 6 without unit:")
    return _("The Jacobian; rows 1 to 3 are in metres in the columns of revolute joints, all else is without unit:")


# -- dynamics


def _inertia_text(context: Context) -> str:
    _ = context.text
    square = "\\mathrm{kg\\,m^2}"
    kinds = {joint.is_revolute for joint in context.robot.joints}
    if kinds == {True}:
        return _("The inertia matrix, in $%(square)s$:", square=square)
    if kinds == {False}:
        return _("The inertia matrix, in kg:")
    return _(
        "The inertia matrix; in $%(square)s$ between revolute joints, in kg between prismatic joints, "
        "in kg m between one and the other:",
        square=square,
    )


def _dynamics(context: Context, numbers: Numbers, q: Sequence[float]) -> Iterator[Block]:
    _ = context.text
    missing = unnumbered(context.robot)
    if missing:
        yield _needs_numbers(context, missing)
        return
    letter = context.symbols.inertia_letter
    if context.robot.n <= LARGEST:
        yield Paragraph(_inertia_text(context))
        yield matrix_formula(context, bold(letter), numbers("B", q), "inertia_matrix")
    else:
        yield Paragraph(_("The inertia matrix is too large to print; `inertia_matrix` computes it."))
    yield Paragraph(_("The gravity vector:"))
    names = [context.symbols.component("g", i) for i in range(1, context.robot.n + 1)]
    units = [_NEWTON_METRE if joint.is_revolute else _NEWTON for joint in context.robot.joints]
    yield vector_formula(names, [row[0] for row in numbers("g", q)], units, "gravity_vector")

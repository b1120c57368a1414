"""The part with an example: T, J, B and g in numbers at the configuration of the figure or a generic one."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction

import numpy as np

from derive.arrays import Array
from derive.errors import DeriveError, ExpressionError
from derive.handouts.layout.lines import Equation, equated, equation_lines, fits, matrix, pack
from derive.handouts.notation.pieces import EMPTY, Box, TexPiece, italic, magnitude, minus, script
from derive.handouts.notation.printer import METRE, RADIAN
from derive.handouts.notation.symbols import bold
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Entry, Rows, SheetFormula
from derive.mechanics.floats import value_at
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, Number, Pi, Product
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot
from derive.robot.tree import massless
from derive.workspace.poses import middle

ANGLES = (1, 2, -1, 3, -2, 4)  # of joints in sixths of pi, and again from the first: generic: few entries vanish
_DISPLACEMENT = Number(Fraction(1, 10))  # of prismatic joints [m]
_DIGITS = 5  # significant digits in print
copied = "{:.12g}".format  # a number to be copied, with twelve digits: beyond them machines differ
_NOISE = 1e-12  # part of the largest entry below which an entry is zero up to rounding
_LARGEST = 24  # joints of the largest inertia matrix that is printed in numbers

Values = Sequence[Sequence[float]]


def example(context: Context) -> Iterator[Block]:
    """T, J, B and g at one configuration; lengths and angles without a number have those of the drawing."""
    given = context.robot
    bare = replace(given, links=(), gravity=None, fixed=massless(given.fixed))
    if context.poses is None and (given.coupled or _unnumbered(bare)):
        return
    assumed: dict[str, Expression] = {
        name: Product((Number(Fraction(1, 6)), Pi())) if unit == "rad" else Number(Fraction(str(value)))
        for name, value, unit in (context.poses.assumed if context.poses is not None else ())
    }
    robot = replace(given, figure=replace(given.figure, values=(*given.figure.values, *assumed.items())))
    cells, q = configuration(robot)
    if context.poses is not None and robot.loops and robot.figure.q is None:
        cells, q = context.poses.zero_cells, context.poses.zero
    yield from _stated(context, cells, assumed)
    rates = np.eye(robot.n)
    if context.poses is not None and robot.coupled:
        try:
            q, rates = context.poses.joints(q), context.poses.rates(q)
        except DeriveError:
            yield context.paragraph("The loops are open at this configuration.")
            return
    task = context.text("Compute the transform of the end effector in numbers, lengths in metres.")
    numbered = [(own, replace(own.robot, figure=replace(robot.figure, q=None))) for own in context.ends]
    for own, arm in numbered:
        yield context.paragraph("The end effector; lengths are in metres:")
        value = value_at(arm, "T", [q[place] for place in own.places])
        yield _matrix(context, own.symbols.of_end("T"), value, own.function("forward_kinematics"), task)
    if all(variable.is_revolute for variable in robot.variables):
        yield context.paragraph("The Jacobian; rows 1 to 3 are in metres, rows 4 to 6 without unit:")
    else:
        yield context.paragraph(
            "The Jacobian; rows 1 to 3 are in metres in the columns of revolute joints, all else is without unit:"
        )
    task = context.text("Compute the Jacobian in numbers.")
    for own, arm in numbered:
        rows = value_at(arm, "J", [q[place] for place in own.places])
        columns = dict(zip(own.places, zip(*rows, strict=True), strict=True))
        spread = [list(row) for row in zip(*(columns.get(k, (0.0,) * 6) for k in range(robot.n)), strict=True)]
        if robot.coupled:
            spread = (np.array(spread) @ rates).tolist()
        yield _matrix(context, own.symbols.of_end("J"), spread, own.function("jacobian"), task)
    if missing := _unnumbered(robot) if robot.has_dynamics else ():
        yield context.answer(
            "Inertia matrix and gravity vector need numbers for %(symbols)s, which the robot file does not give.",
            symbols=", ".join(f"${context.notation.glyph(name).box.tex.strip()}$" for name in missing),
        )
    elif robot.has_dynamics:
        yield from _dynamics(context, robot, q, rates)


def _stated(context: Context, cells: Sequence[Expression], assumed: Mapping[str, Expression]) -> Iterator[Block]:
    """The configuration, the numbers that stand under ``figure:`` alone, and those that nobody gave."""
    robot, data = context.robot, context.data
    if robot.figure.q is not None:
        yield context.paragraph("At the configuration of the figure:")
    else:
        yield context.paragraph("At a configuration without symmetry, within the limits:")
    pairs = zip(robot.variables, cells, strict=True)
    variables = (Equation(data.notation.glyph(j.variable).box, data.position(j, cell)) for j, cell in pairs)
    yield Rows(tuple(equation_lines(variables)))
    used = set(robot_symbols(robot)) - {name for name, _ in robot.parameters}
    given = ((name, cell) for name, cell in robot.figure.values if name in used)
    lines = equation_lines(Equation(data.notation.glyph(name).box, data.symbol(name, cell)) for name, cell in given)
    yield from context.announced("with these numbers for symbols that have none in the robot file's parameters:", lines)
    angle = EMPTY if context.notation.degrees else RADIAN  # degrees have their circle
    units = ((name, cell, METRE if isinstance(cell, Number) else angle) for name, cell in assumed.items())
    lines = equation_lines(
        Equation(data.notation.glyph(name).box, (*data.angle(cell), TexPiece(unit))) for name, cell, unit in units
    )
    yield from context.announced("with numbers assumed for the symbols that have none in the robot file:", lines)


def _dynamics(context: Context, robot: Robot, q: Sequence[float], rates: Array) -> Iterator[Block]:
    matrix, torques = value_at(robot, "B", q), value_at(robot, "g", q)
    if robot.coupled:
        matrix, torques = (rates.T @ matrix @ rates).tolist(), (rates.T @ torques).tolist()
    square = "\\mathrm{kg\\,m^2}"
    if robot.dof > _LARGEST:
        yield context.paragraph("The inertia matrix is too large to print; `inertia_matrix` computes it.")
    else:
        if all(joint.is_revolute for joint in robot.variables):
            yield context.paragraph("The inertia matrix, in $%(square)s$:", square=square)
        elif not any(joint.is_revolute for joint in robot.variables):
            yield context.paragraph("The inertia matrix, in kg:")
        else:
            yield context.paragraph(
                "The inertia matrix; in $%(square)s$ between revolute joints, in kg between prismatic joints, "
                "in kg m between one and the other:",
                square=square,
            )
        task = context.text("Compute the inertia matrix in numbers.")
        yield _matrix(context, bold(context.symbols.inertia_letter), matrix, "inertia_matrix", task)
    yield context.paragraph("The gravity vector:")
    values = [row[0] for row in _cleaned(torques)]
    names = [context.symbols.component("g", i) for i in range(1, robot.dof + 1)]
    numbers = [_number(context, value) for value in values]
    newton, moment = Box("\\,\\mathrm{N}", 10.0), Box("\\,\\mathrm{N\\,m}", 20.0)
    units = [moment if joint.is_revolute else newton for joint in robot.variables]
    lines = tuple(pack(equated(name, *pair) for name, *pair in zip(names, numbers, units, strict=True)))
    rows = zip(names, numbers, values, strict=True)
    entries = tuple(Entry(name.tex, number.tex, copied(value)) for name, number, value in rows)
    blanks = tuple(name.tex for name in names)
    task = context.text("Compute the gravity vector in numbers, each component with its unit.")
    yield SheetFormula((Rows(lines),), function="gravity_vector", entries=lambda: entries, task=task, blanks=blanks)


def _cleaned(rows: Values) -> list[list[float]]:
    """The entries without what only rounding left over."""
    threshold = _NOISE * max(1.0, *(abs(value) for row in rows for value in row))
    return [[value if abs(value) > threshold else 0.0 for value in row] for row in rows]


def _number(context: Context, value: float) -> Box:
    rounded = Fraction(f"{value:.{_DIGITS}g}")
    size = magnitude(rounded, decimals=True, digits=_DIGITS, comma=context.notation.comma)
    return minus(size) if rounded < 0 else size


def copied_rows(rows: Iterable[Sequence[float]]) -> str:
    """A matrix to be copied as Python."""
    return "[" + ", ".join("[" + ", ".join(map(copied, row)) + "]" for row in rows) + "]"


def _matrix(context: Context, symbol: Box, rows: Values, function: str, task: str) -> SheetFormula:
    """A matrix; column by column if it is too wide."""
    rows = _cleaned(rows)
    cells = matrix([[_number(context, value) for value in row] for row in rows])
    box = equated(symbol, cells)
    lines, note = [box.tex], ""
    if not fits(box, len(rows)):
        columns = (matrix([[_number(context, value)] for value in column]) for column in zip(*rows, strict=True))
        lines = pack(equated(script(symbol, italic(str(k))), column) for k, column in enumerate(columns, 1))
        note = context.text("Column by column.")
    entries = (Entry(symbol.tex, cells.tex, copied_rows(rows)),)
    return SheetFormula((Rows(tuple(lines)),), (), (), note, function, lambda: entries, task, (symbol.tex,))


def _unnumbered(robot: Robot) -> tuple[str, ...]:
    known = {name for name, _ in (*robot.parameters, *robot.figure.values)}
    return tuple(name for name in robot_symbols(robot) if name not in known)


def configuration(robot: Robot) -> tuple[Sequence[Expression], tuple[float, ...]]:
    """Where the example is evaluated: values of the joint variables, exact and in floats [rad or m]."""
    values = {name: evaluate(value, {}) for name, value in (*robot.figure.values, *robot.parameters)}
    cells = list(robot.figure.q or ())
    for i, joint in enumerate(() if cells else robot.variables):
        sixths = Number(Fraction(ANGLES[i % len(ANGLES)], 6))
        cell: Expression = Product((sixths, Pi())) if joint.is_revolute else _DISPLACEMENT
        if joint.limits is not None:
            value = evaluate(cell, values)
            with suppress(ArithmeticError, ExpressionError):  # limits in symbols without numbers do not count
                lower, upper = (evaluate(limit, values) for limit in joint.limits)
                if not (lower <= value <= upper or math.isclose(value, lower) or math.isclose(value, upper)):
                    cell = middle(joint)
        cells.append(cell)
    return cells, tuple(evaluate(cell, values) for cell in cells)

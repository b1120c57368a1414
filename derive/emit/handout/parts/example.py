"""The part with an example: T, J, B and g in numbers at one configuration, with units."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from derive.emit.handout.configuration import Configuration, configuration, unnumbered
from derive.emit.handout.context import Context, Numbers
from derive.emit.handout.document import Block, Paragraph, Rows, Section
from derive.emit.handout.numeric import matrix_formula, vector_formula
from derive.emit.latex.layout import Equation, equation_lines
from derive.emit.latex.metrics import EMPTY, Box
from derive.emit.latex.pieces import Piece, joined
from derive.emit.latex.symbols import bold
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

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

"""The parts with the robot's data: the DH table, base and tool, parameters, links."""

from collections.abc import Iterator
from dataclasses import fields
from itertools import chain

import sympy

from derive.handouts.layout.lines import Equation, equation_lines, pack
from derive.handouts.notation.pieces import BRACKET_WIDTH, Box, Break, TexPiece, italic, joined, list_separator, script
from derive.handouts.notation.printer import Cell
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Paragraph, Rows, Table
from derive.handouts.sheet.formula import entry_namer, matrix_lines
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.robot.description import IDENTITY, Link
from derive.robot.expression import ZERO
from derive.robot.inertial_parameters import coulomb_parts
from derive.robot.names import free_symbols
from derive.robot.units import row_in_file_units
from derive.targets.escape import latex_text

BASE = Box("\\mathbf{T}_{\\mathrm{base}}", 30.0)
TOOL = Box("\\mathbf{T}_{\\mathrm{tool}}", 30.0)

_TABLE_WIDTH = 470.0  # room for a table [pt]
_FIRST_COLUMNS = 90.0
_COLUMN_GAP = 12.0
_LONGEST_TABLE = 30  # rows of a table that is kept on one page; a longer one needs two runs of LaTeX to align
_LETTER_WIDTH = 5.2  # of running text in mathematics [pt]

# -- the DH table


def dh_table(context: Context) -> Iterator[Block]:
    """The convention in words, the DH table, base and tool."""
    n = context.robot.n
    standard = context.text("Standard Denavit-Hartenberg convention, %(n)s joints.", n=n)
    modified = context.text("Modified Denavit-Hartenberg convention, %(n)s joints.", n=n)
    yield Paragraph(f"{standard if context.is_standard else modified} {_units(context)}")
    yield table_rows(context)
    if frames := end_lines(context):
        yield context.paragraph(
            "Constant transforms: the base takes frame $0$ into the world, "
            "the tool the end effector into frame $%(n)s$.",
            n=n,
        )
        yield Rows(tuple(frames))


def _units(context: Context) -> str:
    """In which units the numbers of the tables are."""
    _, units = context.text, context.robot.units
    with_degrees = _("Angles with a degree sign are in degrees, all others in radians.")
    angles = with_degrees if units.degrees else _("Angles are in radians.")
    if units.millimetres and units.parameters:
        return f"{angles} {_('Lengths in these tables are in millimetres, all other quantities in SI units.')}"
    if units.millimetres:
        lengths = _("Numbers of lengths in these tables are in millimetres; symbols and all else in SI units.")
        return f"{angles} {lengths}"
    if units.degrees:
        return _(
            "Angles with a degree sign are in degrees; all other quantities are in SI units, lengths in metres and "
            "angles in radians."
        )
    return _("Angles are in radians, lengths in metres, all other quantities in SI units.")


def end_lines(context: Context, base: Box = BASE, tool: Box = TOOL) -> list[str]:
    """Base and tool as matrices, where they are not the identity."""
    lines: list[str] = []
    for symbol, frame in ((base, context.robot.base), (tool, context.robot.tool)):
        if frame != IDENTITY:
            value, length = context.data.value, context.data.length
            rows = [[*map(value, row[:3]), (length if i < 3 else value)(row[3])] for i, row in enumerate(frame)]
            lines += matrix_lines(symbol, rows, entry_namer(symbol))
    return lines


def table_rows(context: Context) -> Block:
    """The table, or its cells joint by joint where it is too wide for the page."""
    _ = context.text
    joints = context.robot.joints
    has_limits = any(joint.limits is not None for joint in joints)
    data, rows = context.data, []
    for joint in joints:
        variable = joint.sign * sympy.Symbol(joint.variable)
        length = row_in_file_units(joint, context.robot.units).d
        theta, d = expression_to_sympy(joint.theta), expression_to_sympy(length)
        theta, d = (theta + variable, d) if joint.is_revolute else (theta, d + variable)
        moving, fixed = [data.angle(theta), data.value(d)], [data.length(joint.a), data.angle(joint.alpha)]
        row = moving + fixed if context.is_standard else fixed[::-1] + moving
        rows.append([*row, data.limits(joint)] if has_limits else row)
    boxes = [[joined(cell) for cell in row] for row in rows]
    widths = (max(box.width for box in column) for column in zip(*boxes, strict=True))
    if _FIRST_COLUMNS + sum(width + _COLUMN_GAP for width in widths) > _TABLE_WIDTH:
        named = (equation_lines(_named_cells(context, i, row)) for i, row in enumerate(rows, 1))
        return Rows(tuple(line for lines in named for line in lines))
    names = ("\\theta_i", "d_i", "a_i", "\\alpha_i")
    if not context.is_standard:
        names = ("\\alpha_{i-1}", "a_{i-1}", "\\theta_i", "d_i")
    header = ("$i$", _("joint"), *(f"${name}$" for name in names), *([_("limits")] if has_limits else []))
    words = {True: _("revolute"), False: _("prismatic")}
    cells = tuple(
        (f"${i}$", words[joint.is_revolute], *(f"${box.tex.strip()}$" for box in row))
        for i, (joint, row) in enumerate(zip(joints, boxes, strict=True), 1)
    )
    return Table(header, cells, len(rows) > _LONGEST_TABLE)


def _named_cells(context: Context, i: int, row: list[Cell]) -> Iterator[Equation]:
    names = ("\\theta", i), ("d", i), ("a", i), ("\\alpha", i)
    if not context.is_standard:
        names = ("\\alpha", i - 1), ("a", i - 1), ("\\theta", i), ("d", i)
    for (letter, index), cell in zip(names, row, strict=False):
        yield Equation(script(Box(letter, 6.5), italic(str(index))), cell)
    if context.robot.joints[i - 1].limits is not None:
        yield Equation(Box(f"\\text{{limits {i}}}", 45.0), row[-1])


# -- parameters and links


def parameters(context: Context) -> Iterator[Block]:
    """Numbers of the robot file, arguments of the generated functions, inertial data of the links."""
    data, glyph = context.data, context.data.notation.glyph
    given = context.robot.parameters
    numbers = equation_lines(Equation(glyph(name).box, data.symbol(name, cell)) for name, cell in given)
    if numbers:
        yield context.paragraph("Numbers given in the robot file:")
        yield Rows(tuple(numbers))
    if free := pack(glyph(name).box for name in free_symbols(context.robot)):
        yield context.paragraph("Arguments of the generated functions, in this order:")
        yield Rows(tuple(free))
    if context.robot.links:
        yield context.paragraph(
            "Links: centre of mass, and inertia about it, in the axes of the link's own frame. Moments of inertia, "
            "motors and friction that are zero are left out."
        )
    for i, link in enumerate(context.robot.links, 1):
        yield context.paragraph("Link %(index)s:", index=i)
        yield Rows(tuple(equation_lines(link_equations(context, link))))


def link_equations(context: Context, link: Link) -> Iterator[Equation]:
    """Mass and centre of mass; inertia, rotor and friction of a link as far as they are not zero."""
    _ = context.text
    yield Equation(_word(_("mass")), context.data.value(link.mass))
    com: list[TexPiece] = [TexPiece(Box("(", BRACKET_WIDTH))]
    parts = [context.data.length(cell) for cell in link.com]
    separator = TexPiece(list_separator(chain(*parts)))
    for index, part in enumerate(parts):
        if index:  # behind a comma a line may be broken
            com.append(separator)
            part = (part[0]._replace(before=Break.COMMA), *part[1:])
        com += part
    yield Equation(_word(_("centre of mass")), (*com, TexPiece(Box(")", BRACKET_WIDTH))))
    cells = [(f"$I_{{{item.name}}}$", getattr(link.inertia, item.name)) for item in fields(link.inertia)]
    if link.motor is not None:
        cells += [
            (_("rotor mass"), link.motor.mass),
            (_("rotor inertia"), link.motor.inertia),
            (_("gear ratio"), link.motor.ratio),
        ]
    cells += [(_("armature"), link.armature), (_("viscous friction"), link.viscous)]
    ways = {"f": "", "fp": " (+)", "fm": " (-)"}
    cells += [(_("Coulomb friction") + ways[part], cell) for part, cell in coulomb_parts(link).items()]
    for label, cell in cells:
        if cell != ZERO:
            yield Equation(_word(label), context.data.value(cell))


def _word(text: str) -> Box:
    escaped = text if text.startswith("$") else latex_text(text)
    return Box(f"\\text{{{escaped}}}", _LETTER_WIDTH * len(text.strip("${}")))

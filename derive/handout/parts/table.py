"""The part with the robot's data: joints, convention in words, the DH table and constant frames.

The part with the numbers: parameters, arguments of the generated functions, inertial data of the links.
"""

from __future__ import annotations

from collections.abc import Iterator

from derive.handout.context import Context
from derive.handout.document import Block, Paragraph, Rows, Section, Table
from derive.handout.frames import constant_frames
from derive.handout.layout.lines import equation_lines, pack
from derive.handout.tables import JointTable, free_boxes, joint_table, link_equations, parameter_equations
from derive.robot.description import Convention


def table_section(context: Context) -> Section:
    """The DH table."""
    _ = context.text
    table = joint_table(context.data)
    blocks: list[Block] = [Paragraph(_facts(context)), _cells(context, table)]
    frames = constant_frames(context.data)
    if frames:
        message = _(
            "Constant transforms: the base takes frame $0$ into the world, "
            "the tool the end effector into frame $%(n)s$.",
            n=context.robot.n,
        )
        blocks += [Paragraph(message), Rows(tuple(frames))]
    return Section("table", _("Denavit-Hartenberg table"), tuple(blocks))


def _facts(context: Context) -> str:
    _ = context.text
    if context.robot.convention is Convention.STANDARD:
        kind = _("Standard Denavit-Hartenberg convention, %(n)s joints.", n=context.robot.n)
    else:
        kind = _("Modified Denavit-Hartenberg convention, %(n)s joints.", n=context.robot.n)
    units = _(
        "Angles are in radians unless marked with a degree sign, lengths in metres, all other quantities in SI units."
    )
    return f"{kind} {units}"


def _cells(context: Context, table: JointTable) -> Block:
    if not table.rows:
        return Rows(table.lines)
    _ = context.text
    standard = context.robot.convention is Convention.STANDARD
    names = (
        ("$\\theta_i$", "$d_i$", "$a_i$", "$\\alpha_i$")
        if standard
        else ("$\\alpha_{i-1}$", "$a_{i-1}$", "$\\theta_i$", "$d_i$")
    )
    header = ("$i$", _("joint"), *names, *([_("limits")] if table.limits else []))
    words = {True: _("revolute"), False: _("prismatic")}
    rows = tuple(
        (f"${i}$", words[joint.is_revolute], *(f"${cell}$" for cell in cells))
        for i, (joint, cells) in enumerate(zip(context.robot.joints, table.rows, strict=True), 1)
    )
    return Table(header, rows, table.long)


def parameters_section(context: Context) -> Section | None:
    """Parameters and links, where the robot file has any."""
    blocks = tuple(_blocks(context))
    return Section("parameters", context.text("Parameters"), blocks) if blocks else None


def _blocks(context: Context) -> Iterator[Block]:
    _ = context.text
    numbers = equation_lines(parameter_equations(context.data))
    if numbers:
        yield Paragraph(_("Numbers given in the robot file:"))
        yield Rows(tuple(numbers))
    free = pack(free_boxes(context.data))
    if free:
        yield Paragraph(_("Arguments of the generated functions, in this order:"))
        yield Rows(tuple(free))
    if context.robot.links:
        yield Paragraph(
            _("Links: centre of mass and inertia about it in the axes of the link's own frame; zeros are left out.")
        )
    for i, link in enumerate(context.robot.links, 1):
        yield Paragraph(_("Link %(index)s:", index=i))
        yield Rows(tuple(equation_lines(link_equations(context.data, link, _))))

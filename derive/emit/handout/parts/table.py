"""The part with the robot's data: joints, convention in words, the DH table and constant frames."""

from __future__ import annotations

from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section, Table
from derive.emit.handout.kinematics import constant_frames
from derive.emit.handout.tables import JointTable, joint_table
from derive.robot.robot import Convention


def section(context: Context) -> Section:
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

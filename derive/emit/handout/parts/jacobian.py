"""The part with the geometric Jacobian: how its columns are made from axes and origins, and the result."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.emit.handout.angles import euler_zyz
from derive.emit.handout.axes import JointAxes, Vector
from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.emit.handout.formula import formula
from derive.emit.handout.kinematics import packed
from derive.emit.latex.layout import pack
from derive.emit.latex.symbols import EntryNamer, bold
from derive.robot.robot import Convention


def section(context: Context) -> Section:
    """J."""
    _ = context.text
    block = context.layouter.block(bold("J"), EntryNamer(context.symbols, "J"), context.quantities["J"], group=1)
    blocks: list[Block] = [
        Paragraph(
            _(
                "In the world frame, linear velocity of the end effector in rows 1 to 3, angular velocity in rows "
                "4 to 6."
            )
        ),
        *_construction(context),
        *_steps(context),
        formula(context, block, "jacobian"),
        *_analytic(context),
    ]
    return Section("jacobian", _("Geometric Jacobian"), tuple(blocks))


def _construction(context: Context) -> Iterator[Block]:
    _ = context.text
    joints, axes = context.robot.joints, JointAxes(context)
    yield Paragraph(_axis_text(context))
    if any(joint.is_revolute for joint in joints):
        yield Paragraph(_("The column of a revolute joint is"))
        yield Rows((axes.general(revolute=True).tex,))
    if not all(joint.is_revolute for joint in joints):
        yield Paragraph(_("The column of a prismatic joint is"))
        yield Rows((axes.general(revolute=False).tex,))
    if any(joint.sign < 0 for joint in joints):
        yield Paragraph(_("with the opposite sign where the joint variable has a minus sign in the table."))
    summary = axes.summary()
    if summary is not None:
        yield Paragraph(_("so that for this arm"))
        yield Rows((summary.tex,))


def _axis_text(context: Context) -> str:
    _ = context.text
    if context.robot.convention is Convention.STANDARD:
        return _(
            "Joint $i$ moves about or along $%(z)s$, the axis $z$ of frame $i-1$, through its origin $%(o)s$; "
            "$%(p)s$ is the origin of the end effector, all in the world.",
            z="\\mathbf{z}_{i-1}",
            o="\\mathbf{o}_{i-1}",
            p="\\mathbf{p}",
        )
    return _(
        "Joint $i$ moves about or along $%(z)s$, the axis $z$ of frame $i$, through its origin $%(o)s$; "
        "$%(p)s$ is the origin of the end effector, all in the world.",
        z="\\mathbf{z}_{i}",
        o="\\mathbf{o}_{i}",
        p="\\mathbf{p}",
    )


# -- steps


def _steps(context: Context) -> Iterator[Block]:
    if context.steps:
        yield Steps(context.text("Axes, origins and columns"), tuple(_step_blocks(context)))


def _step_blocks(context: Context) -> Iterator[Block]:
    _ = context.text
    axes = JointAxes(context)
    joints = range(1, context.robot.n + 1)
    turning = [i for i in joints if context.robot.joints[i - 1].is_revolute]
    origins = [*(axes.origin(i) for i in turning), axes.end()] if turning else []
    for title, vectors in (
        (_("Axes:"), [axes.axis(i) for i in joints]),
        (_("Origins, and that of the end effector:"), origins),
        (_("Columns:"), [axes.column(i) for i in joints]),
    ):
        if vectors:
            yield Paragraph(title)
            yield from _vectors(context, vectors)


def _vectors(context: Context, vectors: Sequence[Vector]) -> Iterator[Block]:
    """Those that fit share lines; then those by their entries, and those whose entries are too long."""
    fitting = [vector.whole for vector in vectors if vector.whole is not None]
    if fitting:
        yield formula(context, packed(fitting))
    yield from (formula(context, vector.entries) for vector in vectors if vector.entries is not None)
    left = [vector.box for vector in vectors if vector.whole is None and vector.entries is None]
    if left:
        yield Paragraph(context.text("Too long for a step:"))
        yield Rows(tuple(pack(left)))


# -- analytic


def _analytic(context: Context) -> Iterator[Block]:
    """How the Jacobian of the angles ZYZ follows, where they are not singular in every configuration."""
    end = context.quantities["T"]
    if not (end.terms(1, 3) or end.terms(2, 3)):
        return
    _ = context.text
    phi, theta, psi = (name.tex.strip() for name in euler_zyz(context).names)
    yield Paragraph(
        _(
            "The analytic Jacobian for Euler angles ZYZ, $%(angles)s$, has the same linear rows; its angular rows are "
            "those of $%(jacobian)s$ multiplied from the left by the inverse of",
            angles=f"{phi}, {theta}, {psi}",
            jacobian="\\mathbf{J}",
        )
    )
    rows = (
        f"0 & -\\sin {phi} & \\cos {phi}\\,\\sin {theta}",
        f"0 & \\cos {phi} & \\sin {phi}\\,\\sin {theta}",
        f"1 & 0 & \\cos {theta}",
    )
    body = " \\\\ ".join(rows)
    yield Rows((f"\\begin{{bmatrix}} {body} \\end{{bmatrix}}",))

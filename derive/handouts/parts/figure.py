"""The parts with pictures: the arm with its frames, and the convention with its four parameters."""

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction

from derive.errors import DeriveError
from derive.handouts.figure.arm import arm_drawing, arm_view
from derive.handouts.figure.convention import convention_drawing
from derive.handouts.figure.projection import View
from derive.handouts.figure.scene import arm_scene
from derive.handouts.notation.pieces import EMPTY, joined, magnitude
from derive.handouts.sheet.context import Context, textbook
from derive.handouts.sheet.document import Block, Figure, Paragraph
from derive.robot import tree
from derive.robot.description import Joint, Variable
from derive.robot.expression import ZERO, Expression
from derive.workspace.poses import RobotPoses

Frames = Sequence[Sequence[Sequence[float]]]  # 4x4 each
_DIGITS = 4  # significant digits of a number in a caption


def arm(context: Context) -> tuple[Block, ...]:
    """The arm at its zero configuration and at the one that the robot file asks for."""
    try:
        return () if context.poses is None else tuple(_figures(context, context.poses))
    except DeriveError:  # a value that does not exist with the numbers of the figure
        return (context.paragraph("The loops are open at this configuration."),) if context.robot.loops else ()


def _figures(context: Context, poses: RobotPoses) -> Iterator[Block]:
    chosen = poses.configuration
    frames = [poses.frames(poses.zero)] + ([poses.frames(chosen)] if chosen is not None else [])
    view = arm_view(arm_scene(context.robot, frames[-1]))
    yield from (_tree if context.robot.is_tree else _arm)(context, poses, frames, view)
    yield context.paragraph("Axes x are red, y green and z blue; cylinders are revolute joints, boxes prismatic ones.")
    if poses.assumed:
        values = stated_values(context, poses.assumed)
        yield context.paragraph("Numbers assumed for the drawing only: %(values)s.", values=values)


def _arm(context: Context, poses: RobotPoses, frames: Sequence[Frames], view: View) -> Iterator[Block]:
    _, robot = context.text, context.robot
    title = _("The arm with its Denavit-Hartenberg frames at the zero configuration")
    caption = _("The arm with its Denavit-Hartenberg frames at the zero configuration.")
    moved = [(joint, cell) for joint, cell in zip(robot.joints, poses.zero_cells, strict=True) if cell != ZERO]
    if moved:
        title = _("The arm with its Denavit-Hartenberg frames")
        caption = _(
            "The arm with its Denavit-Hartenberg frames at the zero configuration; joints whose limits exclude zero "
            "are in the middle of their limits: %(values)s.",
            values=_positions(context, moved),
        )
    yield Figure(arm_drawing(robot, context.data, frames[0], title, view), caption)
    if len(frames) > 1:
        title = _("The arm with its Denavit-Hartenberg frames at the configuration of the figure")
        caption = _(
            "The arm with its Denavit-Hartenberg frames at %(configuration)s.",
            configuration=_positions(context, list(zip(robot.joints, robot.figure.q or (), strict=True))),
        )
        yield Figure(arm_drawing(robot, context.data, frames[1], title, view), caption)


def _tree(context: Context, poses: RobotPoses, frames: Sequence[Frames], view: View) -> Iterator[Block]:
    """The tree at the configuration that the robot file asks for, else at the zero configuration."""
    _, robot = context.text, context.robot
    cells = zip(robot.variables, robot.figure.q or poses.zero_cells, strict=True)
    values = _positions(context, [(joint, cell) for joint, cell in cells if cell != ZERO])
    where = values or "$\\mathbf{q} = \\mathbf{0}$"
    caption = _("The robot with its Denavit-Hartenberg frames at %(configuration)s.", configuration=where)
    title = _("The robot with its Denavit-Hartenberg frames")
    yield Figure(arm_drawing(robot, context.data, frames[-1], title, view), caption)


def _positions(context: Context, values: Sequence[tuple[Joint | Variable, Expression]]) -> str:
    return context.text.listing(
        f"${context.notation.glyph(joint.variable).box.tex.strip()} = {joined(context.data.position(joint, cell)).tex}$"
        for joint, cell in values
    )


def stated_values(context: Context, values: Sequence[tuple[str, float, str]]) -> str:
    """Symbols with the numbers that are drawn and their units: ``$a_1 = 0.5 m$, ...``."""
    written = []
    for name, value, unit in values:
        if unit == "rad" and context.notation.degrees:
            value, unit = math.degrees(value), "^{\\circ}"
        size = magnitude(Fraction(value), decimals=True, digits=_DIGITS, comma=context.text.comma).tex
        number = f"-{size}" if value < 0 else size
        behind = unit if "circ" in unit else f"\\,\\mathrm{{{unit}}}"
        written.append(f"${context.notation.glyph(name).box.tex.strip()} = {number}{behind}$")
    return context.text.listing(written)


def convention(context: Context) -> Iterator[Block]:
    """The general A matrix of the convention, its picture, and how sines and cosines are abbreviated."""
    _ = context.text
    if context.robot.is_tree:
        yield context.paragraph(
            "Row $i$ of the table takes its frame into frame $p$, that of the row which it follows; a mount "
            "$\\mathbf{M}_i$ is the identity where none is given:"
        )
        turned = any(stand.gamma != ZERO or stand.b != ZERO for stand in tree.stands(context.robot))
        symbol = context.symbols.frame("A", "i", "p").tex
        yield textbook("row_of_tree", A=symbol, standard=context.is_standard, turned=turned)
    else:
        symbol = context.symbols.frame("A", "i", "i-1").tex
        yield context.paragraph("Row $i$ of the table takes frame $i$ into frame $i-1$:")
        name = "standard_convention" if context.is_standard else "modified_convention"
        yield textbook(name, A=symbol, blank=f"\\phantom{{{symbol}}}")
        yield Figure(convention_drawing(context.robot.convention), _("The four parameters of row $i$."))
    texts, notation, labelled = [], context.notation, tuple(context.notation.labels)
    if labelled and notation.abbreviates:
        angle = notation.glyph(labelled[0]).box.tex
        short = [
            f"${notation.abbreviation('c', labelled[:1], EMPTY).tex} = \\cos {angle}$",
            f"${notation.abbreviation('s', labelled[:1], EMPTY).tex} = \\sin {angle}$",
        ]
        if len(labelled) > 1:
            total = " + ".join(notation.glyph(name).box.tex for name in labelled[:2])
            short.append(f"${notation.abbreviation('c', labelled[:2], EMPTY).tex} = \\cos({total})$")
        texts.append(
            _(
                "%(examples)s, and so on: the labels are the digits in the names of the joint variables.",
                examples=", ".join(short),
            )
        )
    texts.append(_("A dot is a derivative with respect to time."))
    if notation.decimals:
        texts.append(
            _(
                "Decimal numbers in the equations are rounded to %(digits)s significant digits; "
                "the generated code is not.",
                digits=notation.digits,
            )
        )
    yield Paragraph(" ".join(texts))

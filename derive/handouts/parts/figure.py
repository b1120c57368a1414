"""The parts with pictures: the arm with its frames, and the convention with its four parameters.

Source of the latter: the figures in Siciliano et al., Robotics: Modelling, Planning and Control, ch. 2.8 (standard),
and Craig, Introduction to Robotics, ch. 3.4 (modified).
"""

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np

from derive.arrays import Array
from derive.errors import DeriveError
from derive.handouts.figure.arm import arm_drawing, arm_view
from derive.handouts.figure.drawing import BLACK, Color, Drawing, Path
from derive.handouts.figure.paper import AXIS_COLORS, DIMENSION, Paper, around, arrow_head, moved
from derive.handouts.figure.projection import REVOLUTE, View, paint, prism
from derive.handouts.figure.scene import Frames, arm_scene
from derive.handouts.notation.pieces import EMPTY, joined, magnitude
from derive.handouts.sheet.context import Context, textbook
from derive.handouts.sheet.document import Block, Figure, Paragraph
from derive.robot import tree
from derive.robot.description import Convention, Joint, Variable
from derive.robot.expression import ZERO, Expression
from derive.workspace.poses import RobotPoses

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
    glyph, write = context.notation.glyph, context.data.position
    pairs = ((glyph(joint.variable).box.tex.strip(), joined(write(joint, cell)).tex) for joint, cell in values)
    return context.text.listing(f"${symbol} = {value}$" for symbol, value in pairs)


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
        cosine, sine = (notation.abbreviation(letter, labelled[:1], EMPTY).tex for letter in "cs")
        short = [f"${cosine} = \\cos {angle}$", f"${sine} = \\sin {angle}$"]
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


# -- the picture of the convention

_X, _Z = np.array((1.0, 0.0, 0.0)), np.array((0.0, 0.0, 1.0))
_ALPHA, _THETA = math.radians(38), math.radians(52)
_A, _D = 150.0, 78.0
_AXIS = 58.0
_ARC = 34.0
_GREY: Color = (0.45, 0.45, 0.45)
_VIEW = View(math.radians(-58), math.radians(24))


def convention_drawing(convention: Convention) -> Drawing:
    """Frames i-1 and i with a, alpha, d and theta of row i."""
    paper, origin, z_after = Paper(), np.zeros(3), _turned(_Z, _X, _ALPHA)
    if convention is Convention.STANDARD:
        # d along z_{i-1} to the common normal, a along it; theta turns x_{i-1} into x_i, alpha z_{i-1} into z_i
        title = "d_i, theta_i, a_i, alpha_i between frames i-1 and i"
        foot, x_before, x_after = _D * _Z, _turned(_X, _Z, -_THETA), _X
        joint = second = foot + _A * _X
        ends = [foot + 62 * _Z, second + 44 * z_after]
        carried = [(second, 52 * _Z), (foot, 60 * x_before)]
        solid = [(foot, second)]
        arcs = [(foot, x_before, _Z, _THETA, r"\theta_{i}"), (second, _Z, _X, _ALPHA, r"\alpha_{i}")]
        lengths = [(origin, foot, -24.0, "d_{i}"), (foot, second, -20.0, "a_{i}")]
    else:
        # a along x_{i-1}, the common normal, d along z_i; alpha turns z_{i-1} into z_i, theta x_{i-1} into x_i
        title = "alpha_{i-1}, a_{i-1}, d_i, theta_i between frames i-1 and i"
        joint = foot = _A * _X
        second, x_before, x_after = foot + _D * z_after, _X, _turned(_X, z_after, _THETA)
        ends = [origin + 84 * _Z, second + 80 * z_after]
        carried = [(foot, 62 * _Z), (second, 60 * _X)]
        solid = [(origin, foot), (foot, second)]
        arcs = [(second, _X, z_after, _THETA, r"\theta_{i}"), (foot, _Z, _X, _ALPHA, r"\alpha_{i-1}")]
        lengths = [(origin, foot, 18.0, "a_{i-1}")]
    _joint(paper, origin - 34 * _Z, _Z)
    _joint(paper, joint - 42 * z_after, z_after)
    axes = zip((origin - 62 * _Z, joint - 68 * z_after), ends, strict=True)
    for start, end in (*axes, *((place, place + way) for place, way in carried)):
        # an axis, or a direction carried over from elsewhere
        paper.draw(Path((_VIEW.flat(start), _VIEW.flat(end)), stroke=_GREY, width=0.5, dashed=True), weight=0.7)
    for start, end in solid:
        paper.draw(Path((_VIEW.flat(start), _VIEW.flat(end)), width=1.1))
    if convention is Convention.MODIFIED:
        a, b = _VIEW.flat(foot), _VIEW.flat(second)
        paper.label("d_{i}", around(((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), (a[1] - b[1], b[0] - a[0]), 9.0))
    _axis(paper, origin, _Z, 2, "z_{i-1}")
    _axis(paper, origin, x_before, 0, "x_{i-1}")
    _axis(paper, second, z_after, 2, "z_{i}")
    _axis(paper, second, x_after, 0, "x_{i}")
    for center, start, axis, angle, latex in arcs:
        points = [_VIEW.flat(center + _ARC * _turned(start, axis, angle * k / 24)) for k in range(25)]
        paper.draw(Path(tuple(points[:-2]), width=0.8))
        paper.draw(arrow_head(points[-6], points[-1], BLACK, 0.8))
        middle, heart = points[12], _VIEW.flat(center)
        paper.label(latex, around(middle, (middle[0] - heart[0], middle[1] - heart[1]), 9.0))
    for length in lengths:
        _length(paper, *length)
    return moved(paper.items, 4.0, title)


def _joint(paper: Paper, center: Array, axis: Array) -> None:
    for path in paint(prism(center - 13 * axis, center + 13 * axis, 10.0, REVOLUTE, sides=28), _VIEW):
        paper.draw(path, weight=0.2)


def _axis(paper: Paper, origin: Array, direction: Array, letter: int, latex: str) -> None:
    start, tip = _VIEW.flat(origin), _VIEW.flat(origin + _AXIS * direction)
    paper.arrow(start, tip, AXIS_COLORS[letter], 1.3)
    paper.label(latex, around(tip, (tip[0] - start[0], tip[1] - start[1]), 10.0), AXIS_COLORS[letter])


def _length(paper: Paper, start: Array, end: Array, offset: float, latex: str) -> None:
    a, b = _VIEW.flat(start), _VIEW.flat(end)
    size = math.hypot(b[0] - a[0], b[1] - a[1])
    nx, ny = -(b[1] - a[1]) / size * -offset, (b[0] - a[0]) / size * -offset
    c, d = (a[0] + nx, a[1] + ny), (b[0] + nx, b[1] + ny)
    for near, far in ((a, c), (b, d)):
        paper.draw(Path((near, far), stroke=DIMENSION, width=0.3), weight=0.4)
    paper.arrow(c, d, DIMENSION, 0.5, both=True)
    paper.label(latex, around(((c[0] + d[0]) / 2, (c[1] + d[1]) / 2), (nx, ny), 9.0))


def _turned(vector: Array, axis: Array, angle: float) -> Array:
    """A vector turned about a unit axis (Rodrigues)."""
    along = axis * (axis @ vector)
    return np.asarray(along + math.cos(angle) * (vector - along) + math.sin(angle) * np.cross(axis, vector))

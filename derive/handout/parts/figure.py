"""The arm at its zero configuration and at the configuration that the robot file asks for.

The part with the convention: the general A matrix, its picture, and how sines and cosines are abbreviated.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.errors import DeriveError
from derive.handout.context import Context, Pose, Poses
from derive.handout.document import Block, Figure, Paragraph, Rows, Section
from derive.handout.figure.arm import arm_drawing, arm_view
from derive.handout.figure.convention import convention_drawing
from derive.handout.figure.projection import View
from derive.handout.figure.scene import arm_scene
from derive.handout.notation.pieces import EMPTY
from derive.robot.description import Convention
from derive.robot.style import Functions

_DIGITS = 4


def figure_section(context: Context) -> Section | None:
    """The figures; None where nothing is drawn."""
    if context.poses is None:
        return None
    try:
        blocks = tuple(_blocks(context, context.poses))
    except DeriveError:  # a value that does not exist with the numbers of the figure
        return None
    return Section("figure", context.text("The arm"), blocks)


def _blocks(context: Context, poses: Poses) -> Iterator[Block]:
    _ = context.text
    zero, chosen = poses.frames(poses.zero), poses.configuration
    view = arm_view(arm_scene(context.robot, zero if chosen is None else poses.frames(chosen)))
    title = _("The arm with its Denavit-Hartenberg frames at the zero configuration")
    caption = _("The arm with its Denavit-Hartenberg frames at the zero configuration.")
    yield _figure(context, zero, title, caption, view)
    if chosen is not None:
        title = _("The arm with its Denavit-Hartenberg frames at the configuration of the figure")
        caption = _(
            "The arm with its Denavit-Hartenberg frames at %(configuration)s.",
            configuration=_configuration(context, chosen),
        )
        yield _figure(context, poses.frames(chosen), title, caption, view)
    yield Paragraph(_("Axes x are red, y green and z blue; cylinders are revolute joints, boxes prismatic ones."))
    if poses.assumed:
        yield Paragraph(_("Numbers assumed for the drawing only: %(values)s.", values=_assumed(context, poses.assumed)))


def _figure(context: Context, frames: Sequence[Pose], title: str, caption: str, view: View) -> Figure:
    return Figure(arm_drawing(context.robot, context.data, frames, title, view), caption)


def _configuration(context: Context, q: Sequence[float]) -> str:
    joints = zip(context.robot.joints, q, strict=True)
    return ", ".join(
        f"${_name(context, joint.variable)} = {_number(value)}\\,\\mathrm{{{'rad' if joint.is_revolute else 'm'}}}$"
        for joint, value in joints
    )


def _assumed(context: Context, values: Sequence[tuple[str, float, str]]) -> str:
    return ", ".join(
        f"${_name(context, name)} = {_number(value)}\\,\\mathrm{{{unit}}}$" for name, value, unit in values
    )


def _name(context: Context, name: str) -> str:
    return context.notation.glyph(name).box.tex.strip()


def _number(value: float) -> str:
    text = f"{value:.{_DIGITS}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


_STANDARD = (
    r"= \mathrm{Rot}(z,\theta_i)\,\mathrm{Trans}(z,d_i)\,\mathrm{Trans}(x,a_i)\,\mathrm{Rot}(x,\alpha_i)",
    r"= \begin{bmatrix} "
    r"\cos\theta_i & -\sin\theta_i\cos\alpha_i & \sin\theta_i\sin\alpha_i & a_i\cos\theta_i \\ "
    r"\sin\theta_i & \cos\theta_i\cos\alpha_i & -\cos\theta_i\sin\alpha_i & a_i\sin\theta_i \\ "
    r"0 & \sin\alpha_i & \cos\alpha_i & d_i \\ 0 & 0 & 0 & 1 \end{bmatrix}",
)
_MODIFIED = (
    r"= \mathrm{Rot}(x,\alpha_{i-1})\,\mathrm{Trans}(x,a_{i-1})\,\mathrm{Rot}(z,\theta_i)\,\mathrm{Trans}(z,d_i)",
    r"= \begin{bmatrix} \cos\theta_i & -\sin\theta_i & 0 & a_{i-1} \\ "
    r"\sin\theta_i\cos\alpha_{i-1} & \cos\theta_i\cos\alpha_{i-1} & -\sin\alpha_{i-1} & -d_i\sin\alpha_{i-1} \\ "
    r"\sin\theta_i\sin\alpha_{i-1} & \cos\theta_i\sin\alpha_{i-1} & \cos\alpha_{i-1} & d_i\cos\alpha_{i-1} \\ "
    r"0 & 0 & 0 & 1 \end{bmatrix}",
)


def convention_section(context: Context) -> Section:
    """The convention of the table and of the abbreviations."""
    _ = context.text
    standard = context.robot.convention is Convention.STANDARD
    product, matrix = _STANDARD if standard else _MODIFIED
    symbol = context.symbols.frame("A", "i", "i-1").tex
    blocks: list[Block] = [
        Paragraph(_("Row $i$ of the table takes frame $i$ into frame $i-1$:")),
        Rows((f"{symbol} {product}", f"\\phantom{{{symbol}}} {matrix}")),
        Figure(convention_drawing(context.robot.convention), _("The four parameters of row $i$.")),
    ]
    return Section("convention", _("Convention"), (*blocks, *_notation(context)))


def _notation(context: Context) -> list[Block]:
    _ = context.text
    texts = [*_abbreviations(context), _("A dot is a derivative with respect to time.")]
    if context.notation.decimals:
        texts.append(
            _(
                "Decimal numbers in the equations are rounded to %(digits)s significant digits; "
                "the generated code is not.",
                digits=context.notation.digits,
            )
        )
    return [Paragraph(" ".join(texts))]


def _abbreviations(context: Context) -> list[str]:
    notation = context.notation
    labelled = tuple(notation.labels)
    if not labelled or context.options.notation.functions is Functions.FULL:
        return []
    _ = context.text
    angle = notation.glyph(labelled[0]).box.tex
    short = [
        f"${notation.abbreviation('c', labelled[:1], EMPTY).tex} = \\cos {angle}$",
        f"${notation.abbreviation('s', labelled[:1], EMPTY).tex} = \\sin {angle}$",
    ]
    if len(labelled) > 1:
        total = " + ".join(notation.glyph(name).box.tex for name in labelled[:2])
        short.append(f"${notation.abbreviation('c', labelled[:2], EMPTY).tex} = \\cos({total})$")
    rule = _(
        "%(examples)s, and so on: the labels are the digits in the names of the joint variables.",
        examples=", ".join(short),
    )
    return [rule]

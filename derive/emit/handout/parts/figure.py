"""The arm at its zero configuration and at the configuration that the robot file asks for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.emit.figure.arm import arm_drawing, arm_view
from derive.emit.figure.projection import View
from derive.emit.figure.scene import arm_scene
from derive.emit.handout.context import Context, Pose, Poses
from derive.emit.handout.document import Block, Figure, Paragraph, Section
from derive.errors import DeriveError

_DIGITS = 4


def section(context: Context) -> Section | None:
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

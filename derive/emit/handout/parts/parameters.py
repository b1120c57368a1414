"""The part with the numbers: parameters, arguments of the generated functions, inertial data of the links."""

from __future__ import annotations

from collections.abc import Iterator

from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section
from derive.emit.handout.tables import free_boxes, link_equations, parameter_equations
from derive.emit.latex.layout import equation_lines, pack


def section(context: Context) -> Section | None:
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

"""The part with the equations of motion."""

from __future__ import annotations

from collections.abc import Iterator

from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.emit.handout.formula import formula
from derive.robot.expression import ZERO

_FUNCTION = "inverse_dynamics"


def section(context: Context) -> Section | None:
    """tau = B qdd + C qd + g + friction, term by term."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    return Section("motion", _("Equations of motion"), tuple(_blocks(context)))


def _blocks(context: Context) -> Iterator[Block]:
    _ = context.text
    forms = context.rate_forms
    yield Rows(tuple(_general(context)))
    if forms.torque_long:
        yield Paragraph(
            _(
                "Written out, even with the entries and symbols above, they are too long to print; `inverse_dynamics` "
                "in `model_numpy.py` computes them."
            )
        )
    elif forms.torque_named:
        yield Paragraph(_("With the entries and symbols above:"))
        yield formula(context, forms.motion(), _FUNCTION)
    else:
        if context.steps:
            yield Steps(_("With the entries and symbols above"), (Rows(forms.motion().lines),))
        yield formula(context, context.dynamics.torque(), _FUNCTION)


def _general(context: Context) -> Iterator[str]:
    letter = context.dynamics.letter
    friction = any(link.viscous != ZERO or link.coulomb != ZERO for link in context.robot.links)
    yield (
        f"\\boldsymbol{{\\tau}} = \\mathbf{{{letter}}}(\\mathbf{{q}})\\,\\ddot{{\\mathbf{{q}}}} + "
        "\\mathbf{C}(\\mathbf{q},\\dot{\\mathbf{q}})\\,\\dot{\\mathbf{q}} + \\mathbf{g}(\\mathbf{q})"
        + (" + \\boldsymbol{\\tau}_f(\\dot{\\mathbf{q}})" if friction else "")
    )
    if friction:
        yield "\\tau_{f,i} = b_i\\,\\dot{q}_i + f_i\\operatorname{sgn}(\\dot{q}_i)"

"""The part with the gravity vector."""

from __future__ import annotations

from collections.abc import Iterator

from derive.emit.handout.bodies import bodies
from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section
from derive.emit.handout.formula import formula


def section(context: Context) -> Section | None:
    """g, the gradient of the potential energy."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    return Section("gravity", _("Gravity"), tuple(_blocks(context)))


def _blocks(context: Context) -> Iterator[Block]:
    _ = context.text
    if context.robot.gravity is None:
        yield Paragraph(_("The robot file gives no gravity: $\\mathbf{g} = \\mathbf{0}$."))
        return
    yield Paragraph(_("The gradient of the potential energy."))
    yield Rows((_definition(context),))
    yield formula(context, context.dynamics.gravity(), "gravity_vector")


def _definition(context: Context) -> str:
    weights = "m_{l_j}\\,\\mathbf{g}_0^T \\mathbf{J}_{v,i}^{l_j}"
    if any(body.is_rotor for body in bodies(context.robot)):
        weights = f"\\left( {weights} + m_{{m_j}}\\,\\mathbf{{g}}_0^T \\mathbf{{J}}_{{v,i}}^{{m_j}} \\right)"
    return f"g_i = \\frac{{\\partial\\,\\mathcal{{U}}}}{{\\partial q_i}} = -\\sum_{{j}} {weights}"

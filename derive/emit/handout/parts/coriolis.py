"""The part with the Coriolis matrix."""

from __future__ import annotations

from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.emit.handout.formula import formula


def section(context: Context) -> Section | None:
    """C by Christoffel symbols."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    forms = context.rate_forms
    symbol = context.symbols.christoffel_of("i", "j", "k").tex
    blocks: list[Block] = [
        Paragraph(
            _("Centrifugal and Coriolis terms; this choice of $\\mathbf{C}$ makes $\\mathbf{N}$ skew-symmetric.")
        ),
        Rows((f"C_{{ij}} = \\sum_{{k}} {symbol}\\,\\dot{{q}}_k",)),
    ]
    if forms.coriolis_named:
        blocks += [Paragraph(_("With the Christoffel symbols above:")), formula(context, forms.coriolis(), _FUNCTION)]
    else:
        if context.steps and context.dynamics.triples:
            blocks.append(Steps(_("By Christoffel symbols"), (Rows(forms.coriolis().lines),)))
        blocks.append(formula(context, context.dynamics.closed("C", 4), _FUNCTION))
    return Section("coriolis", _("Coriolis matrix"), tuple(blocks))


_FUNCTION = "coriolis_matrix"

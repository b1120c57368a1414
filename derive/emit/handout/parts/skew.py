"""The part with N = dB/dt - 2C and the check that it is skew-symmetric."""

from __future__ import annotations

from collections.abc import Iterator

from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.emit.handout.formula import formula

_FUNCTION = "coriolis_matrix"


def section(context: Context) -> Section | None:
    """N and its check."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    return Section("skew", _("Skew symmetry"), tuple(_blocks(context)))


def _blocks(context: Context) -> Iterator[Block]:
    _ = context.text
    forms, letter = context.rate_forms, context.dynamics.letter
    yield Rows((f"\\mathbf{{N}} = \\dot{{\\mathbf{{{letter}}}}} - 2\\mathbf{{C}}",))
    yield from _identity(context)
    derivative = forms.bdot() if context.steps else None
    if derivative is not None:
        yield Steps(_("Derivative of the inertia matrix with respect to time"), (formula(context, derivative),))
    if forms.skew_named:
        yield Paragraph(_("The entries above the diagonal; those below are their opposites, those on it are zero."))
        yield formula(context, forms.skew(), _FUNCTION)
    else:
        yield formula(context, context.dynamics.closed("N", 5), _FUNCTION)
    if forms.is_skew():
        yield Paragraph(
            _(
                "Check: multiplied out, the entries of $\\mathbf{N} + \\mathbf{N}^T$ cancel one by one, so that "
                "$\\mathbf{N} + \\mathbf{N}^T = \\mathbf{0}$."
            )
        )


def _identity(context: Context) -> Iterator[Block]:
    """Why N is skew-symmetric for any robot."""
    _ = context.text
    b, christoffel = context.dynamics.letter.lower(), context.symbols.christoffel_of
    first, second = christoffel("i", "j", "k").tex, christoffel("j", "i", "k").tex
    yield Paragraph(
        _(
            "The derivatives of the inertia matrix are sums of Christoffel symbols; hence "
            "$\\mathbf{N}^T = -\\mathbf{N}$."
        )
    )
    yield Rows(
        (
            f"\\frac{{\\partial {b}_{{ij}}}}{{\\partial q_k}} = {first} + {second} \\qquad "
            f"N_{{ij}} = \\sum_{{k}} \\left({second} - {first}\\right)\\dot{{q}}_k = -N_{{ji}}",
        )
    )

"""The part with the Christoffel symbols."""

from __future__ import annotations

from collections.abc import Iterator

from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.emit.handout.formula import formula
from derive.emit.latex.layout import Equation, equation_lines
from derive.emit.latex.metrics import Box, concatenate, fraction


def section(context: Context) -> Section | None:
    """The symbols that are not zero."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    blocks: list[Block] = [
        Paragraph(
            _("The Christoffel symbols follow from the inertia matrix; each is symmetric in its last two indices.")
        ),
        Rows((definition(context),)),
    ]
    block = context.dynamics.christoffel()
    if not context.dynamics.triples:
        return Section("christoffel", _("Christoffel symbols"), (*blocks, Paragraph(_("All are zero."))))
    if context.steps:
        blocks += _steps(context)
    blocks.append(formula(context, block, "coriolis_matrix"))
    return Section("christoffel", _("Christoffel symbols"), tuple(blocks))


def definition(context: Context) -> str:
    """c_i,jk by derivatives of entries of B."""
    symbol = context.symbols.christoffel_of("i", "j", "k").tex
    b = context.dynamics.letter.lower()
    return (
        f"{symbol} = \\frac{{1}}{{2}}\\left(\\frac{{\\partial {b}_{{ij}}}}{{\\partial q_k}} + "
        f"\\frac{{\\partial {b}_{{ik}}}}{{\\partial q_j}} - \\frac{{\\partial {b}_{{jk}}}}{{\\partial q_i}}\\right)"
    )


def _steps(context: Context) -> Iterator[Block]:
    """The derivatives of the entries of B, where they are short."""
    equations = list(_derivatives(context))
    if equations:
        _ = context.text
        yield Steps(_("Derivatives of the inertia matrix"), (Rows(tuple(equation_lines(equations))),))


def _derivatives(context: Context) -> Iterator[Equation]:
    layout, robot = context.dynamics, context.robot
    if not layout.is_compact("Bdot"):
        return
    joints = range(1, robot.n + 1)
    for i, j, k in ((i, j, k) for i in joints for j in joints for k in joints if i <= j):
        derivative = context.quantities[f"dB[{i},{j},{k}]"]
        if derivative.terms(1, 1):
            variable = context.notation.glyph(robot.joints[k - 1].variable).box
            above, below = (concatenate(Box("\\partial ", 6.0), box) for box in (layout.inertia_entry(i, j), variable))
            yield Equation(fraction(above, below), tuple(context.printer.pieces(derivative.entry(1, 1))))

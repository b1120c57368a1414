"""The part with the inertia matrix and, step by step, what each body adds to it."""

from __future__ import annotations

from collections.abc import Iterator

from derive.emit.handout.bodies import bodies
from derive.emit.handout.body_formula import BodyItem, body_formulas
from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.emit.handout.formula import formula
from derive.emit.latex.layout import Equation, equation_lines
from derive.emit.latex.metrics import Box
from derive.robot.expression import ZERO


def section(context: Context) -> Section | None:
    """B."""
    if not context.robot.has_dynamics:
        return None
    _ = context.text
    title = _("Inertia matrix")
    if not context.has_closed_dynamics:
        return Section("inertia", title, (Paragraph(_not_derived(context)),))
    letter = context.dynamics.letter
    blocks: list[Block] = []
    if context.steps:
        blocks += [Steps(_("Contributions of the bodies"), tuple(_steps(context)))]
    message = _(
        "The kinetic energy is $\\tfrac{1}{2}\\,\\dot{\\mathbf{q}}^{T}\\mathbf{%(letter)s}(\\mathbf{q})\\,"
        "\\dot{\\mathbf{q}}$, motors included.",
        letter=letter,
    )
    blocks += [Paragraph(message), formula(context, context.dynamics.inertia(), "inertia_matrix")]
    return Section("inertia", title, tuple(blocks))


def _not_derived(context: Context) -> str:
    _ = context.text
    return _(
        "The closed form of the dynamics of %(n)s joints is too long to print and is not derived for this sheet; "
        "`inertia_matrix`, `coriolis_matrix`, `gravity_vector` and `inverse_dynamics` in `model_numpy.py` compute "
        "$\\mathbf{%(letter)s}$, $\\mathbf{C}$, $\\mathbf{g}$ and $\\boldsymbol{\\tau}$ by recursions.",
        n=context.robot.n,
        letter=context.dynamics.letter,
    )


def _steps(context: Context) -> Iterator[Block]:
    _ = context.text
    letter, found = context.dynamics.letter, bodies(context.robot)
    yield Paragraph(_("Every link and every rotor adds its own part, made of its mass, its inertia and its Jacobians."))
    yield Rows(tuple(construction(letter, rotors=any(body.is_rotor for body in found))))
    items = []
    for index, body in enumerate(found):
        symbol = context.dynamics.part_symbol(letter, body.letter, body.index)
        items.append(BodyItem(symbol, f"B_{body.kind}[{body.index}]", 5 * index, symmetric=True))
    yield from body_formulas(context, items)
    armatures = list(_armatures(context))
    if armatures:
        yield Paragraph(_("The reflected inertia of a motor's armature adds to the diagonal alone."))
        yield Rows(tuple(equation_lines(armatures)))


def construction(letter: str, rotors: bool) -> Iterator[str]:
    """B as a sum over the bodies."""
    sums = f"\\mathbf{{{letter}}}_{{l_i}}"
    if rotors:
        sums = f"\\left({sums} + \\mathbf{{{letter}}}_{{m_i}}\\right)"
    yield f"\\mathbf{{{letter}}} = \\sum_{{i}} {sums}"
    yield (
        f"\\mathbf{{{letter}}}_{{l_i}} = "
        "m_{l_i}\\,\\mathbf{J}_{v}^{l_i T}\\mathbf{J}_{v}^{l_i} + "
        "\\mathbf{J}_{\\omega}^{l_i T}\\mathbf{R}_{i}\\mathbf{I}_{l_i}^{i}"
        "\\mathbf{R}_{i}^{T}\\mathbf{J}_{\\omega}^{l_i}"
    )
    if rotors:
        yield (
            f"\\mathbf{{{letter}}}_{{m_i}} = "
            "m_{m_i}\\,\\mathbf{J}_{v}^{m_i T}\\mathbf{J}_{v}^{m_i} + "
            "I_{m_i}\\,\\mathbf{J}_{\\omega}^{m_i T}\\mathbf{z}_{m_i}\\mathbf{z}_{m_i}^{T}\\mathbf{J}_{\\omega}^{m_i}"
        )


def _armatures(context: Context) -> Iterator[Equation]:
    for i, link in enumerate(context.robot.links, 1):
        if link.armature != ZERO:
            entry = context.dynamics.inertia_entry(i, i)
            yield Equation(Box(f"\\Delta {entry.tex}", entry.width + 9.0), context.data.value(link.armature))

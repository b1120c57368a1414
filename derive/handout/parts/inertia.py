"""The part with the inertia matrix and, step by step, what each body adds to it.

The part with the Jacobians of the links' centres of mass and of the rotors.
"""

from __future__ import annotations

from collections.abc import Iterator

from derive.handout.bodies import Body, bodies
from derive.handout.context import Context
from derive.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.handout.formula import BodyItem, body_formulas, formula
from derive.handout.layout.lines import Equation, equation_lines
from derive.handout.notation.pieces import Box, italic, script
from derive.handout.notation.symbols import bold
from derive.robot.description import Convention
from derive.robot.expression import ZERO


def inertia_section(context: Context) -> Section | None:
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


_HALVES = (("v", "v", 1), ("w", "\\omega", 2))


def link_jacobians_section(context: Context) -> Section | None:
    """J_v and J_w of every link and rotor."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    return Section("link-jacobians", _("Jacobians of links and motors"), tuple(_blocks(context)))


def _blocks(context: Context) -> Iterator[Block]:
    found = bodies(context.robot)
    yield from _links(context)
    if any(body.is_rotor for body in found):
        yield from _rotors(context)
    yield from body_formulas(context, [item for index, body in enumerate(found) for item in _halves(body, index)])


def _halves(body: Body, index: int) -> Iterator[BodyItem]:
    for half, letter, place in _HALVES:
        symbol = script(bold("J"), italic(letter), italic(f"{body.letter}_{{{body.index}}}"))
        yield BodyItem(symbol, f"J{half}_{body.point}[{body.index}]", 5 * index + place)


def _links(context: Context) -> Iterator[Block]:
    _ = context.text
    yield Paragraph(
        _(
            "In the world frame, $\\mathbf{p}_{l_i}$ being the centre of mass of link $i$. Column $j$ is the velocity "
            "of that point, and the angular velocity of the link, per unit of $\\dot{q}_j$; it is zero for $j > i$, "
            "for a joint does not move the links before it."
        )
    )
    k = _axis(context)
    revolute, prismatic = (joint_types(context)[flag] for flag in (True, False))
    words = {True: _("revolute"), False: _("prismatic")}
    rows = []
    if revolute:
        rows.append(
            f"\\text{{{words[True]}}}\\colon\\quad \\mathbf{{J}}_{{v,j}}^{{l_i}} = "
            f"\\mathbf{{z}}_{{{k}}} \\times (\\mathbf{{p}}_{{l_i}} - \\mathbf{{o}}_{{{k}}}), \\qquad "
            f"\\mathbf{{J}}_{{\\omega,j}}^{{l_i}} = \\mathbf{{z}}_{{{k}}}"
        )
    if prismatic:
        rows.append(
            f"\\text{{{words[False]}}}\\colon\\quad \\mathbf{{J}}_{{v,j}}^{{l_i}} = \\mathbf{{z}}_{{{k}}}, "
            "\\qquad \\mathbf{J}_{\\omega,j}^{l_i} = \\mathbf{0}"
        )
    yield Rows(tuple(rows))
    opposed = _opposed(context)
    if opposed:
        yield Paragraph(
            _(
                "The variables of these joints count against their axes, and their columns change sign: %(joints)s.",
                joints=opposed,
            )
        )


def _rotors(context: Context) -> Iterator[Block]:
    _ = context.text
    yield Paragraph(
        _(
            "The rotor that drives joint $i$ sits on its axis $\\mathbf{z}_{m_i}$ at $\\mathbf{p}_{m_i}$, is carried "
            "by link $i-1$ and spins at $k_{r_i}\\dot{q}_i$: columns $j < i$ are those of a point of link $i-1$, "
            "column $i$ is the spin, the others are zero."
        )
    )
    yield Rows(
        ("\\mathbf{J}_{v,i}^{m_i} = \\mathbf{0}, \\qquad \\mathbf{J}_{\\omega,i}^{m_i} = k_{r_i}\\,\\mathbf{z}_{m_i}",)
    )


def _axis(context: Context) -> str:
    """Index of the frame on whose z axis joint j moves."""
    return "j-1" if context.robot.convention is Convention.STANDARD else "j"


def joint_types(context: Context) -> dict[bool, bool]:
    """Whether the robot has revolute (True) and prismatic (False) joints."""
    kinds = {joint.is_revolute for joint in context.robot.joints}
    return {flag: flag in kinds for flag in (True, False)}


def _opposed(context: Context) -> str:
    return ", ".join(f"${i}$" for i, joint in enumerate(context.robot.joints, 1) if joint.sign < 0)

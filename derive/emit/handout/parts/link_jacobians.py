"""The part with the Jacobians of the links' centres of mass and of the rotors."""

from __future__ import annotations

from collections.abc import Iterator

from derive.emit.handout.bodies import Body, bodies
from derive.emit.handout.body_formula import BodyItem, body_formulas
from derive.emit.handout.context import Context
from derive.emit.handout.document import Block, Paragraph, Rows, Section
from derive.emit.latex.metrics import italic, script
from derive.emit.latex.symbols import bold
from derive.robot.robot import Convention

_HALVES = (("v", "v", 1), ("w", "\\omega", 2))


def section(context: Context) -> Section | None:
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

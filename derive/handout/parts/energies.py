"""The part with kinetic and potential energy."""

from __future__ import annotations

from collections.abc import Iterator

from derive.handout.bodies import bodies
from derive.handout.context import Context
from derive.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.handout.formula import BodyItem, body_formulas, formula
from derive.handout.layout.lines import Equation, equation_lines, fits, matrix
from derive.handout.notation.pieces import Box, concatenate, italic, joined, script
from derive.handout.notation.symbols import bold
from derive.robot.expression import ZERO

_HALF = "\\tfrac{1}{2}"


def section(context: Context) -> Section | None:
    """The energies."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    return Section("energies", _("Energies"), (*_kinetic(context), *_potential(context)))


def _kinetic(context: Context) -> Iterator[Block]:
    _ = context.text
    rotors = any(body.is_rotor for body in bodies(context.robot))
    armatures = any(link.armature != ZERO for link in context.robot.links)
    yield Paragraph(_("The kinetic energy is the sum of those of the links."))
    yield Rows((_links(rotors, armatures),))
    if rotors:
        yield Paragraph(_("A rotor turns with the link that carries it, and spins about its axis $\\mathbf{z}_{m_i}$."))
        yield Rows((_rotors(),))
    if armatures:
        yield Paragraph(_("The armatures $I_{a_i}$ are inertias of rotors seen from the joint."))
        yield Rows((f"\\mathcal{{T}}_{{a}} = {_HALF} \\sum_{{i}} I_{{a_i}}\\,\\dot{{q}}_i^2",))
    letter = context.dynamics.letter
    yield Paragraph(_("In the rates of the joints it is a quadratic form."))
    yield Rows(
        (
            f"\\mathcal{{T}} = {_HALF}\\,\\dot{{\\mathbf{{q}}}}^T \\mathbf{{{letter}}}(\\mathbf{{q}})\\,"
            "\\dot{\\mathbf{q}}",
        )
    )
    block = context.dynamics.kinetic()
    if block is not None:
        yield formula(context, block)


def _links(rotors: bool, armatures: bool) -> str:
    rest = (" + \\mathcal{T}_{m}" if rotors else "") + (" + \\mathcal{T}_{a}" if armatures else "")
    return (
        f"\\mathcal{{T}} = {_HALF} \\sum_{{i}} \\left( m_{{l_i}}\\,\\dot{{\\mathbf{{p}}}}_{{l_i}}^T "
        "\\dot{\\mathbf{p}}_{l_i} + \\boldsymbol{\\omega}_i^T \\mathbf{R}_i \\mathbf{I}_{l_i}^{i} \\mathbf{R}_i^T "
        f"\\boldsymbol{{\\omega}}_i \\right){rest}"
    )


def _rotors() -> str:
    return (
        f"\\mathcal{{T}}_{{m}} = {_HALF} \\sum_{{i}} \\left( m_{{m_i}}\\,\\dot{{\\mathbf{{p}}}}_{{m_i}}^T "
        "\\dot{\\mathbf{p}}_{m_i} + I_{m_i} \\left( \\mathbf{z}_{m_i}^T \\boldsymbol{\\omega}_{m_i} \\right)^2 \\right)"
    )


def _potential(context: Context) -> Iterator[Block]:
    _ = context.text
    if context.robot.gravity is None:
        yield Paragraph(_("The robot file gives no gravity; the potential energy is zero."))
        return
    yield Paragraph(_("The potential energy is that of the weights."))
    yield Rows((_weights(any(body.is_rotor for body in bodies(context.robot))),))
    yield Rows(tuple(gravity_rows(context)))
    if context.steps:
        yield Steps(_("Centres of mass in the world"), tuple(body_formulas(context, _places(context))))
    yield formula(context, context.dynamics.potential(), "gravity_vector")


def _weights(rotors: bool) -> str:
    links = "m_{l_i}\\,\\mathbf{g}_0^T \\mathbf{p}_{l_i}"
    if not rotors:
        return f"\\mathcal{{U}} = -\\sum_{{i}} {links}"
    return (
        f"\\mathcal{{U}} = -\\sum_{{i}} \\left( {links} + m_{{m_i}}\\,\\mathbf{{g}}_0^T \\mathbf{{p}}_{{m_i}} \\right)"
    )


def gravity_rows(context: Context) -> Iterator[str]:
    """The acceleration of gravity in the world."""
    if context.robot.gravity is None:
        return
    symbol, cells = script(bold("g"), italic("0")), [context.data.value(cell) for cell in context.robot.gravity]
    whole = concatenate(symbol, Box(" = ", 13.4), matrix([[joined(cell)] for cell in cells]))
    if fits(whole, 3):
        yield whole.tex
        return
    for axis, cell in zip("xyz", cells, strict=True):
        yield from equation_lines([Equation(script(italic("g"), italic(f"0{axis}")), cell)])


def _places(context: Context) -> Iterator[BodyItem]:
    for index, body in enumerate(bodies(context.robot)):
        link = context.robot.links[body.index - 1]
        if body.is_rotor and (link.motor is None or link.motor.mass == ZERO):
            continue
        if not body.is_rotor and link.mass == ZERO:
            continue
        symbol = script(bold("p"), italic(f"{body.letter}_{{{body.index}}}"))
        yield BodyItem(symbol, f"p_{body.point}[{body.index}]", 5 * index + 3)

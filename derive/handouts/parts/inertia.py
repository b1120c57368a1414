"""The parts with the energies and with the inertia matrix: step by step, what each link and rotor adds."""

from __future__ import annotations

from collections.abc import Iterator

from derive.handouts import groups
from derive.handouts.context import Context
from derive.handouts.document import Block, Paragraph, Rows, Steps
from derive.handouts.formula import BodyItem, body_formulas, formula
from derive.handouts.layout.lines import Equation, equation_lines, fits, matrix
from derive.handouts.notation.pieces import Box, concatenate, italic, joined, script
from derive.handouts.notation.symbols import bold
from derive.handouts.parts.bodies import bodies, has_rotors
from derive.handouts.textbook import textbook
from derive.robot.expression import ZERO

# -- energies


def energies(context: Context) -> Iterator[Block]:
    """Kinetic and potential energy.

    Args:
        context: The handout.

    Yields:
        The blocks of the part.
    """
    _ = context.text
    rotors, armatures = has_rotors(context.robot), any(link.armature != ZERO for link in context.robot.links)
    yield Paragraph(_("The kinetic energy is the sum of those of the links."))
    yield textbook("kinetic_energy", rotors=rotors, armatures=armatures)
    if rotors:
        yield Paragraph(_("A rotor turns with the link that carries it, and spins about its axis $\\mathbf{z}_{m_i}$."))
        yield textbook("rotor_energy")
    if armatures:
        yield Paragraph(_("The armatures $I_{a_i}$ are inertias of rotors seen from the joint."))
        yield textbook("armature_energy")
    yield Paragraph(_("In the rates of the joints it is a quadratic form."))
    yield textbook("kinetic_form", B=context.dynamics.letter)
    if context.dynamics.is_compact(context.entries.B):
        yield formula(context, context.dynamics.closed("kinetic"))
    if context.robot.gravity is None:
        yield Paragraph(_("The robot file gives no gravity; the potential energy is zero."))
        return
    yield Paragraph(_("The potential energy is that of the weights."))
    yield textbook("potential_energy", rotors=rotors)
    yield Rows(tuple(_gravity(context)))
    if context.steps:
        yield Steps(_("Centres of mass in the world"), tuple(body_formulas(context, _positions(context))))
    yield formula(context, context.dynamics.closed("potential"), "gravity_vector")


def _gravity(context: Context) -> Iterator[str]:
    """The acceleration of gravity in the world."""
    cells = [context.data.value(cell) for cell in context.robot.gravity or ()]
    symbol = script(bold("g"), italic("0"))
    vector = concatenate(symbol, Box(" = ", 13.4), matrix([[joined(cell)] for cell in cells]))
    if fits(vector, 3):
        yield vector.tex
        return
    for axis, cell in zip("xyz", cells, strict=True):
        yield from equation_lines([Equation(script(italic("g"), italic(f"0{axis}")), cell)])


def _positions(context: Context) -> Iterator[BodyItem]:
    """Where the masses are."""
    for body in bodies(context.robot):
        link = context.robot.links[body.index - 1]
        mass = link.motor.mass if body.is_rotor and link.motor is not None else link.mass
        if mass != ZERO:
            position = context.entries.body_position(body.index, body.is_rotor)
            yield BodyItem(body.symbol("p"), position, groups.body(body.place, 3))


# -- inertia matrix


def inertia(context: Context) -> Iterator[Block]:
    """B, and the contributions of the bodies to it.

    Args:
        context: The handout.

    Yields:
        The blocks of the part; of many joints the sentence that B is not derived.
    """
    _ = context.text
    letter = context.dynamics.letter
    if not context.robot.has_dynamics:
        return
    if not context.has_closed_dynamics:
        yield Paragraph(
            _(
                "The closed form of the dynamics of %(n)s joints is too long to print and is not derived for this "
                "sheet; `inertia_matrix`, `coriolis_matrix`, `gravity_vector` and `inverse_dynamics` in "
                "`model_numpy.py` compute $\\mathbf{%(letter)s}$, $\\mathbf{C}$, $\\mathbf{g}$ and "
                "$\\boldsymbol{\\tau}$ by recursions.",
                n=context.robot.n,
                letter=letter,
            )
        )
        return
    if context.steps:
        yield Steps(_("Contributions of the bodies"), tuple(_contributions(context)))
    yield Paragraph(
        _(
            "The kinetic energy is $\\tfrac{1}{2}\\,\\dot{\\mathbf{q}}^{T}\\mathbf{%(letter)s}(\\mathbf{q})\\,"
            "\\dot{\\mathbf{q}}$, motors included.",
            letter=letter,
        )
    )
    yield formula(context, context.dynamics.closed("B"), "inertia_matrix")


def _contributions(context: Context) -> Iterator[Block]:
    _ = context.text
    letter = context.dynamics.letter
    yield Paragraph(_("Every link and every rotor adds its own part, made of its mass, its inertia and its Jacobians."))
    yield textbook("inertia_matrix", B=letter, rotors=has_rotors(context.robot))
    items = (
        BodyItem(
            body.symbol(letter),
            context.entries.inertia_part(body.index, body.is_rotor),
            groups.body(body.place, 0),
            symmetric=True,
        )
        for body in bodies(context.robot)
    )
    yield from body_formulas(context, items)
    diagonal = [
        (context.dynamics.inertia_entry(i, i), link.armature)
        for i, link in enumerate(context.robot.links, 1)
        if link.armature != ZERO
    ]
    if diagonal:
        armatures = (
            Equation(Box(f"\\Delta {entry.tex}", entry.width + 9.0), context.data.value(armature))
            for entry, armature in diagonal
        )
        yield Paragraph(_("The reflected inertia of a motor's armature adds to the diagonal alone."))
        yield Rows(tuple(equation_lines(armatures)))

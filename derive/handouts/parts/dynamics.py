"""The parts about dynamics: Jacobians of links and rotors, energies, inertia matrix, Christoffel symbols, motion."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

from derive.handouts.layout.lines import Equation, equation_lines
from derive.handouts.notation.pieces import Box, concatenate, fraction, italic, script, upright
from derive.handouts.notation.symbols import Group, bold
from derive.handouts.parts.jacobian import JointAxes
from derive.handouts.sheet.context import Context, body_formulas, formula, matrix_lines, textbook
from derive.handouts.sheet.document import Block, Paragraph, Rows, SheetFormula, Steps
from derive.robot import tree
from derive.robot.description import Inertia, Link
from derive.robot.expression import ZERO
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class MassBody:
    """A link or a rotor that has mass or inertia."""

    place: int  # its place among the bodies, from 0
    index: int  # its link or joint, from 1; of a row without motion behind them
    is_rotor: bool  # whether it is the rotor of a motor
    name: Box  # how the index is written

    def symbol(self, letter: str, sub: str = "") -> Box:
        """A matrix or vector of the body: B_{l_1}, p_{m_2}, or J_v^{l_1}."""
        body = italic(f"{'m' if self.is_rotor else 'l'}_{{{self.name.tex}}}")
        return script(bold(letter), italic(sub), body) if sub else script(bold(letter), body)


def bodies(robot: Robot) -> tuple[MassBody, ...]:
    """Links with mass or inertia, each followed by the rotor of its joint."""
    kinds = [(link.mass != ZERO or link.inertia != Inertia(), has_rotor(link)) for link in tree.bodies(robot)]
    found = [(i, is_rotor) for i, has in enumerate(kinds, 1) for is_rotor in (False, True) if has[is_rotor]]
    names = [italic(str(i)) if i <= robot.n else upright(label) for i, label in enumerate(tree.labels(robot))]
    return tuple(MassBody(place, i, is_rotor, names[i]) for place, (i, is_rotor) in enumerate(found))


def has_rotor(link: Link) -> bool:
    """Whether the motor of a joint has a rotor with mass or inertia."""
    return link.motor is not None and (link.motor.mass != ZERO or link.motor.inertia != ZERO)


def has_rotors(robot: Robot) -> bool:
    """Whether any joint has a rotor with mass or inertia."""
    return any(map(has_rotor, robot.links))


def link_jacobians(context: Context) -> Iterator[Block]:
    """J_v and J_w of every link and rotor."""
    _ = context.text
    if context.robot.is_tree:
        yield context.paragraph(
            "In the world frame, $\\mathbf{p}_{l_i}$ being the centre of mass of link $i$. Column $j$ is the velocity "
            "of that point, and the angular velocity of the link, per unit of $\\dot{q}_j$; it is zero unless joint "
            "$j$ is on the way from the base to the link."
        )
    else:
        yield context.paragraph(
            "In the world frame, $\\mathbf{p}_{l_i}$ being the centre of mass of link $i$. Column $j$ is the velocity "
            "of that point, and the angular velocity of the link, per unit of $\\dot{q}_j$; it is zero for $j > i$, "
            "for a joint does not move the links before it."
        )
    yield from _columns(context)
    if has_rotors(context.robot):
        if context.robot.is_tree:
            yield context.paragraph(
                "The rotor that drives joint $i$ sits on its axis $\\mathbf{z}_{m_i}$ at $\\mathbf{p}_{m_i}$, is "
                "carried by the link which the joint follows and spins at $k_{r_i}\\dot{q}_i$: column $i$ is the spin, "
                "the others are those of a point of that link."
            )
        else:
            yield context.paragraph(
                "The rotor that drives joint $i$ sits on its axis $\\mathbf{z}_{m_i}$ at $\\mathbf{p}_{m_i}$, is "
                "carried by link $i-1$ and spins at $k_{r_i}\\dot{q}_i$: columns $j < i$ are those of a point of link "
                "$i-1$, column $i$ is the spin, the others are zero."
            )
        yield textbook("rotor_jacobians")
    kinds = (("v", context.entries.linear_jacobian), ("\\omega", context.entries.angular_jacobian))
    items = [
        (body.symbol("J", letter), find(body.index, body.is_rotor), Group.body(body.place, k))
        for body, (k, (letter, find)) in product(bodies(context.robot), enumerate(kinds, 1))
    ]
    of_both = _("Find the Jacobians of the links and of the rotors.")
    task = of_both if has_rotors(context.robot) else _("Find the Jacobians of the links.")
    yield from body_formulas(context, items, task)


def _columns(context: Context) -> Iterator[Block]:
    """How the columns of the Jacobians of links follow from axes and origins."""
    _ = context.text
    joints, axes = context.robot.joints, JointAxes(context)
    z, o = (axes.symbol(letter, axes.index("j")).tex for letter in "zo")
    yield textbook(
        "link_jacobians",
        z=z,
        o=o,
        revolute=_("revolute") if any(joint.is_revolute for joint in joints) else "",
        prismatic=_("prismatic") if not all(joint.is_revolute for joint in joints) else "",
    )
    if context.robot.coupled:
        yield context.paragraph("These are columns of joints; times $\\mathbf{S}$ they are those of the variables.")
    if opposed := ", ".join(f"${i}$" for i, joint in enumerate(joints, 1) if joint.sign < 0):
        yield context.paragraph(
            "The variables of these joints increase against the direction of their axes, so their columns change "
            "sign: %(joints)s.",
            joints=opposed,
        )


def energies(context: Context) -> Iterator[Block]:
    """Kinetic and potential energy."""
    _ = context.text
    rotors, armatures = has_rotors(context.robot), any(link.armature != ZERO for link in context.robot.links)
    yield context.paragraph("The kinetic energy is the sum of those of the links.")
    yield textbook("kinetic_energy", rotors=rotors, armatures=armatures)
    if rotors:
        yield Paragraph(_("A rotor turns with the link that carries it, and spins about its axis $\\mathbf{z}_{m_i}$."))
        yield textbook("rotor_energy")
    if armatures:
        yield context.paragraph("The armatures $I_{a_i}$ are inertias of rotors seen from the joint.")
        yield textbook("armature_energy")
    if (rotors or armatures) and context.robot.coupled:
        yield _of_joints(context)
    yield context.paragraph("The kinetic energy is a quadratic form in the joint velocities.")
    yield textbook("kinetic_form", B=context.symbols.inertia_letter)
    if context.dynamics.is_compact(context.entries.B):
        yield formula(context, context.dynamics.closed("kinetic"), task=_("Write the kinetic energy of this arm."))
    if context.robot.gravity is None:
        yield context.paragraph("The robot file gives no gravity; the potential energy is zero.")
        return
    yield context.paragraph("The potential energy is that of all masses in the field of gravity.")
    yield textbook("potential_energy", rotors=rotors)
    cells = [[context.data.value(cell)] for cell in context.robot.gravity]
    names = [script(italic("g"), italic(f"0{axis}")) for axis in "xyz"]
    yield Rows(tuple(matrix_lines(script(bold("g"), italic("0")), cells, lambda i, _: names[i - 1])))
    if context.steps:
        items = []
        for body in bodies(context.robot):
            link = tree.bodies(context.robot)[body.index - 1]
            if (link.motor.mass if body.is_rotor and link.motor is not None else link.mass) != ZERO:
                position = context.entries.body_position(body.index, body.is_rotor)
                items.append((body.symbol("p"), position, Group.body(body.place, 3)))
        yield Steps(_("Centres of mass in the world"), tuple(body_formulas(context, items)))
    task = _("Write the potential energy of this arm.")
    yield formula(context, context.dynamics.closed("potential"), "gravity_vector", task)


def _of_joints(context: Context) -> Paragraph:
    """What is of rows of the table, where joints are coupled."""
    return context.paragraph(
        "Motors, armatures and friction are those of joints: here $\\dot{q}_i$ is the rate of joint $i$, and what "
        "joints feel is multiplied by $\\mathbf{S}^T$."
    )


def inertia(context: Context) -> Iterator[Block]:
    """B, and the contributions of the bodies to it."""
    letter = context.symbols.inertia_letter
    if not context.robot.has_dynamics:
        return
    if not context.has_closed_dynamics:
        yield context.answer(
            "The closed form of the dynamics of %(n)s joints is too long to print and is not derived for this "
            "sheet; `inertia_matrix`, `coriolis_matrix`, `gravity_vector` and `inverse_dynamics` in "
            "`model_numpy.py` compute $\\mathbf{%(letter)s}$, $\\mathbf{C}$, $\\mathbf{g}$ and "
            "$\\boldsymbol{\\tau}$ by recursions.",
            n=context.robot.n,
            letter=letter,
        )
        return
    if context.steps:
        yield Steps(context.text("Contributions of the bodies"), tuple(_contributions(context)))
    if has_rotors(context.robot) or any(link.armature != ZERO for link in context.robot.links):
        yield context.paragraph(
            "The kinetic energy is $\\tfrac{1}{2}\\,\\dot{\\mathbf{q}}^{T}\\mathbf{%(letter)s}(\\mathbf{q})\\,"
            "\\dot{\\mathbf{q}}$, motors included.",
            letter=letter,
        )
    else:
        yield context.paragraph(
            "The kinetic energy is $\\tfrac{1}{2}\\,\\dot{\\mathbf{q}}^{T}\\mathbf{%(letter)s}(\\mathbf{q})\\,"
            "\\dot{\\mathbf{q}}$.",
            letter=letter,
        )
    yield formula(context, context.dynamics.closed("B"), "inertia_matrix", context.text("Find the inertia matrix."))


def _contributions(context: Context) -> Iterator[Block]:
    _, letter, rotors = context.text, context.symbols.inertia_letter, has_rotors(context.robot)
    of_both = _("Every link and every rotor adds its own part, made of its mass, its inertia and its Jacobians.")
    of_links = _("Every link adds its own part, made of its mass, its inertia and its Jacobians.")
    yield Paragraph(of_both if rotors else of_links)
    yield textbook("inertia_matrix", B=letter, rotors=rotors)
    part = context.entries.inertia_part
    items = ((b.symbol(letter), part(b.index, b.is_rotor), Group.body(b.place, 0)) for b in bodies(context.robot))
    yield from body_formulas(context, items, symmetric=True)
    armatures = []
    for i, link in enumerate(context.robot.links, 1):
        if link.armature != ZERO and not context.robot.coupled:
            entry = context.dynamics.inertia_entry(i, i)
            left = Box(f"\\Delta {entry.tex}", entry.width + 9.0)
            armatures.append(Equation(left, context.data.value(link.armature)))
    lines = equation_lines(armatures)
    yield from context.announced("The reflected inertia of a motor's armature adds to the diagonal alone.", lines)


_CORIOLIS = "coriolis_matrix"
_TORQUE = "inverse_dynamics"  # generated functions


def christoffel(context: Context) -> Iterator[Block]:
    """The Christoffel symbols that are not zero, and the derivatives of B from which they come."""
    _ = context.text
    b, c = context.symbols.inertia_letter.lower(), context.symbols.christoffel("i", "j", "k").tex
    yield context.paragraph(
        "The Christoffel symbols follow from the inertia matrix; each is symmetric in its last two indices."
    )
    yield textbook("christoffel_symbols", b=b, c=c)
    task = _("Which Christoffel symbols are not zero? Find them.")
    if not context.entries.triples:
        yield SheetFormula((), note=_("All are zero."), task=task, blanks=("",))
        return
    if context.steps and context.dynamics.is_compact(context.entries.Bdot):
        joints, partial, derivatives = range(1, context.robot.dof + 1), Box("\\partial ", 6.0), []
        for i, j, k in ((i, j, k) for i in joints for j in joints for k in joints if i <= j):
            if (derivative := context.entries.inertia_derivative(i, j, k)).terms(1, 1):
                variable = context.notation.glyph(context.robot.variables[k - 1].variable).box
                entry = context.dynamics.inertia_entry(i, j)
                symbol = fraction(concatenate(partial, entry), concatenate(partial, variable))
                derivatives.append(Equation(symbol, tuple(context.printer.pieces(derivative.entry(1, 1)))))
        if derivatives:
            yield Steps(_("Derivatives of the inertia matrix"), (Rows(tuple(equation_lines(derivatives))),))
    yield formula(context, context.dynamics.christoffel(), _CORIOLIS, task)


def coriolis(context: Context) -> Iterator[Block]:
    """C, by Christoffel symbols and multiplied out where it is short."""
    _ = context.text
    yield context.paragraph(
        "Centrifugal and Coriolis terms; this choice of $\\mathbf{C}$ makes $\\mathbf{N}$ skew-symmetric."
    )
    yield textbook("coriolis_matrix", c=context.symbols.christoffel("i", "j", "k").tex)
    if not context.dynamics.is_compact(context.entries.C):
        yield context.paragraph("With the Christoffel symbols above:")
        task = _("Write the Coriolis matrix with the Christoffel symbols.")
        yield formula(context, context.dynamics.rate_sums("C"), _CORIOLIS, task)
        return
    if context.steps and context.entries.triples:
        yield Steps(_("By Christoffel symbols"), (Rows(context.dynamics.rate_sums("C").lines),))
    yield formula(context, context.dynamics.closed("C"), _CORIOLIS, _("Find the Coriolis matrix."))


def skew(context: Context) -> Iterator[Block]:
    """N = dB/dt - 2C, why it is skew-symmetric for any robot, and the check for this one."""
    letter, c = context.symbols.inertia_letter, context.symbols.christoffel
    yield textbook("skew_matrix", B=letter)
    yield context.answer(
        "The derivatives of the inertia matrix are sums of Christoffel symbols; hence $\\mathbf{N}^T = -\\mathbf{N}$."
    )
    proof = textbook("skew_symmetry", b=letter.lower(), c_ijk=c("i", "j", "k").tex, c_jik=c("j", "i", "k").tex)
    yield replace(proof, is_answer=True)
    task = context.text("Find $\\mathbf{N}$ and show that it is skew-symmetric.")
    entries, is_compact = context.entries, context.dynamics.is_compact
    if context.steps and is_compact(entries.Bdot):
        derivative = formula(context, context.dynamics.closed("Bdot"))
        yield Steps(context.text("Derivative of the inertia matrix with respect to time"), (derivative,))
    if is_compact(entries.C) and is_compact(entries.N):
        yield formula(context, context.dynamics.closed("N"), _CORIOLIS, task)
    else:
        yield context.answer("The entries above the diagonal; those below are their opposites, those on it are zero.")
        yield formula(context, context.dynamics.rate_sums("N"), _CORIOLIS, task)
    if entries.is_skew(context.policy.compact_terms):
        yield context.answer(
            "Check: multiplied out, the entries of $\\mathbf{N} + \\mathbf{N}^T$ cancel one by one, so that "
            "$\\mathbf{N} + \\mathbf{N}^T = \\mathbf{0}$."
        )


def gravity(context: Context) -> Iterator[Block]:
    """g, the gradient of the potential energy."""
    if context.robot.gravity is None:
        yield context.answer("The robot file gives no gravity: $\\mathbf{g} = \\mathbf{0}$.")
        return
    yield context.paragraph("The gradient of the potential energy.")
    yield textbook("gravity_vector", rotors=has_rotors(context.robot))
    yield formula(context, context.dynamics.closed("g"), "gravity_vector", context.text("Find the gravity vector."))


def equations_of_motion(context: Context) -> Iterator[Block]:
    """tau = B qdd + C qd + g + friction, term by term and multiplied out where it is short."""
    _ = context.text
    friction = any(link.viscous != ZERO or link.coulomb != ZERO for link in context.robot.links)
    letter, gravity = context.symbols.inertia_letter, context.robot.gravity is not None
    by_direction = any(isinstance(link.coulomb, tuple) for link in context.robot.links)
    yield textbook("equations_of_motion", B=letter, gravity=gravity, friction=friction, by_direction=by_direction)
    if friction and context.robot.coupled:
        yield _of_joints(context)
    yield context.paragraph(
        "If the environment acts on the end effector with a force and a moment, $\\mathbf{h}$, then "
        "$\\boldsymbol{\\tau}$ is less by $\\mathbf{J}^T \\mathbf{h}$."
    )
    entries, is_compact = context.entries, context.dynamics.is_compact
    if is_compact(entries.C) and is_compact(entries.tau):
        if context.steps:
            yield Steps(_("With the entries and symbols above"), (Rows(context.dynamics.named_torque().lines),))
        yield formula(context, context.dynamics.closed("tau"), _TORQUE, _("Write the equations of motion."))
    elif 2 * len(entries.triples) > context.policy.named_products * context.robot.dof:
        yield context.answer(
            "Written out, even with the entries and symbols above, they are too long to print; `inverse_dynamics` "
            "in `model_numpy.py` computes them."
        )
    else:
        yield context.paragraph("With the entries and symbols above:")
        task = _(
            "Write the equations of motion with the entries of $%(matrix)s$, the Christoffel symbols and the "
            "components of $\\mathbf{g}$.",
            matrix=f"\\mathbf{{{letter}}}",
        )
        yield formula(context, context.dynamics.named_torque(), _TORQUE, task)

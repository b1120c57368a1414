"""The parts with Christoffel symbols, Coriolis matrix, skew symmetry, gravity and the equations of motion."""

from collections.abc import Iterator
from dataclasses import replace

from derive.handouts.layout.lines import Equation, equation_lines
from derive.handouts.notation.pieces import Box, concatenate, fraction
from derive.handouts.parts.bodies import has_rotors
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Rows, SheetFormula, Steps
from derive.handouts.sheet.formula import formula, textbook
from derive.robot.expression import ZERO

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
        joints, partial, derivatives = range(1, context.robot.n + 1), Box("\\partial ", 6.0), []
        for i, j, k in ((i, j, k) for i in joints for j in joints for k in joints if i <= j):
            derivative = context.entries.inertia_derivative(i, j, k)
            if derivative.terms(1, 1):
                variable = context.notation.glyph(context.robot.joints[k - 1].variable).box
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
    task = context.text("Find the gravity vector.")
    yield formula(context, context.dynamics.closed("g"), "gravity_vector", task)


def equations_of_motion(context: Context) -> Iterator[Block]:
    """tau = B qdd + C qd + g + friction, term by term and multiplied out where it is short."""
    _ = context.text
    friction = any(link.viscous != ZERO or link.coulomb != ZERO for link in context.robot.links)
    letter, gravity = context.symbols.inertia_letter, context.robot.gravity is not None
    yield textbook("equations_of_motion", B=letter, gravity=gravity, friction=friction)
    yield context.paragraph(
        "If the environment acts on the end effector with a force and a moment, $\\mathbf{h}$, then "
        "$\\boldsymbol{\\tau}$ is less by $\\mathbf{J}^T \\mathbf{h}$."
    )
    entries, is_compact = context.entries, context.dynamics.is_compact
    if is_compact(entries.C) and is_compact(entries.tau):
        if context.steps:
            yield Steps(_("With the entries and symbols above"), (Rows(context.dynamics.named_torque().lines),))
        yield formula(context, context.dynamics.closed("tau"), _TORQUE, _("Write the equations of motion."))
    elif 2 * len(entries.triples) > context.policy.named_products * context.robot.n:
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

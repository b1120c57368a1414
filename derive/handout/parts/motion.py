"""The part with the Christoffel symbols.

The part with the Coriolis matrix.

The part with N = dB/dt - 2C and the check that it is skew-symmetric.

The part with the gravity vector.

The part with the equations of motion.
"""

from __future__ import annotations

from collections.abc import Iterator

from derive.handout.bodies import bodies
from derive.handout.context import Context
from derive.handout.document import Block, Paragraph, Rows, Section, Steps
from derive.handout.formula import formula
from derive.handout.layout.lines import Equation, equation_lines
from derive.handout.notation.pieces import Box, concatenate, fraction
from derive.robot.expression import ZERO


def christoffel_section(context: Context) -> Section | None:
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
    symbol = context.symbols.christoffel("i", "j", "k").tex
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


def coriolis_section(context: Context) -> Section | None:
    """C by Christoffel symbols."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    forms = context.rate_forms
    symbol = context.symbols.christoffel("i", "j", "k").tex
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


_CORIOLIS_FUNCTION = "coriolis_matrix"


def skew_section(context: Context) -> Section | None:
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
        yield formula(context, forms.skew(), _CORIOLIS_FUNCTION)
    else:
        yield formula(context, context.dynamics.closed("N", 5), _CORIOLIS_FUNCTION)
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
    b, christoffel = context.dynamics.letter.lower(), context.symbols.christoffel
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


def gravity_section(context: Context) -> Section | None:
    """g, the gradient of the potential energy."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    return Section("gravity", _("Gravity"), tuple(_gravity_blocks(context)))


def _gravity_blocks(context: Context) -> Iterator[Block]:
    _ = context.text
    if context.robot.gravity is None:
        yield Paragraph(_("The robot file gives no gravity: $\\mathbf{g} = \\mathbf{0}$."))
        return
    yield Paragraph(_("The gradient of the potential energy."))
    yield Rows((_definition(context),))
    yield formula(context, context.dynamics.gravity(), "gravity_vector")


def _definition(context: Context) -> str:
    weights = "m_{l_j}\\,\\mathbf{g}_0^T \\mathbf{J}_{v,i}^{l_j}"
    if any(body.is_rotor for body in bodies(context.robot)):
        weights = f"\\left( {weights} + m_{{m_j}}\\,\\mathbf{{g}}_0^T \\mathbf{{J}}_{{v,i}}^{{m_j}} \\right)"
    return f"g_i = \\frac{{\\partial\\,\\mathcal{{U}}}}{{\\partial q_i}} = -\\sum_{{j}} {weights}"


_TORQUE_FUNCTION = "inverse_dynamics"


def motion_section(context: Context) -> Section | None:
    """tau = B qdd + C qd + g + friction, term by term."""
    if not context.has_closed_dynamics:
        return None
    _ = context.text
    return Section("motion", _("Equations of motion"), tuple(_motion_blocks(context)))


def _motion_blocks(context: Context) -> Iterator[Block]:
    _ = context.text
    forms = context.rate_forms
    yield Rows(tuple(_general(context)))
    if forms.torque_long:
        yield Paragraph(
            _(
                "Written out, even with the entries and symbols above, they are too long to print; `inverse_dynamics` "
                "in `model_numpy.py` computes them."
            )
        )
    elif forms.torque_named:
        yield Paragraph(_("With the entries and symbols above:"))
        yield formula(context, forms.motion(), _TORQUE_FUNCTION)
    else:
        if context.steps:
            yield Steps(_("With the entries and symbols above"), (Rows(forms.motion().lines),))
        yield formula(context, context.dynamics.torque(), _TORQUE_FUNCTION)


def _general(context: Context) -> Iterator[str]:
    letter = context.dynamics.letter
    friction = any(link.viscous != ZERO or link.coulomb != ZERO for link in context.robot.links)
    yield (
        f"\\boldsymbol{{\\tau}} = \\mathbf{{{letter}}}(\\mathbf{{q}})\\,\\ddot{{\\mathbf{{q}}}} + "
        "\\mathbf{C}(\\mathbf{q},\\dot{\\mathbf{q}})\\,\\dot{\\mathbf{q}} + \\mathbf{g}(\\mathbf{q})"
        + (" + \\boldsymbol{\\tau}_f(\\dot{\\mathbf{q}})" if friction else "")
    )
    if friction:
        yield "\\tau_{f,i} = b_i\\,\\dot{q}_i + f_i\\operatorname{sgn}(\\dot{q}_i)"

"""How models look in a Jupyter notebook.

The classes of `derive.mechanics` know no output. ``derive.Model`` therefore gets its notebook form where it leaves the
package: `install` gives `_repr_latex_` to the model and to what it returns that is not plain SymPy. SymPy's matrices
and expressions bring their own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy

from derive.mechanics.kinematic_model import KinematicModel
from derive.mechanics.model import Energy
from derive.mechanics.singularities import Singularities

if TYPE_CHECKING:
    from derive.emit.handout.context import Context

MOST_LINES = 40
"""A quantity with more lines is left to be asked for by name."""


def install() -> None:
    """Make models, energies and singularities show themselves as formulas."""
    KinematicModel._repr_latex_ = model_latex  # type: ignore[attr-defined]
    Energy._repr_latex_ = energy_latex  # type: ignore[attr-defined]
    Singularities._repr_latex_ = singularities_latex  # type: ignore[attr-defined]


def model_latex(model: KinematicModel) -> str:
    """T, J and, where the robot has links, B and g, in the notation of the handout.

    Args:
        model: The model.
    """
    from derive import __version__
    from derive.build.quantities import ModelQuantities
    from derive.emit.handout.context import Context
    from derive.emit.handout.text import Text

    robot = replace(model.robot, style=model.style, contraction=model.contraction)
    context = Context(robot, ModelQuantities(robot), robot.handout, Text(), __version__)
    return _display(list(_lines(context)))


def _lines(context: Context) -> Iterator[str]:
    from derive.emit.latex.symbols import EntryNamer, bold

    letter = context.symbols.inertia_letter
    names = {"T": "T", "J": "J"} | ({"B": letter, "g": "g"} if context.robot.has_dynamics else {})
    for group, (name, shown) in enumerate(names.items()):
        namer = EntryNamer(context.symbols, shown.lower())
        quantity = context.quantities[name]
        block = context.layouter.block(bold(shown), namer, quantity, group=group, symmetric=name == "B")
        printed = [*block.named, *block.lines]
        whole = printed and not block.omitted and not block.landscape and len(printed) <= MOST_LINES
        yield from printed if whole else (f"\\mathbf{{{shown}}} = \\cdots",)


def energy_latex(energy: Energy) -> str:
    """Kinetic and potential energy.

    Args:
        energy: The energy.
    """
    return _display(
        [f"\\mathcal{{T}} = {sympy.latex(energy.kinetic)}", f"\\mathcal{{U}} = {sympy.latex(energy.potential)}"]
    )


def singularities_latex(found: Singularities) -> str:
    """The determinant in factors, and their zeros.

    Args:
        found: Where an arm is singular.
    """
    if found.determinant is None:
        return _display([f"\\text{{singular: {found.outcome.value}}}"])
    lines = [f"\\det = {sympy.latex(found.determinant)}"]
    for condition in found.conditions:
        values = " \\text{ or } ".join(map(sympy.latex, condition.values))
        solved = f" \\iff {sympy.latex(condition.variable)} = {values}" if values else ""
        posture = f" \\quad \\text{{({condition.posture.value})}}" if condition.posture else ""
        lines.append(f"{sympy.latex(condition.expression)} = 0{solved}{posture}")
    return _display(lines)


def _display(lines: list[str]) -> str:
    body = " \\\\ ".join(f"& {line}" for line in lines)
    return f"$\\displaystyle \\begin{{aligned}} {body} \\end{{aligned}}$"

"""`derive.Model`: the model of a robot as it shows itself in a Jupyter notebook.

The closed forms of `derive.model` know no output; the public class adds it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from derive.handouts.context import Context
from derive.handouts.language import Text
from derive.handouts.notation.symbols import bold
from derive.model.dynamic_entries import ModelEntries
from derive.model.matrices import aligned_latex
from derive.model.model import Model as ClosedForms
from derive.version import __version__

MOST_LINES = 40
"""A quantity with more lines is left to be asked for by name."""


class Model(ClosedForms):
    """Closed forms of one robot, shown as formulas in a notebook; see `derive.model.model.Model`."""

    def _repr_latex_(self) -> str:
        """T, J and, where the robot has links, B and g, in the notation of the handout."""
        robot = replace(self.robot, style=self.style)
        context = Context(ModelEntries(ClosedForms(robot)), robot.handout, Text(), __version__)
        return aligned_latex(list(_lines(context)))


def _lines(context: Context) -> Iterator[str]:
    letter = context.symbols.inertia_letter
    names = {"T": "T", "J": "J"} | ({"B": letter, "g": "g"} if context.robot.has_dynamics else {})
    for group, (name, shown) in enumerate(names.items()):
        namer = partial(context.symbols.entry, shown.lower())
        quantity = getattr(context.entries, name)
        laid_out = context.layouter.lay_out(bold(shown), namer, quantity, group=group, symmetric=name == "B")
        printed = [*laid_out.named, *laid_out.lines]
        whole = printed and not laid_out.omitted and not laid_out.landscape and len(printed) <= MOST_LINES
        yield from printed if whole else (f"\\mathbf{{{shown}}} = \\cdots",)

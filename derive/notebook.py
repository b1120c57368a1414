"""`derive.Model`: the model of a robot under all names of its quantities, as it shows itself in a Jupyter notebook.

The closed forms of `derive.model` know no output and no assumptions; the public class adds them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from derive.errors import QuantityError
from derive.handouts.notation.symbols import bold
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.language import Text
from derive.lecture.matrices import aligned_latex
from derive.model.assumptions import Assumptions, View
from derive.model.dynamic_entries import ModelEntries
from derive.model.model import Model as ClosedForms
from derive.model.quantities import REGISTRY
from derive.model.quantity_names import parse
from derive.robot.options.style import Style
from derive.robot.robot import Robot
from derive.version import __version__

MOST_LINES = 40  # a quantity with more lines is left to be asked for by name


class Model(ClosedForms):
    """Closed forms of one robot, shown as formulas in a notebook; see `derive.model.model.Model`.

    Every name that ``derive show`` takes and that Python can spell is an attribute: ``model.M``, ``model.detJ``,
    ``model.Cqd``, ``model.T06``; with indices a method, ``model.J_rows(1, 2)``.

    Args:
        robot: The robot.
        style: How expressions are grouped; default as the file says.
        contraction: Which sums of angles are contracted; default as the file says.
        assumptions: Whether symbols are real and masses positive, so that SymPy simplifies ``sqrt(a1**2)`` to
            ``Abs(a1)`` and knows that ``m1`` is not zero; by default they are plain.
    """

    def __init__(
        self,
        robot: Robot,
        style: Style | str | Mapping[str, str] | None = None,
        contraction: str | None = None,
        *,
        assumptions: bool = False,
    ) -> None:
        super().__init__(robot, style, contraction)
        self._view = View(Model(robot, self.style), Assumptions(robot)) if assumptions else None

    def __getattribute__(self, name: str) -> Any:
        """What there is, in symbols with assumptions where these are asked for."""
        own = super().__getattribute__
        view = None if name.startswith("_") or name in ("robot", "style") else own("__dict__").get("_view")
        return own(name) if view is None else getattr(view, name)

    def __getattr__(self, name: str) -> Any:
        """A quantity by another of its names."""
        if name.startswith("_") or hasattr(type(self), name) or "robot" not in vars(self):
            raise AttributeError(f"no attribute {name!r} of this model")
        if name in REGISTRY and 0 not in REGISTRY[name].indices:
            return partial(REGISTRY[name].value, self)
        try:
            parse(self, name)
        except QuantityError as error:
            raise AttributeError(str(error)) from None
        return self.quantity(name)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(name for name, row in REGISTRY.items() if row.is_of(self.robot))})

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

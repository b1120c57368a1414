"""`derive.Model`: the model of a robot under all names of its quantities, as it shows itself in a Jupyter notebook.

The closed forms of `derive.model` know no output and no assumptions; the public class adds them. Closed forms are
derived in plain symbols; for SymPy's own simplifications others are put in, real ones and of masses positive ones.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from inspect import ismethod
from typing import Any

import sympy

from derive.errors import QuantityError
from derive.handouts.notation.symbols import bold
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.language import Text
from derive.lecture.sympy_conversion import Expr, aligned_latex
from derive.model.entries import ModelEntries
from derive.model.model import Model as ClosedForms
from derive.model.quantities import REGISTRY
from derive.model.quantity_names import parse
from derive.robot.evaluate import parameter_values
from derive.robot.expression import Name
from derive.robot.options.style import Style
from derive.robot.robot import Robot

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

    def _repr_latex_(self) -> str | None:
        """T, J and, where the robot has links, B and g, in the notation of the handout; None of a tree."""
        if self.robot.is_tree:
            return None
        robot = replace(self.robot, style=self.style)
        context = Context(ModelEntries(ClosedForms(robot)), robot.handout, Text())
        letter = context.symbols.inertia_letter
        names = {"T": "T", "J": "J"} | ({"B": letter, "g": "g"} if robot.has_dynamics else {})
        lines: list[str] = []
        for group, (name, shown) in enumerate(names.items()):
            namer = partial(context.symbols.entry, shown.lower())
            quantity = getattr(context.entries, name)
            laid_out = context.layouter.lay_out(bold(shown), namer, quantity, group=group, symmetric=name == "B")
            printed = [*laid_out.named, *laid_out.lines]
            whole = printed and not laid_out.omitted and not laid_out.landscape and len(printed) <= MOST_LINES
            lines += printed if whole else [f"\\mathbf{{{shown}}} = \\cdots"]
        return aligned_latex(lines)


def plain(value: Any) -> Any:
    """A SymPy expression in plain symbols; what is none as it is."""
    if not isinstance(value, sympy.Basic | sympy.MatrixBase):
        return value
    return value.xreplace({symbol: type(symbol)(symbol.name) for symbol in value.free_symbols})


class Assumptions:
    """Puts symbols with assumptions into whatever a model gives out.

    A mass is a symbol that is by itself the mass of a link or rotor, unless the file gives it the number zero.
    """

    def __init__(self, robot: Robot) -> None:
        cells = [cell for link in robot.links for cell in (link.mass, link.motor.mass if link.motor else None)]
        numbers = parameter_values(robot)
        self._masses = {cell.name for cell in cells if isinstance(cell, Name) and numbers.get(cell.name, 1) > 0}
        self._written: dict[Expr, Expr] = {}

    def __getstate__(self) -> dict[str, Any]:
        return {"_masses": self._masses, "_written": {}}

    def __call__(self, value: Any) -> Any:
        """The value with these symbols: an expression, a matrix, a collection of them, or what has or returns them."""
        if isinstance(value, sympy.MatrixBase):
            return value.applyfunc(self._expression)
        if isinstance(value, sympy.Basic):
            return self._expression(value)
        if isinstance(value, Mapping):
            return {self(key): self(entry) for key, entry in value.items()}
        if isinstance(value, list | tuple):
            return type(value)(map(self, value))
        if ismethod(value) or isinstance(value, partial):
            return lambda *arguments, **named: self(
                value(*map(plain, arguments), **{name: plain(argument) for name, argument in named.items()})
            )
        is_ours = type(value).__module__.startswith(("derive.model.", "derive.inverse.", "derive.notebook"))
        return View(value, self) if is_ours else value

    def _expression(self, e: Expr) -> Expr:
        if e not in self._written:
            if isinstance(e, sympy.Symbol):
                made = type(e)(e.name, **{"positive" if e.name in self._masses else "real": True})
            else:
                arguments = [self._expression(argument) for argument in e.args]
                made = e.func(*arguments) if arguments else e
                # brackets stay where a number is outside
                if (e.is_Add or e.is_Mul) and set(made.args) != set(arguments):
                    made = e.func(*arguments, evaluate=False)
            self._written[e] = made
        return self._written[e]


class View:
    """Something that a model gives out, such as its inverse kinematics, with the symbols of `Assumptions`."""

    def __init__(self, value: Any, assumed: Assumptions) -> None:
        self._value, self._assumed = value, assumed

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name in ("_value", "_assumed"):  # asked for before there is anything, by pickle
            raise AttributeError(name)
        return self._assumed(getattr(self._value, name))

    def __getitem__(self, place: Any) -> Any:
        return self._assumed(self._value[place])

    def __repr__(self) -> str:
        return repr(self._value)

"""What the parts of one handout share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from derive.handout.dynamics import DynamicsLayout
from derive.handout.language import Text
from derive.handout.layout.policy import POLICY, SheetPolicy
from derive.handout.layout.quantity import Layouter
from derive.handout.notation.notation import Notation
from derive.handout.notation.printer import LatexPrinter
from derive.handout.notation.symbols import Symbols
from derive.handout.quantity import Quantities
from derive.handout.rate_forms import RateForms
from derive.handout.tables import DataPrinter
from derive.robot.robot import Robot
from derive.robot.style import Derivation, HandoutOptions

Pose = tuple[tuple[float, ...], ...]
"""A 4x4 transform."""


class Poses(Protocol):
    """Where the frames of the robot are, in numbers; symbols without a number have the values of a figure."""

    @property
    def zero(self) -> tuple[float, ...]:
        """The zero configuration [rad or m]."""

    @property
    def configuration(self) -> tuple[float, ...] | None:
        """The figure configuration [rad or m], None if the robot file states none."""

    @property
    def assumed(self) -> tuple[tuple[str, float, str], ...]:
        """Symbols drawn with a number that no file gives: name, value and unit (``m`` or ``rad``)."""

    def frames(self, q: Sequence[float]) -> tuple[Pose, ...]:
        """Base frame 0, frames 1 to n and the end effector in the world [m]."""


Numbers = Callable[[str, Sequence[float]], Sequence[Sequence[float]]]
"""Value of T, J, B or g, by name, at a configuration; symbols without a number have those of the figure.

Its argument is the joint variables [rad or m]; its result the rows of a matrix, g a column.
"""


@dataclass(frozen=True)
class Context:
    """One robot on its way to a handout.

    Attributes:
        robot: The robot.
        quantities: Its derived quantities by name.
        options: What the handout shows.
        text: Translates messages.
        version: Version of the tool.
        poses: Where its frames are, for figures; None where nothing is drawn.
        numbers: Its quantities at a configuration, for the example; None where there is none.
        policy: How much is printed.
    """

    robot: Robot
    quantities: Quantities
    options: HandoutOptions
    text: Text
    version: str
    poses: Poses | None = None
    numbers: Numbers | None = None
    policy: SheetPolicy = POLICY

    @cached_property
    def notation(self) -> Notation:
        """How symbols are written."""
        return Notation.of(self.robot, self.options.notation)

    @cached_property
    def symbols(self) -> Symbols:
        """Names of entries."""
        return Symbols(self.notation, self.robot.n)

    @cached_property
    def printer(self) -> LatexPrinter:
        """Prints expressions."""
        return LatexPrinter(self.notation)

    @cached_property
    def layouter(self) -> Layouter:
        """Lays out quantities."""
        return Layouter(self.printer, self.policy, self.symbols.term, self.text("terms"))

    @cached_property
    def data(self) -> DataPrinter:
        """Prints cells of the robot file."""
        return DataPrinter(self.robot, self.notation)

    @cached_property
    def dynamics(self) -> DynamicsLayout:
        """Lays out the dynamics; sizes and Christoffel symbols are found once for all parts."""
        letter = self.options.notation.inertia.value
        return DynamicsLayout(self.robot, self.quantities, self.layouter, self.symbols, letter)

    @cached_property
    def rate_forms(self) -> RateForms:
        """C, N and the equations of motion in named terms."""
        return RateForms(self.dynamics)

    @property
    def has_closed_dynamics(self) -> bool:
        """Whether the closed form of the dynamics is derived: the robot has links, and not too many joints."""
        return self.robot.has_dynamics and self.robot.n <= self.policy.closed_form_joints

    @property
    def steps(self) -> bool:
        """Whether intermediate steps are shown."""
        return self.options.derivation is Derivation.STEPS

"""What the parts of one handout share: the robot, its closed forms, the options, and what prints them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from derive.handouts.data_printer import DataPrinter
from derive.handouts.dynamics import DynamicsLayout
from derive.handouts.figure.poses import RobotPoses
from derive.handouts.language import Text
from derive.handouts.layout.policy import POLICY, SheetPolicy
from derive.handouts.layout.quantity import Layouter
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import LatexPrinter
from derive.handouts.notation.symbols import Symbols
from derive.model.dynamic_entries import ModelEntries
from derive.robot.description import Convention
from derive.robot.robot import Robot
from derive.robot.style import Derivation, HandoutOptions


@dataclass(frozen=True)
class Context:
    """One robot on its way to a handout.

    Attributes:
        entries: Its closed forms, entry by entry.
        options: What the handout shows.
        text: Translates messages.
        version: Version of the tool.
        poses: Where its frames are, for figures; None where nothing is drawn.
        policy: How much is printed.
    """

    entries: ModelEntries
    options: HandoutOptions
    text: Text
    version: str
    poses: RobotPoses | None = None
    policy: SheetPolicy = POLICY

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self.entries.robot

    @property
    def is_standard(self) -> bool:
        """Whether the convention is the standard one, in which joint i moves about z of frame i-1."""
        return self.robot.convention is Convention.STANDARD

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
        """Lays out the dynamics."""
        return DynamicsLayout(self.entries, self.layouter, self.symbols)

    @property
    def has_closed_dynamics(self) -> bool:
        """Whether the closed form of the dynamics is derived: the robot has links, and not too many joints."""
        return self.robot.has_dynamics and self.robot.n <= self.policy.closed_form_joints

    @property
    def steps(self) -> bool:
        """Whether intermediate steps are shown."""
        return self.options.derivation is Derivation.STEPS

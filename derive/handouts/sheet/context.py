"""What the parts of one handout share: the robot, its closed forms, the options, and what prints them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from derive.handouts.layout.quantity import POLICY, Layouter, SheetPolicy
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import DataPrinter, LatexPrinter
from derive.handouts.notation.symbols import Symbols
from derive.handouts.sheet.dynamics import DynamicsLayout
from derive.handouts.sheet.language import Text
from derive.model.dynamic_entries import ModelEntries
from derive.robot.description import Convention
from derive.robot.options.handout import Derivation, HandoutOptions
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses


@dataclass(eq=False)
class Context:
    """One robot on its way to a handout. What follows from the first six is made with it.

    Attributes:
        entries: Its closed forms, entry by entry.
        options: What the handout shows.
        text: Translates messages.
        version: Version of the tool.
        poses: Where its frames are, for figures; None where nothing is drawn.
        policy: How much is printed.
        robot: The robot.
        is_standard: Whether the convention is the standard one, in which joint i moves about z of frame i-1.
        has_closed_dynamics: Whether the closed form of the dynamics is derived: it has links, few joints.
        steps: Whether intermediate steps are shown.
        notation: How symbols are written.
        symbols: Names of entries.
        printer: Prints expressions.
        layouter: Lays out quantities.
        data: Prints cells of the robot file.
        dynamics: Lays out the dynamics.
    """

    entries: ModelEntries
    options: HandoutOptions
    text: Text
    version: str
    poses: RobotPoses | None = None
    policy: SheetPolicy = POLICY
    robot: Robot = field(init=False)
    is_standard: bool = field(init=False)
    has_closed_dynamics: bool = field(init=False)
    steps: bool = field(init=False)
    notation: Notation = field(init=False)
    symbols: Symbols = field(init=False)
    printer: LatexPrinter = field(init=False)
    layouter: Layouter = field(init=False)
    data: DataPrinter = field(init=False)
    dynamics: DynamicsLayout = field(init=False)

    def __post_init__(self) -> None:
        robot = self.robot = self.entries.robot
        self.is_standard = robot.convention is Convention.STANDARD
        self.has_closed_dynamics = robot.has_dynamics and robot.n <= self.policy.closed_form_joints
        self.steps = self.options.derivation is Derivation.STEPS
        notation = Notation.of(robot, self.options.notation, comma=self.text.comma)
        self.notation = replace(notation, degrees=robot.units.degrees)
        self.symbols = Symbols(self.notation, robot.n)
        self.printer = LatexPrinter(self.notation)
        self.layouter = Layouter(self.printer, self.policy, self.symbols.term, self.text("terms"))
        self.data = DataPrinter(robot, self.notation)
        self.dynamics = DynamicsLayout(self.entries, self.layouter, self.symbols)

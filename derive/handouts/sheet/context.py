"""What the parts of one handout share: the robot, its closed forms, the options, and what prints them."""

from dataclasses import dataclass, field, replace

from derive.handouts.layout.quantity import POLICY, Layouter, SheetPolicy
from derive.handouts.notation.notation import Notation
from derive.handouts.notation.printer import DataPrinter, LatexPrinter
from derive.handouts.notation.symbols import Symbols
from derive.handouts.sheet.document import Paragraph
from derive.handouts.sheet.dynamics import DynamicsLayout
from derive.handouts.sheet.language import Text
from derive.model.entries import ModelEntries
from derive.robot.description import Convention
from derive.robot.options.handout import Derivation, HandoutOptions
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses


@dataclass(eq=False)
class Context:
    """One robot on its way to a handout. What follows from the first six is made with it."""

    entries: ModelEntries  # its closed forms, entry by entry
    options: HandoutOptions  # what the handout shows
    text: Text  # translates messages
    version: str  # version of the tool
    poses: RobotPoses | None = None  # where its frames are, for figures; None where nothing is drawn
    policy: SheetPolicy = POLICY  # how much is printed
    robot: Robot = field(init=False)
    # Whether the convention is the standard one, in which joint i moves about z of frame i-1.
    is_standard: bool = field(init=False)
    # Whether the closed form of the dynamics is derived: it has links, few joints.
    has_closed_dynamics: bool = field(init=False)
    steps: bool = field(init=False)  # whether intermediate steps are shown
    notation: Notation = field(init=False)  # how symbols are written
    symbols: Symbols = field(init=False)  # names of entries
    printer: LatexPrinter = field(init=False)  # prints expressions
    layouter: Layouter = field(init=False)  # lays out quantities
    data: DataPrinter = field(init=False)  # prints cells of the robot file
    dynamics: DynamicsLayout = field(init=False)  # lays out the dynamics

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

    def paragraph(self, message: str, **values: object) -> Paragraph:
        """A message in the reader's language."""
        return Paragraph(self.text(message, **values))

    def answer(self, message: str, **values: object) -> Paragraph:
        """The same, of what an exercise asks for."""
        return Paragraph(self.text(message, **values), is_answer=True)

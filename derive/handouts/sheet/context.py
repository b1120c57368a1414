"""What the parts of one handout share: the robot, its closed forms, the options, and what prints them."""

from dataclasses import replace

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
from derive.workspace.poses import RobotPoses


class Context:
    """One robot on its way to a handout."""

    def __init__(
        self,
        entries: ModelEntries,  # its closed forms, entry by entry
        options: HandoutOptions,  # what the handout shows
        text: Text,  # translates messages
        version: str,  # version of the tool
        poses: RobotPoses | None = None,  # where its frames are, for figures; None where nothing is drawn
        policy: SheetPolicy = POLICY,  # how much is printed
    ) -> None:
        self.entries, self.options, self.text, self.version = entries, options, text, version
        self.poses, self.policy = poses, policy
        robot = self.robot = entries.robot
        # Whether the convention is the standard one, in which joint i moves about z of frame i-1.
        self.is_standard = robot.convention is Convention.STANDARD
        # Whether the closed form of the dynamics is derived: it has links, few joints.
        self.has_closed_dynamics = robot.has_dynamics and robot.n <= policy.closed_form_joints
        self.steps = options.derivation is Derivation.STEPS  # whether intermediate steps are shown
        notation = Notation.of(robot, options.notation, comma=text.comma)
        self.notation = replace(notation, degrees=robot.units.degrees)  # how symbols are written
        self.symbols = Symbols(self.notation, robot.n)  # names of entries
        self.printer = LatexPrinter(self.notation)  # prints expressions
        self.layouter = Layouter(self.printer, policy, self.symbols.term, text("terms"))  # lays out quantities
        self.data = DataPrinter(robot, self.notation)  # prints cells of the robot file
        self.dynamics = DynamicsLayout(entries, self.layouter, self.symbols)  # lays out the dynamics

    def paragraph(self, message: str, **values: object) -> Paragraph:
        """A message in the reader's language."""
        return Paragraph(self.text(message, **values))

    def answer(self, message: str, **values: object) -> Paragraph:
        """The same, of what an exercise asks for."""
        return Paragraph(self.text(message, **values), is_answer=True)

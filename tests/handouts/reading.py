"""What a reader finds in a part of a handout: its words and its lines of mathematics."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from derive.handouts.assemble import context_of, section_of
from derive.handouts.layout.quantity import POLICY, SheetPolicy
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Document, Figure, Paragraph, Rows, Section, SheetFormula, blocks_of
from derive.handouts.sheet.language import Text
from derive.model.entries import ModelEntries
from derive.model.model import Model
from derive.robot.options.handout import Derivation, HandoutOptions, NotationOptions
from derive.robot.robot import Robot
from tests.rows import text_of_rows

REACHED = text_of_rows(
    "R d: 0.4, a: 0.3, alpha: pi/2, limits: [-pi, 0.3] | R a: a2 | P q: d3, d: -d3, alpha: -pi/2",
    """
links:
  - {mass: 3, com: [-0.1, 0, 0], inertia: {zz: 0.2}}
  - {mass: m2, com: [-0.1, 0, 0], inertia: {zz: 0.2}}
  - {mass: 1, com: [0, 0.1, 0], inertia: {zz: 0.1}}
gravity: [0, 0, -9.81]
parameters: {a2: 0.5, m2: 2}
""",
)


def part(robot: Robot | str, name: str, *, steps: bool = False, **options: Any) -> Section:
    """A part of the handout of a robot, of a built-in one by its name, or by the text of its file."""
    if isinstance(robot, str):
        robot = Robot.from_text(robot) if "\n" in robot else Robot.load(robot)
    derivation = Derivation.STEPS if steps else Derivation.RESULT
    found = section_of(context_of(robot, replace(robot.handout, derivation=derivation, **options)), name)
    assert found is not None
    return found


def bare_context(robot: Robot, *, steps: bool = True, policy: SheetPolicy = POLICY, **notation: Any) -> Context:
    """What the parts of a handout in English are made from, without figures."""
    derivation = Derivation.STEPS if steps else Derivation.RESULT
    options = HandoutOptions(derivation=derivation, notation=NotationOptions(**notation))
    return Context(ModelEntries(Model(robot)), options, Text(), policy=policy)


def changed(context: Context, **changes: Any) -> Context:
    """What the parts of a handout are made from, with something else in it."""
    given = {name: getattr(context, name) for name in ("entries", "options", "text", "poses", "policy")}
    return Context(**(given | changes))


def document_of(context: Context, parts: Iterable[str]) -> Document:
    """A sheet of some parts, as far as the robot has them."""
    found = (section_of(context, part) for part in parts)
    sections = tuple(section for section in found if section is not None)
    return Document("Arm", "", context.robot.name, "0" * 64, "", sections)


def words(section: Section) -> str:
    told = (block for block in blocks_of(section) if isinstance(block, Paragraph | Figure))
    return " ".join(block.text if isinstance(block, Paragraph) else block.caption for block in told)


def lines(blocks: Iterable[Block]) -> list[str]:
    rows = (b.rows if isinstance(b, SheetFormula) else (b,) for b in blocks if isinstance(b, SheetFormula | Rows))
    return [line for some in rows for row in some for line in row.lines]

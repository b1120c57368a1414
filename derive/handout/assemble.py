"""From the context of a robot to its handout: the parts that are asked for, in their order.

An exercise and its solutions, two sheets of one handout.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from derive.errors import DeriveError
from derive.handout.context import Context
from derive.handout.document import Blank, Block, Document, Formula, Rows, Section, Steps, map_blocks
from derive.handout.example import Example
from derive.handout.figure.poses import RobotPoses
from derive.handout.language import Text, text_for
from derive.handout.parts import (
    energies,
    example,
    figure,
    inertia,
    jacobian,
    kinematics,
    motion,
    newton_euler,
    orientation,
    singularities,
    table,
)
from derive.handout.quantities import ModelQuantities
from derive.robot.robot import Robot
from derive.robot.style import PARTS, HandoutOptions
from derive.version import __version__

Part = Callable[[Context], Section | None]

_SECTIONS: dict[str, Part] = {
    "figure": figure.figure_section,
    "table": table.table_section,
    "convention": figure.convention_section,
    "parameters": table.parameters_section,
    "transforms": kinematics.transforms_section,
    "kinematics": kinematics.kinematics_section,
    "orientation": orientation.section,
    "jacobian": jacobian.section,
    "singularities": singularities.section,
    "link-jacobians": inertia.link_jacobians_section,
    "energies": energies.section,
    "inertia": inertia.inertia_section,
    "christoffel": motion.christoffel_section,
    "coriolis": motion.coriolis_section,
    "skew": motion.skew_section,
    "gravity": motion.gravity_section,
    "motion": motion.motion_section,
    "newton-euler": newton_euler.section,
    "example": example.section,
}


def context_of(robot: Robot, options: HandoutOptions | None = None) -> Context:
    """What the handout of a robot is made from.

    Args:
        robot: The robot.
        options: What is shown; None for what the robot file says.

    Raises:
        TargetError: There is no message catalogue for the language.
    """
    chosen = options or robot.handout
    return Context(
        robot=robot,
        quantities=ModelQuantities(robot),
        options=chosen,
        text=text_for(chosen.language),
        version=__version__,
        poses=_poses(robot),
        numbers=Example(robot),
    )


def _poses(robot: Robot) -> RobotPoses | None:
    """Where its frames are; None if no numbers are found with which it could be drawn."""
    try:
        return RobotPoses(robot)
    except DeriveError:
        return None


def document(context: Context) -> Document:
    """The handout of a robot."""
    _ = context.text
    robot = context.robot
    digest = robot.digest[:16]
    footer = _("derive %(version)s, robot file `%(digest)s`", version=context.version, digest=digest)
    wanted = [part for part in PARTS if part in context.options.parts]
    sections = (section_of(context, part) for part in wanted)
    return Document(
        title=robot.title,
        subtitle="",
        name=robot.name,
        language=context.text.language,
        digest=robot.digest,
        version=context.version,
        footer=footer,
        sections=tuple(section for section in sections if section is not None),
    )


def section_of(context: Context, part: str) -> Section | None:
    """One part; None where the robot has nothing to show there."""
    return _SECTIONS[part](context)


LEAST_LINES = 2
MOST_LINES = 24
"""Lines of room for one answer: less than half a page, however long the solution is."""

_HANDWRITING = 1.5
"""Lines by hand for one in print."""


def exercise(document: Document, text: Text) -> Document:
    """The handout with room for the answers in place of the results; derivations are left out.

    Args:
        document: The handout.
        text: Translates the subtitle.
    """
    blank = map_blocks(document, _question)
    sections = tuple(section for section in blank.sections if section.blocks)
    return replace(blank, subtitle=text("Exercise"), sections=sections)


def solutions(document: Document, text: Text) -> Document:
    """The same handout as the sheet of solutions.

    Args:
        document: The handout.
        text: Translates the subtitle.
    """
    return replace(document, subtitle=text("Solutions"))


def _question(block: Block) -> Block | None:
    if isinstance(block, Steps):
        return None
    return Blank(block.blanks, room(block)) if isinstance(block, Formula) and block.blanks else block


def room(formula: Formula) -> int:
    """Lines that the answer needs by hand."""
    printed = [*(line for rows in formula.rows for line in _lines(rows)), *formula.named, *formula.omitted]
    return max(LEAST_LINES, min(MOST_LINES, round(_HANDWRITING * len(printed))))


def _lines(rows: Rows) -> Iterable[str]:
    r"""Lines on paper: a matrix takes one for each of its rows, which ``\\`` ends."""
    return (part for line in rows.lines for part in line.split("\\\\"))

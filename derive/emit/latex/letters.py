r"""The letters of the joint variables: q1 written \theta_1, \vartheta_1 or q_1, d3 written d_3 or q_3.

The index is the label of the joint, the digits at the end of the variable's name. A variable without a label keeps its
name, and so does one whose letter and index would look like another symbol of the robot.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from derive.emit.latex.metrics import Box, greek, italic
from derive.emit.latex.names import Glyph, natural
from derive.robot.handout import AngleLetter, NotationOptions, SliderLetter
from derive.robot.names import joint_label
from derive.robot.robot import Joint, Robot

_ANGLES: Mapping[AngleLetter, Box] = {
    AngleLetter.THETA: greek("theta"),
    AngleLetter.VARTHETA: greek("vartheta"),
    AngleLetter.Q: italic("q"),
}
_OFFSETS: Mapping[SliderLetter, Box] = {SliderLetter.D: italic("d"), SliderLetter.Q: italic("q")}


def variable_glyphs(robot: Robot, names: Iterable[str], options: NotationOptions) -> dict[str, Glyph]:
    """The joint variables that are written with another letter than in the robot file.

    Args:
        robot: The robot.
        names: Every name that is printed, joint variables included.
        options: Which letters.
    """
    names = tuple(names)
    chosen = {joint.variable: glyph for joint in robot.joints if (glyph := _wanted(joint, options))}
    while clashing := _clashing(names, chosen):
        chosen = {name: glyph for name, glyph in chosen.items() if name not in clashing}
    return chosen


def _wanted(joint: Joint, options: NotationOptions) -> Glyph | None:
    head = _ANGLES.get(options.angle) if joint.is_revolute else _OFFSETS.get(options.prismatic)
    label = joint_label(joint.variable)
    return Glyph(head, italic(label)) if head and label else None


def _clashing(names: tuple[str, ...], chosen: Mapping[str, Glyph]) -> set[str]:
    """Chosen glyphs that another name has too; giving one up may bring back a name that clashes in turn."""
    printed = {name: (chosen.get(name) or natural(name)).box.tex for name in names}
    uses = Counter(printed.values())
    return {name for name in chosen if uses[printed[name]] > 1}

r"""How a name is written: ``ml1`` is m_{l1}, ``Ixx3`` is I_{xx3}, ``alpha1`` is \alpha_{1}.

A name becomes a glyph: a head, a subscript and an accent. What no rule covers, and what would look like another
symbol of the same robot, is set in monospace letters as the user typed it: no two names of a robot look the same.

The letters of the joint variables: q1 written \theta_1, \vartheta_1 or q_1, d3 written d_3 or q_3.

The index is the label of the joint, the digits at the end of the variable's name. A variable without a label keeps its
name, and so does one whose letter and index would look like another symbol of the robot.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from derive.handout.notation.pieces import EMPTY, GREEK, Box, concatenate, greek, italic, monospace, script, upright
from derive.robot.description import Joint
from derive.robot.names import joint_label
from derive.robot.robot import Robot
from derive.robot.style import AngleLetter, NotationOptions, SliderLetter

LONGEST_SUFFIX = 2
"""Letters after the first that still read as a subscript: Ixx, cx, ml; longer names are words."""

_ABBREVIATION = re.compile(r"[cs]_\{[0-9,]+\}")


@dataclass(frozen=True, slots=True)
class Glyph:
    r"""A symbol.

    Attributes:
        head: The letter or word.
        sub: The subscript, empty if there is none.
        accent: ``\dot``, ``\ddot`` or empty.
    """

    head: Box
    sub: Box = EMPTY
    accent: str = ""

    @property
    def box(self) -> Box:
        """The symbol as it is printed."""
        return self.power(EMPTY)

    def power(self, exponent: Box) -> Box:
        """The symbol with an exponent above its subscript."""
        head = self.head
        if self.accent:
            head = Box(f"{self.accent}{{{head.tex.rstrip()}}}", head.width)
        return script(head, self.sub, exponent)

    def dotted(self, accent: str) -> Glyph:
        """The same symbol under dots."""
        return replace(self, accent=accent)


def literal(name: str) -> Glyph:
    """The name as the user typed it."""
    return Glyph(monospace(name))


def natural(name: str) -> Glyph:
    """The name as a textbook would print it."""
    parts = name.split("_")
    match = re.fullmatch(r"([A-Za-z]+)([0-9][A-Za-z0-9]*)?", parts[0])
    if match is None or not all(parts):
        return literal(name)
    head, first = _head(match.group(1))
    digits = match.group(2) or ""
    subscripts = [italic(first + digits)] if first + digits else []
    subscripts += [_subscript(part) for part in parts[1:]]
    return Glyph(head, _join(subscripts))


def _head(letters: str) -> tuple[Box, str]:
    if letters in GREEK and letters != "pi":
        return greek(letters), ""
    if len(letters) <= 1 + LONGEST_SUFFIX:
        return italic(letters[0]), letters[1:]
    return upright(letters), ""


def _subscript(part: str) -> Box:
    if part in GREEK:
        return greek(part)
    letters = part.rstrip("0123456789")
    if len(letters) <= LONGEST_SUFFIX:
        return italic(part)
    return concatenate(upright(letters), italic(part[len(letters) :])) if letters != part else upright(part)


def _join(boxes: list[Box]) -> Box:
    if not boxes:
        return EMPTY
    comma = Box(",", 3.0)
    joined = boxes[0]
    for box in boxes[1:]:
        joined = concatenate(joined, comma, box)
    return joined


def looks_like_abbreviation(glyph: Glyph) -> bool:
    r"""Whether it would be read as the cosine or sine of a joint angle, such as c_{12}."""
    return bool(_ABBREVIATION.fullmatch(glyph.box.tex))


def distinct(names: Iterable[str], chosen: Mapping[str, Glyph] | None = None) -> Iterator[tuple[str, Glyph]]:
    """A glyph for each name; an earlier name keeps its own one where two would look the same.

    Args:
        names: The names.
        chosen: Glyphs to write instead of the natural ones.
    """
    taken: set[str] = set()
    for name in names:
        glyph = (chosen or {}).get(name) or natural(name)
        if glyph.box.tex in taken or looks_like_abbreviation(glyph):
            glyph = literal(name)
        taken.add(glyph.box.tex)
        yield name, glyph


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

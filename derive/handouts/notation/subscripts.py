r"""How a name is written: ``ml1`` is m_{l1}, ``Ixx3`` is I_{xx3}, ``alpha1`` is \alpha_{1}.

A name becomes a glyph: a head, a subscript and an accent. What no rule covers, and what would look like another
symbol of the same robot, is set in monospace letters as the user typed it: no two names of a robot look the same.

Joint variables may have another letter than in the robot file (q1 written \theta_1, \vartheta_1 or q_1, d3 written d_3
or q_3); their index is the label of the joint, the digits at the end of the variable's name. A variable without a
label keeps its name, and so does one whose letter and index would look like another symbol of the robot.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from derive.handouts.notation.pieces import EMPTY, GREEK, Box, concatenate, greek, italic, monospace, script, upright
from derive.robot.names import joint_label
from derive.robot.options.handout import AngleLetter, NotationOptions, SliderLetter
from derive.robot.robot import Robot

LONGEST_SUFFIX = 2  # letters after the first that still read as a subscript: Ixx, cx, ml; longer names are words
_COMMA = Box(",", 3.0)
_ABBREVIATION = re.compile(r"[cs]_\{[0-9,]+\}")  # what is read as the cosine or sine of a joint angle, such as c_{12}
_REVOLUTE_LETTERS: Mapping[AngleLetter, Box] = {
    AngleLetter.THETA: greek("theta"),
    AngleLetter.VARTHETA: greek("vartheta"),
    AngleLetter.Q: italic("q"),
}
_PRISMATIC_LETTERS: Mapping[SliderLetter, Box] = {SliderLetter.D: italic("d"), SliderLetter.Q: italic("q")}


@dataclass(frozen=True, slots=True)
class Glyph:
    r"""A symbol."""

    head: Box  # the letter or word
    sub: Box = EMPTY  # the subscript, empty if there is none
    accent: str = ""  # ``\dot``, ``\ddot`` or empty

    @property
    def box(self) -> Box:
        """The symbol as it is printed."""
        return self.power(EMPTY)

    def power(self, exponent: Box) -> Box:
        """The symbol raised to a power."""
        head = self.head
        if self.accent:
            head = Box(f"{self.accent}{{{head.tex.rstrip()}}}", head.width)
        return script(head, self.sub, exponent)


def natural(name: str) -> Glyph:
    """A name as a textbook would print it, else in monospace letters."""
    parts = name.split("_")
    match = re.fullmatch(r"([A-Za-z]+)([0-9][A-Za-z0-9]*)?", parts[0])
    if match is None or not all(parts):
        return Glyph(monospace(name))
    letters, suffix = match.group(1), ""
    if letters in GREEK and letters != "pi":
        head = greek(letters)
    elif len(letters) <= 1 + LONGEST_SUFFIX:
        head, suffix = italic(letters[0]), letters[1:]
    else:
        head = upright(letters)
    suffix += match.group(2) or ""
    subscripts = [italic(suffix)] if suffix else []
    for part in parts[1:]:  # behind an underscore: a Greek letter, an index, or a word with or without one
        word = part.rstrip("0123456789")
        if part in GREEK:
            subscripts.append(greek(part))
        elif len(word) <= LONGEST_SUFFIX:
            subscripts.append(italic(part))
        elif word == part:
            subscripts.append(upright(part))
        else:
            subscripts.append(concatenate(upright(word), italic(part[len(word) :])))
    commas = (box for subscript in subscripts for box in (_COMMA, subscript))
    return Glyph(head, concatenate(*list(commas)[1:]) if subscripts else EMPTY)


def distinct(names: Iterable[str], chosen: Mapping[str, Glyph] | None = None) -> Iterator[tuple[str, Glyph]]:
    """A glyph for each name; an earlier name keeps its own one where two would look the same."""
    taken: set[str] = set()
    for name in names:
        glyph = (chosen or {}).get(name) or natural(name)
        if glyph.box.tex in taken or _ABBREVIATION.fullmatch(glyph.box.tex):
            glyph = Glyph(monospace(name))
        taken.add(glyph.box.tex)
        yield name, glyph


def variable_glyphs(robot: Robot, names: Iterable[str], options: NotationOptions) -> dict[str, Glyph]:
    """The joint variables that are written with another letter than in the robot file."""
    names = tuple(names)
    chosen: dict[str, Glyph] = {}
    turning, sliding = _REVOLUTE_LETTERS.get(options.angle), _PRISMATIC_LETTERS.get(options.prismatic)
    for mover in (*robot.variables, *robot.passive):
        letters, label = turning if mover.is_revolute else sliding, joint_label(mover.variable)
        if letters and label:
            chosen[mover.variable] = Glyph(letters, italic(label))
    while True:  # giving one glyph up may bring back a name that clashes with another in turn
        printed = {name: (chosen.get(name) or natural(name)).box.tex for name in names}
        uses = Counter(printed.values())
        clashing = {name for name in chosen if uses[printed[name]] > 1}
        if not clashing:
            return chosen
        chosen = {name: glyph for name, glyph in chosen.items() if name not in clashing}

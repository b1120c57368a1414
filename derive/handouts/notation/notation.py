"""The notation of one robot: how each of its symbols is written, and which angles are abbreviated.

c_{12} stands for cos(q1 + q2), labels being the digits at the end of the joint variables' names. As soon as one label
has two digits every sum is written with commas, c_{1,2}, so that c_{12} can only be the cosine of joint 12.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from derive.handouts.notation.names import Glyph, distinct, natural, variable_glyphs
from derive.handouts.notation.numbers import DIGITS
from derive.handouts.notation.pieces import Box, italic, script
from derive.robot.expression import Number, Sum, names
from derive.robot.names import acceleration_name, expressions, joint_label, limit_symbols, robot_symbols, velocity_name
from derive.robot.robot import Robot
from derive.robot.style import Functions, NotationOptions

DATA_DIGITS = 15
"""Significant digits of the numbers in tables, which are the user's."""


@dataclass(frozen=True)
class Notation:
    """How the symbols of a robot are written.

    Attributes:
        glyphs: The symbol of every name, velocities and accelerations included.
        positions: Place of every name in the order of factors: parameters, joint variables, velocities, accelerations.
        labels: Joint variable of a revolute joint -> its label; a joint without a unique label is missing.
        inertial: Masses, inertias and ratios, in the order of the links.
        decimals: Whether rationals are printed as decimals.
        digits: Significant digits of a number in print.
        options: What the robot file or the reader chose.
    """

    glyphs: Mapping[str, Glyph]
    positions: Mapping[str, tuple[int, int]]
    labels: Mapping[str, str]
    inertial: Mapping[str, int]
    decimals: bool
    digits: int = DIGITS
    options: NotationOptions = field(default_factory=NotationOptions)

    @classmethod
    def of(cls, robot: Robot, options: NotationOptions | None = None) -> Notation:
        """The notation of a robot.

        Args:
            robot: The robot.
            options: How variables are written; None for as in the robot file.
        """
        options = options or NotationOptions()
        labels = {joint.variable: joint_label(joint.variable) for joint in robot.joints if joint.is_revolute}
        uses = Counter(labels.values())
        return cls(
            glyphs=dict(_glyphs(robot, options)),
            positions=_positions(robot),
            labels={variable: label for variable, label in labels.items() if label and uses[label] == 1},
            inertial=_inertial(robot),
            decimals=_is_given_in_decimals(robot),
            options=options,
        )

    def glyph(self, name: str) -> Glyph:
        """The symbol of a name.

        Args:
            name: As in the robot file, or any other name, which is then written in its natural way.
        """
        return self.glyphs.get(name) or natural(name)

    def for_data(self) -> Notation:
        """The notation for the user's own numbers: decimals, with every digit."""
        return replace(self, decimals=True, digits=DATA_DIGITS)

    def with_terms(self, terms: Mapping[str, Glyph]) -> Notation:
        """The same notation with further symbols, for named intermediate terms.

        Args:
            terms: Name -> symbol.
        """
        return replace(self, glyphs={**self.glyphs, **terms})

    @property
    def abbreviates(self) -> bool:
        """Whether c_{12} is written for the cosine of a sum of joint angles."""
        return self.options.functions is Functions.SHORT

    @cached_property
    def taken(self) -> frozenset[str]:
        """LaTeX of every symbol of the robot."""
        return frozenset(glyph.box.tex for glyph in self.glyphs.values())

    @cached_property
    def label_order(self) -> dict[str, int]:
        """Joint variable -> its place, for the order of labels in a sum."""
        return {variable: index for index, variable in enumerate(self.labels)}

    @cached_property
    def separator(self) -> str:
        """What stands between the labels of a sum."""
        return "," if any(len(label) > 1 for label in self.labels.values()) else ""

    def abbreviation(self, letter: str, variables: tuple[str, ...], exponent: Box) -> Box:
        """The abbreviated cosine or sine of a sum of joint angles, raised to a power.

        Args:
            letter: ``c`` or ``s``.
            variables: The joint variables that are added, in the order of their labels.
            exponent: The power; empty for 1.
        """
        text = self.separator.join(self.labels[variable] for variable in variables)
        return script(italic(letter), italic(text), exponent)


def _glyphs(robot: Robot, options: NotationOptions) -> Iterator[tuple[str, Glyph]]:
    variables = [joint.variable for joint in robot.joints]
    everything = dict.fromkeys((*variables, *robot_symbols(robot), *(name for name, _ in robot.parameters)))
    printed = dict.fromkeys((*everything, *limit_symbols(robot)))
    for name, glyph in distinct(everything, variable_glyphs(robot, printed, options)):
        yield name, glyph
        if name in variables:
            yield velocity_name(name), glyph.dotted("\\dot")
            yield acceleration_name(name), glyph.dotted("\\ddot")


def _positions(robot: Robot) -> dict[str, tuple[int, int]]:
    positions = {name: (0, index) for index, name in enumerate(robot_symbols(robot))}
    for index, joint in enumerate(robot.joints):
        positions[joint.variable] = (1, index)
        positions[velocity_name(joint.variable)] = (2, index)
        positions[acceleration_name(joint.variable)] = (3, index)
    return positions


def _inertial(robot: Robot) -> dict[str, int]:
    found: dict[str, None] = {}
    for link in robot.links:
        inertia = link.inertia
        cells = [link.mass, inertia.xx, inertia.yy, inertia.zz, inertia.xy, inertia.xz, inertia.yz, link.armature]
        if link.motor is not None:
            cells += [link.motor.ratio, link.motor.mass, link.motor.inertia]
        found.update(dict.fromkeys(name for cell in cells for name in names(cell)))
    return {name: index for index, name in enumerate(found)}


def _is_given_in_decimals(robot: Robot) -> bool:
    """Whether a cell is, or adds, a number that is not whole."""
    for cell in expressions(robot):
        terms = cell.terms if isinstance(cell, Sum) else (cell,)
        if any(isinstance(term, Number) and term.value.denominator != 1 for term in terms):
            return True
    return False

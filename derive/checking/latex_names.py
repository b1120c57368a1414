r"""Names as LaTeX prints them, found among the names of a robot: ``m_{\ell_1}`` is ml1, ``\vartheta_2`` joint 2."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from derive.errors import CheckError
from derive.lecture.shorthand import resolve_tokens
from derive.robot.expression import Call, Expression, Name, Pi
from derive.robot.names import acceleration_name, joint_label, robot_symbols, velocity_name
from derive.robot.robot import Robot

FLAT = {"ell": "l", "vartheta": "theta", "varphi": "phi", "varepsilon": "epsilon"}
"""Macros that are another way to draw a letter."""

_JOINT = re.compile(r"(theta|q|d)([0-9]+)")
_CIRCULAR = re.compile(r"([csCS])((?:(?:theta|q)?[0-9]+)+)")
_GREEK = re.compile("(?:alpha|beta|gamma|theta|phi|psi)[0-9]*")
_ANGLE = {"c": "cos", "s": "sin"}


@dataclass(frozen=True, slots=True)
class Symbol:
    """A printed name.

    Attributes:
        text: Its letters and digits, scripts set on the line.
        offset: Where it begins.
        dots: Derivatives with respect to time.
    """

    text: str
    offset: int
    dots: int = 0


class LatexNames:
    """What printed names stand for.

    An exact name of the robot comes first, then joint variables and tokens such as c_{12}; then names that differ only
    in underscores, in the place of the digits, or in case, if there is exactly one.

    Args:
        robot: Its symbols and joints.
        abbreviations: Further names and what they stand for.
    """

    def __init__(self, robot: Robot, abbreviations: Mapping[str, Expression] | None = None) -> None:
        self.robot = robot
        self.abbreviations = dict(abbreviations or {})
        variables = [joint.variable for joint in robot.joints]
        self.own = frozenset((*robot_symbols(robot), *variables, *self.abbreviations))

    def meaning(self, symbol: Symbol) -> Expression:
        """The expression that a printed name stands for.

        Args:
            symbol: The name.

        Raises:
            CheckError: An unknown name, or one that can be read in two ways.
        """
        text = symbol.text
        if text == "pi":
            return Pi()
        if symbol.dots:
            return self._derivative(symbol)
        # the Greek angle in c_{\alpha_1}; only of letters that are never lengths
        angle = text[1:]
        if text not in self.own and text[0].lower() in _ANGLE and _GREEK.fullmatch(angle) and angle in self.own:
            return Call(_ANGLE[text[0].lower()], (Name(angle),))
        return resolve_tokens(Name(self._name(text)), self.robot, self.abbreviations)

    def circular(self, symbol: Symbol) -> str:
        r"""``cos`` or ``sin`` where c or s stands for the function, as in ``c\theta_1``; otherwise empty.

        Args:
            symbol: The name.
        """
        plain = symbol.text.lower() in _ANGLE and not symbol.dots and symbol.text not in self.own
        return _ANGLE[symbol.text.lower()] if plain else ""

    def _derivative(self, symbol: Symbol) -> Expression:
        """The velocity or acceleration of a joint."""
        variables = [joint.variable for joint in self.robot.joints]
        name = self._name(symbol.text)
        if name not in variables:
            raise CheckError(
                f"derivative of {symbol.text}, which is no joint variable", allowed=f"allowed: {', '.join(variables)}"
            )
        if symbol.dots > 2:
            raise CheckError(f"{symbol.dots} dots", allowed="one for a velocity, two for an acceleration")
        return Name(velocity_name(name) if symbol.dots == 1 else acceleration_name(name))

    def _name(self, text: str) -> str:
        """The robot's name, or the token, that is printed like this; the text itself where there is none."""
        if text in self.own:
            return text
        if (match := _JOINT.fullmatch(text)) and (variable := self._variable(match[1], match[2])):
            return variable
        if match := _CIRCULAR.fullmatch(text):
            return match[1].lower() + re.sub("[a-z]", "", match[2])
        for likeness, wanted in enumerate(_alike(text)):
            found = sorted(name for name in self.own if _alike(name)[likeness] == wanted)
            if len(found) > 1:
                ways = " or ".join(found[:2])
                raise CheckError(f"{text} can be read in two ways, {ways}", remedy="write the name out")
            if found:
                return found[0]
        return text

    def _variable(self, stem: str, label: str) -> str:
        """The variable of the joint with a label, printed as theta, d or q; empty where there is none."""
        for joint in self.robot.joints:
            if joint_label(joint.variable) != label:
                continue
            if stem == "q" or (stem == "theta") is joint.is_revolute:
                return joint.variable
            if stem == "theta":
                raise CheckError(
                    f"theta_{label}: joint {label} is prismatic", remedy=f"its variable is d_{label} or q_{label}"
                )
        return ""


def _alike(name: str) -> tuple[str, str, str]:
    """What names share that differ in underscores; in the place of the digits too; and in case too."""
    joined = name.replace("_", "")
    digits_last = "".join(sorted(joined, key=str.isdigit))
    return joined, digits_last, digits_last.casefold()

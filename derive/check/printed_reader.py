"""Printed formulas from texts: one with an unknown name is kept as such, what is no formula is refused."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from derive.check.printed import Printed
from derive.errors import CheckError, UnknownNameError
from derive.robot.document import Scalar
from derive.robot.expression import ZERO, Expression, Name
from derive.robot.notation import read_formula
from derive.robot.robot import Robot

Refusal = TypeVar("Refusal", bound=CheckError)

_WORD = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """Further names of some formulas, beside the robot's own.

    Attributes:
        names: What they stand for; those of `unknown` stand for themselves.
        unknown: Why nothing can be said about a formula with such a name: its definition has an unknown name.
    """

    names: Mapping[str, Expression] = field(default_factory=dict)
    unknown: Mapping[str, UnknownNameError] = field(default_factory=dict)

    def defining(self, name: str, definition: Printed) -> Vocabulary:
        """With one name more."""
        if definition.unknown is None:
            return Vocabulary({**self.names, name: definition.formula}, self.unknown)
        return Vocabulary({**self.names, name: Name(name)}, {**self.unknown, name: definition.unknown})


NO_NAMES = Vocabulary()


def read_printed(
    text: Scalar, robot: Robot, further: Vocabulary = NO_NAMES, place: tuple[int, int] = (1, 1)
) -> Printed:
    """A printed formula; one with a name that the robot does not know says so and has the formula zero.

    Args:
        text: The formula in the file.
        robot: Whose formula it is.
        further: Names beside the robot's own.
        place: Row and column of the entry, from 1.

    Raises:
        CheckError: The text is no formula.
    """
    try:
        formula = read_formula(text.text, robot, text.inner, further.names)
    except UnknownNameError as error:
        return Printed(*place, text.text, ZERO, text.inner, _placed(error, text))
    except CheckError as error:
        raise _placed(error, text) from None
    for word in _WORD.findall(text.text) if further.unknown else ():
        if word in further.unknown:
            return Printed(*place, text.text, ZERO, text.inner, further.unknown[word])
    return Printed(*place, text.text, formula, text.inner)


def _placed(error: Refusal, text: Scalar) -> Refusal:
    """Columns inside a folded or escaped text are not those of the file; there the error is at its beginning."""
    if text.verbatim:
        return error
    return type(error)(error.found, allowed=error.allowed, remedy=error.remedy, location=text.location)

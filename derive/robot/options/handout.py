"""What a handout shows and how its symbols are written: the keys ``handout`` and ``figure`` of a robot file."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any

from derive.errors import QuantityError, listed, near_miss, quoted
from derive.robot.expression import Expression

PARTS = (
    *("figure", "table", "convention", "parameters", "transforms", "closure", "conversion"),
    *("kinematics", "orientation", "jacobian", "singularities", "inverse"),
    *("link-jacobians", "energies", "inertia", "christoffel", "coriolis", "skew", "gravity", "motion", "newton-euler"),
    "example",
)
"""Parts of a handout, in their order; title and footer are always there."""

USUAL_PARTS = tuple(part for part in PARTS if part != "conversion")
"""What a handout shows unless parts are named: the table of the other convention is asked for."""

MOST_PAGES = 9999  # largest number of pages that can be asked for


class Derivation(StrEnum):
    """Whether the handout shows how a result is found."""

    RESULT = "result"
    STEPS = "steps"


class AngleLetter(StrEnum):
    """How the variable of a revolute joint is written."""

    NAME = "name"
    THETA = "theta"
    VARTHETA = "vartheta"
    Q = "q"


class SliderLetter(StrEnum):
    """How the variable of a prismatic joint is written."""

    NAME = "name"
    D = "d"
    Q = "q"


class Functions(StrEnum):
    r"""Whether sine and cosine are written short, c_{12}, or in full, \cos(q_1 + q_2)."""

    SHORT = "short"
    FULL = "full"


class FrameIndices(StrEnum):
    """Where the frames of a transform are written: A_1^0, or {}^0A_1."""

    RIGHT = "right"
    LEFT = "left"


class InertiaLetter(StrEnum):
    """Letter of the inertia matrix."""

    B = "B"
    M = "M"
    D = "D"


class PoseEntries(StrEnum):
    r"""How the rotation of a given pose is written: r_{13}, or the columns n, s, a by their components, a_x."""

    ENTRIES = "entries"
    COLUMNS = "columns"


@dataclass(frozen=True, slots=True)
class NotationOptions:
    """How symbols are written."""

    angle: AngleLetter = AngleLetter.NAME  # variables of revolute joints; ``name`` as in the robot file
    prismatic: SliderLetter = SliderLetter.NAME  # variables of prismatic joints
    functions: Functions = Functions.SHORT  # sines and cosines
    frames: FrameIndices = FrameIndices.RIGHT  # frames of a transform
    inertia: InertiaLetter = InertiaLetter.B  # the inertia matrix
    pose: PoseEntries = PoseEntries.ENTRIES  # the rotation of the pose that the inverse kinematics is given


@dataclass(frozen=True, slots=True)
class HandoutOptions:
    """What a handout shows."""

    # Which parts, a subset of `PARTS`, by default `USUAL_PARTS`; printed in their order there.
    parts: tuple[str, ...] = USUAL_PARTS
    derivation: Derivation = Derivation.RESULT  # results only, or the steps to them
    language: str = "en"  # code of a language that has a message catalogue
    notation: NotationOptions = field(default_factory=NotationOptions)  # how symbols are written
    pages: int = 20  # most pages of the printed sheet; 0 for any number


@dataclass(frozen=True, slots=True)
class FigureOptions:
    """The configuration that is drawn and computed."""

    # Value of every joint variable [rad or m]; None for none but the zero configuration.
    q: tuple[Expression, ...] | None = None
    # Numbers for symbols that have none [SI units, rad], for the drawing and the numeric example only.
    values: tuple[tuple[str, Expression], ...] = ()


def chosen_parts(names: Iterable[str]) -> tuple[str, ...]:
    """Parts of a handout by name."""
    words = list(names)
    chosen = [word.strip().replace("_", "-") for word in words if word.strip()]
    allowed = f"allowed: {listed(PARTS)}"
    for name in chosen:
        if name not in PARTS:
            raise QuantityError(f"unknown part {quoted(name)}", allowed=allowed, remedy=near_miss(name, PARTS))
    if not chosen:
        raise QuantityError(f"no part in {quoted(','.join(words))}", allowed=allowed)
    return tuple(part for part in PARTS if part in chosen)


def chosen_pages(text: str) -> int:
    """A number of pages that somebody wrote."""
    if not (text.isascii() and text.isdigit() and len(text) <= len(str(MOST_PAGES))):
        allowed = f"a whole number such as 20, at most {MOST_PAGES}, 0 for any number"
        raise QuantityError(f"{quoted(text)} is not a number of pages", allowed=f"allowed: {allowed}")
    return int(text)


def chosen_notation(choices: Mapping[str, str], start: NotationOptions) -> NotationOptions:
    """A notation by the names of its choices."""
    values: dict[str, Any] = {field.name: getattr(start, field.name) for field in fields(start)}
    for name, value in choices.items():
        if name not in values:
            found, allowed = f"unknown notation {quoted(name)}", list(values)
            raise QuantityError(found, allowed=f"allowed: {listed(allowed)}", remedy=near_miss(name, allowed))
        allowed = [member.value for member in type(values[name])]
        if value not in allowed:
            found = f"unknown value of {name} {quoted(value)}"
            raise QuantityError(found, allowed=f"allowed: {listed(allowed)}", remedy=near_miss(value, allowed))
        values[name] = type(values[name])(value)
    return NotationOptions(**values)

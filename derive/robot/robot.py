"""The robot as everything else sees it: frozen, validated, exact, in SI units and radians."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from html import escape
from pathlib import Path

from derive.robot.description import Convention, Description, Joint
from derive.robot.expression import ZERO, Expression
from derive.robot.load import description_from_bytes, load_description
from derive.robot.printer import to_text


@dataclass(frozen=True, slots=True)
class Robot(Description):
    """A serial arm: the DH table, the frames around it and, if given, its dynamics.

    Its attributes are those of `Description`; `load` and `from_text` make it.
    """

    def _repr_html_(self) -> str:
        """The DH table, for notebooks."""
        return html_table(self)

    @classmethod
    def load(cls, path_or_name: str | Path) -> Robot:
        """Load a robot file, or a robot of the catalogue by name.

        Args:
            path_or_name: Path of a YAML file, or a name that ``derive list`` shows.

        Returns:
            The validated robot.

        Raises:
            RobotFileError: The file cannot be read or does not describe a robot.
            UnknownRobotError: Neither a file nor a catalogue name.
        """
        return cls._of(load_description(path_or_name))

    @classmethod
    def from_text(cls, text: str, source: str = "<text>") -> Robot:
        """Load a robot from YAML text.

        Args:
            text: Contents of a robot file.
            source: Name to use in messages.

        Returns:
            The validated robot.

        Raises:
            RobotFileError: The text does not describe a robot.
        """
        return cls.from_bytes(text.encode("utf-8", "surrogatepass"), source)

    @classmethod
    def from_bytes(cls, data: bytes, source: str) -> Robot:
        """Load a robot from the bytes of a file.

        Args:
            data: Contents of a robot file, UTF-8.
            source: Name to use in messages.

        Returns:
            The validated robot.

        Raises:
            RobotFileError: The bytes do not describe a robot.
        """
        return cls._of(description_from_bytes(data, source))

    @classmethod
    def _of(cls, description: Description) -> Robot:
        return cls(**{field.name: getattr(description, field.name) for field in fields(description)})


def html_table(robot: Robot) -> str:
    """The DH table with joint types and limits, in radians and metres; every text of the user's escaped."""
    standard = robot.convention is Convention.STANDARD
    names = ("&theta;", "d", "a", "&alpha;")
    if not standard:
        names = ("&alpha;<sub>i&minus;1</sub>", "a<sub>i&minus;1</sub>", "&theta;", "d")
    head = "".join(f"<th>{name}</th>" for name in ("i", "joint", *names, "limits"))
    body = "".join(_row(i, joint, standard) for i, joint in enumerate(robot.joints, 1))
    caption = f"{escape(robot.title)} ({robot.convention.value} Denavit-Hartenberg convention)"
    return f"<table><caption>{caption}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _row(index: int, joint: Joint, standard: bool) -> str:
    theta = _moving(joint, joint.theta) if joint.is_revolute else to_text(joint.theta)
    d = to_text(joint.d) if joint.is_revolute else _moving(joint, joint.d)
    a, alpha = to_text(joint.a), to_text(joint.alpha)
    limits = "" if joint.limits is None else " to ".join(map(to_text, joint.limits))
    cells = (theta, d, a, alpha) if standard else (alpha, a, theta, d)
    return "<tr>" + "".join(_cells(str(index), joint.type.value, *cells, limits)) + "</tr>"


def _cells(*texts: str) -> Iterator[str]:
    return (f"<td>{escape(text)}</td>" for text in texts)


def _moving(joint: Joint, constant: Expression) -> str:
    """``sign*q + constant``."""
    variable = joint.variable if joint.sign > 0 else f"-{joint.variable}"
    if constant == ZERO:
        return variable
    rest = to_text(constant)
    return f"{variable} - {rest[1:]}" if rest.startswith("-") else f"{variable} + {rest}"

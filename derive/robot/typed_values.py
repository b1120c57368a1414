"""The units of a robot file, for values that a user types beside it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from derive.errors import DeriveError, ExpressionError, Location, quoted
from derive.robot.catalogue import catalogue_names, catalogue_text
from derive.robot.cells import MixedUnitsError, Units, angle_in_radians, length_in_metres
from derive.robot.document import Document, read_document
from derive.robot.expression import Expression, names
from derive.robot.load import file_bytes
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot


def file_units(path_or_name: str) -> Units:
    """The units of a robot file, or of a robot of the catalogue.

    Raises:
        RobotFileError: The file cannot be read.
    """
    known = path_or_name in catalogue_names()
    data = catalogue_text(path_or_name).encode() if known else file_bytes(Path(path_or_name))
    document = read_document(data, path_or_name)
    return Units(degrees=_unit(document, "angle") == "deg", millimetres=_unit(document, "length") == "mm")


def _unit(document: Document, kind: str) -> str:
    scalar = document.scalar(("units", kind))
    return scalar.text if scalar else ""


def joint_values(robot: Robot, units: Units, texts: Sequence[str]) -> tuple[Expression, ...]:
    """Values of all joint variables [rad or m] from cells in the units of a file.

    Args:
        robot: The robot.
        units: The units of its file.
        texts: One cell per joint, such as ``pi/2`` or ``90``.

    Raises:
        DeriveError: Not one cell per joint, a cell outside the grammar, or one with a name in it.
    """
    if len(texts) != robot.n:
        variables = ", ".join(joint.variable for joint in robot.joints)
        raise DeriveError(
            f"{len(texts)} joint values for {robot.n} joints", allowed=f"allowed: one value for each of {variables}"
        )
    pairs = zip(robot.joints, texts, strict=True)
    return tuple(_value(joint.variable, text.strip(), units, joint.is_revolute) for joint, text in pairs)


def _value(variable: str, text: str, units: Units, angular: bool) -> Expression:
    allowed = "allowed: a number, or an expression in numbers and pi"
    try:
        expression = parse_expression(text, Location("-q"))
        if next(iter(names(expression)), None) is not None:
            raise DeriveError(f"value {quoted(text)} of {variable} holds a name", allowed=allowed)
        return angle_in_radians(expression, units) if angular else length_in_metres(expression, units)
    except ExpressionError as error:
        raise DeriveError(f"value {quoted(text)} of {variable}: {error.found}", allowed=allowed) from None
    except MixedUnitsError:
        raise DeriveError(
            f"pi in the value {quoted(text)} of {variable}, but angles of this robot file are in degrees",
            remedy="write 90 for pi/2",
        ) from None

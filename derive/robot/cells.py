"""Reads cells of a document as exact expressions in SI units and radians."""

from __future__ import annotations

from dataclasses import dataclass, field

from derive.errors import ExpressionError, Location
from derive.robot.document import Document, Path, Scalar
from derive.robot.expression import ZERO, Expression, names
from derive.robot.parser import parse_expression
from derive.robot.units import MixedUnitsError, Units, angle_in_radians, length_in_metres, plain_number
from derive.robot.wording import path_text


@dataclass(slots=True)
class Cells:
    """The cells of one file.

    Attributes:
        document: The file.
        units: Units of plain numbers.
        first_use: Every name that was read, with the place where it appears first; filled while reading.
    """

    document: Document
    units: Units
    first_use: dict[str, Location] = field(default_factory=dict)

    def angle(self, path: Path, default: Expression = ZERO) -> Expression:
        """An angle [rad]."""
        return self.to_radians(path, self.raw(path, default))

    def length(self, path: Path, default: Expression = ZERO) -> Expression:
        """A length [m]."""
        return self.to_metres(self.raw(path, default))

    def plain(self, path: Path, default: Expression = ZERO) -> Expression:
        """A quantity that is always in SI units, such as a mass."""
        return plain_number(self.raw(path, default), self.units)

    def to_radians(self, path: Path, expression: Expression) -> Expression:
        """The expression of an angle cell in radians.

        Raises:
            RobotFileError: pi in a file whose angles are degrees.
        """
        try:
            return angle_in_radians(expression, self.units)
        except MixedUnitsError:
            raise self.document.error(
                path,
                "pi in an angle cell, but this file's angles are in degrees",
                "allowed: plain numbers in degrees, names in radians",
                "write 90 for pi/2, or remove angle: deg",
            ) from None

    def to_metres(self, expression: Expression) -> Expression:
        """The expression of a length cell in metres."""
        return length_in_metres(expression, self.units)

    def raw(self, path: Path, default: Expression = ZERO) -> Expression:
        """The expression as written, before units.

        Raises:
            ExpressionError: Outside the grammar; the message names the cell.
        """
        scalar = self.document.scalar(path)
        if scalar is None:
            return default
        expression = self._parsed(path, scalar)
        for name in names(expression):
            self.first_use.setdefault(name, scalar.location)
        return expression

    def _parsed(self, path: Path, scalar: Scalar) -> Expression:
        try:
            return parse_expression(scalar.text, scalar.inner)
        except ExpressionError as error:
            raise ExpressionError(
                f"{path_text(path)}: {error.found}",
                allowed=error.allowed,
                remedy=error.remedy,
                location=error.location if scalar.verbatim else scalar.location,
            ) from None

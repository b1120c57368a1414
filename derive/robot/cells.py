"""Reads cells of a document as exact expressions in SI units and radians.

Which texts may be a symbol.

Degrees and millimetres to radians and metres, exactly.

A *plain number* is an additive term of a cell in which no name occurs: in ``q1 + 90`` it is 90, in ``2*a1 - 20`` it is
20. A number that multiplies a name is a factor without a unit, and names themselves are always in SI units and radians.
Arguments of sin, cos and tan are angles too, in every cell; where pi occurs in an argument, it is in radians already.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from fractions import Fraction

from derive.errors import ExpressionError, Location, path_text, quoted
from derive.robot.document import Document, KeyPath, YamlScalar
from derive.robot.expression import (
    ZERO,
    Call,
    Expression,
    Pi,
    Power,
    Product,
    Sum,
    add,
    contains_pi,
    is_constant,
    linear_terms,
    multiply,
    names,
    number,
    power,
)
from derive.robot.limits import FILE_LIMITS
from derive.robot.parser import NOT_SYMBOLS, RESERVED_NAMES, parse_expression

_DEGREE = multiply(number(Fraction(1, 180)), Pi())
_MILLIMETRE = number(Fraction(1, 1000))
_ANGULAR = frozenset({"sin", "cos", "tan"})


class MixedUnitsError(ValueError):
    """pi stands in an angle cell whose plain numbers are degrees."""


@dataclass(frozen=True, slots=True)
class Units:
    """Units of plain numbers in a file."""

    degrees: bool = False
    millimetres: bool = False


def angle_in_radians(expression: Expression, units: Units) -> Expression:
    """An angle cell in radians.

    Raises:
        MixedUnitsError: pi outside the arguments of functions while angles are degrees.
    """
    if not units.degrees:
        return expression
    if contains_pi(expression):
        raise MixedUnitsError
    return _scaled(_arguments_in_radians(expression), _DEGREE)


def length_in_metres(expression: Expression, units: Units) -> Expression:
    """A length cell in metres."""
    converted = plain_number(expression, units)
    return _scaled(converted, _MILLIMETRE) if units.millimetres else converted


def plain_number(expression: Expression, units: Units) -> Expression:
    """A cell that is neither angle nor length: only arguments of functions change."""
    return _arguments_in_radians(expression) if units.degrees else expression


def _scaled(expression: Expression, unit: Expression) -> Expression:
    """The expression with every plain number multiplied by ``unit``."""
    pairs = linear_terms(expression)
    if not any(is_constant(term) for _, term in pairs):
        return expression
    return add(*(multiply(number(c), term, unit if is_constant(term) else number(1)) for c, term in pairs))


def _arguments_in_radians(expression: Expression) -> Expression:
    match expression:
        case Call(function, arguments):
            converted = tuple(_arguments_in_radians(argument) for argument in arguments)
            if function in _ANGULAR:
                converted = tuple(a if contains_pi(a) else _scaled(a, _DEGREE) for a in converted)
            return Call(function, converted)
        case Sum(parts):
            return add(*(_arguments_in_radians(part) for part in parts))
        case Product(parts):
            return multiply(*(_arguments_in_radians(part) for part in parts))
        case Power(base, exponent):
            return power(_arguments_in_radians(base), exponent)
        case _:
            return expression


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

    def angle(self, path: KeyPath, default: Expression = ZERO) -> Expression:
        """An angle [rad]."""
        return self.to_radians(path, self.raw(path, default))

    def length(self, path: KeyPath, default: Expression = ZERO) -> Expression:
        """A length [m]."""
        return self.to_metres(self.raw(path, default))

    def plain(self, path: KeyPath, default: Expression = ZERO) -> Expression:
        """A quantity that is always in SI units, such as a mass."""
        return plain_number(self.raw(path, default), self.units)

    def to_radians(self, path: KeyPath, expression: Expression) -> Expression:
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

    def raw(self, path: KeyPath, default: Expression = ZERO) -> Expression:
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

    def _parsed(self, path: KeyPath, scalar: YamlScalar) -> Expression:
        try:
            return parse_expression(scalar.text, scalar.inner)
        except ExpressionError as error:
            raise ExpressionError(
                f"{path_text(path)}: {error.found}",
                allowed=error.allowed,
                remedy=error.remedy,
                location=error.location if scalar.verbatim else scalar.location,
            ) from None


_SYMBOL = re.compile(rf"[A-Za-z][A-Za-z0-9_]{{0,{FILE_LIMITS.name_length - 1}}}")


def check_symbol(document: Document, path: KeyPath, name: str) -> None:
    """Refuse a name that is not ``[A-Za-z][A-Za-z0-9_]*``, too long, or means something else.

    Raises:
        RobotFileError: At the place of the name.
    """
    if name in RESERVED_NAMES or name.casefold() in NOT_SYMBOLS:
        raise document.error(path, f"'{name}' cannot be a symbol", "it has a meaning of its own", "use another name")
    if _SYMBOL.fullmatch(name) is None:
        raise document.error(
            path,
            f"{quoted(name)} is not a name",
            f"allowed: a letter A-Z or a-z, then letters, digits and _, at most {FILE_LIMITS.name_length} characters",
        )

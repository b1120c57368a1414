"""Reads cells of a document as exact expressions in SI units and radians, and which texts may be a symbol.

A *plain number* is an additive term of a cell in which no name occurs: in ``q1 + 90`` it is 90, in ``2*a1 - 20`` it is
20. A number that multiplies a name is a factor without a unit, and names themselves are always in SI units and radians.
Arguments of sin, cos and tan are angles too, in every cell; where pi occurs in an argument, it is in radians already.
"""

import re
import unicodedata
import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from math import pi

from derive import errors
from derive.errors import DeriveError, ExpressionError, Location, RobotFileError, listed, near_miss, path_text, quoted
from derive.robot import expression as tree
from derive.robot.description import Description, FileUnits, Joint, Variable
from derive.robot.evaluate import evaluate
from derive.robot.expression import ZERO, Call, Expression, Pi, contains_pi, is_constant, names
from derive.robot.names import acceleration_name, robot_symbols, velocity_name
from derive.robot.parser import NOT_SYMBOLS, RESERVED_NAMES, parse_expression
from derive.robot.reading.document import Document, KeyPath
from derive.robot.reading.hints import cell_hint
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.units import Unit, symbol_unit

_DEGREE = tree.multiply(tree.number(Fraction(1, 180)), Pi())
_MILLIMETRE = tree.number(Fraction(1, 1000))
_SYMBOL = re.compile(rf"[A-Za-z][A-Za-z0-9_]{{0,{FILE_LIMITS.name_length - 1}}}")


class MixedUnitsError(ValueError):
    """pi stands in an angle cell whose plain numbers are degrees."""


def angle_in_radians(expression: Expression, units: FileUnits, unitless: frozenset[str] = frozenset()) -> Expression:
    """An angle cell in radians."""
    if not units.degrees:
        return expression
    if contains_pi(expression):
        raise MixedUnitsError
    return _scaled(plain_number(expression, units), _DEGREE, unitless)


def length_in_metres(expression: Expression, units: FileUnits, unitless: frozenset[str] = frozenset()) -> Expression:
    """A length cell in metres."""
    converted = plain_number(expression, units)
    return _scaled(converted, _MILLIMETRE, unitless) if units.millimetres else converted


def plain_number(expression: Expression, units: FileUnits) -> Expression:
    """A cell that is neither angle nor length: only arguments of sin, cos and tan change."""
    if not units.degrees:
        return expression
    converted = tree.rebuilt(expression, lambda part: plain_number(part, units))
    if isinstance(converted, Call) and converted.function in ("sin", "cos", "tan"):
        angles = (a if contains_pi(a) else _scaled(a, _DEGREE) for a in converted.arguments)
        return Call(converted.function, tuple(angles))
    return converted


def _scaled(expression: Expression, unit: Expression, unitless: frozenset[str] = frozenset()) -> Expression:
    """The expression with every plain number multiplied by ``unit``."""
    pairs = [(c, term, unitless.issuperset(names(term))) for c, term in tree.linear_terms(expression)]
    if not any(is_plain for _, _, is_plain in pairs):
        return expression
    return tree.add(
        *(tree.multiply(tree.number(c), term, unit if is_plain else tree.number(1)) for c, term, is_plain in pairs)
    )


def joint_values(robot: Description, q: Sequence[float | str]) -> tuple[Expression, ...]:
    """The configuration [rad or m] by numbers or cells that a user types beside the file, in the units of the file."""
    texts = [value if isinstance(value, str) else str(float(value)) for value in q]
    if len(texts) != robot.dof:
        allowed = f"allowed: one value for each of {', '.join(joint.variable for joint in robot.variables)}"
        raise DeriveError(f"{robot.dof} joint values are needed, {len(texts)} given", allowed=allowed)
    pairs = zip(robot.variables, texts, strict=True)
    return tuple(joint_value(robot, joint, typed, joint.variable) for joint, typed in pairs)


def joint_value(robot: Description, joint: Joint | Variable | None, typed: str, name: str) -> Expression:
    """A value that a user types: of what a joint moves, in the units of the file; of a symbol as in the file."""
    value, allowed = f"value {quoted(typed.strip())} of {name}", "allowed: a number, or an expression in numbers and pi"
    try:
        expression = parse_expression(typed.strip(), Location("--at"))
        if not is_constant(expression):
            raise DeriveError(f"{value} holds a name", allowed=allowed)
        if joint is None:
            return symbol_number(robot, name, expression)
        if joint.is_revolute and name == joint.variable and not (robot.units.degrees or contains_pi(expression)):
            with suppress(ArithmeticError):
                if abs(turned := evaluate(expression, {})) > 4 * pi:
                    angle = tree.multiple_of_pi(Fraction(turned).limit_denominator(1000) / 180)
                    found = f"{value} is more than two turns in radians; if degrees are meant write {angle}"
                    warnings.warn(found, errors.RobotFileWarning, stacklevel=3)
        return (angle_in_radians if joint.is_revolute else length_in_metres)(expression, robot.units)
    except ExpressionError as error:
        raise DeriveError(f"{value}: {error.found}", allowed=allowed, remedy=cell_hint(typed)) from None
    except MixedUnitsError:
        found = f"pi in the {value}, but angles of this robot file are in degrees"
        raise DeriveError(found, remedy="write 90 for pi/2") from None


def typed_point(
    robot: Description, at: Sequence[str], rates: str | None = None, accelerations: str | None = None
) -> dict[str, Expression]:
    """The state that a user types beside the file, in the units of the file; symbols as under ``parameters:``."""
    variables = [joint.variable for joint in robot.variables]
    orders = [variables, list(map(velocity_name, variables)), list(map(acceleration_name, variables))]
    joints = {name: joint for names in orders for name, joint in zip(names, robot.variables, strict=True)}
    symbols = robot_symbols(robot)
    point: dict[str, Expression] = {}
    for option, order, typed in zip(
        ("--at", "--rates", "--accelerations"), orders, (",".join(at), rates or "", accelerations or ""), strict=True
    ):
        cells = [cell for cell in re.split("[,;]", typed.strip().strip("[]")) if cell.strip()]
        if len(cells) == 1 and len(typed.split()) == robot.dof:  # values with spaces between them
            cells = typed.strip().strip("[]").split()
        places = [cell for cell in cells if "=" not in cell]
        if places and len(places) != robot.dof:
            found = f"{len(places)} values in {option} for {robot.dof} joints"
            allowed = f"allowed: one for each of {listed(order)}, or {order[0]}=0.5 for one of them"
            raise DeriveError(found, allowed=allowed)
        pairs = [*zip(order, places, strict=bool(places)), *(cell.split("=", 1) for cell in cells if "=" in cell)]
        for name, text in ((name.strip(), text) for name, text in pairs):
            if name not in joints and name not in symbols:
                allowed = f"allowed: {listed((*joints, *symbols))}"
                raise DeriveError(f"no {quoted(name)} in {robot.name}", allowed=allowed, remedy=near_miss(name, joints))
            if name in point:
                raise DeriveError(f"{name} is given twice", remedy="leave one of them out")
            point[name] = joint_value(robot, joints.get(name), text, name)
    return dict(robot.parameters) | point


def symbol_number(robot: Description, name: str, value: Expression) -> Expression:
    """The number of a symbol that a user types, in a robot file with ``parameters: file`` in the units of its cells."""
    unit = symbol_unit(robot, name) if robot.units.parameters else Unit.SI
    read = {Unit.SI: plain_number, Unit.LENGTH: length_in_metres, Unit.ANGLE: angle_in_radians}[unit]
    return read(value, robot.units)


@dataclass(slots=True)
class Cells:
    """The cells of one file."""

    document: Document  # the file
    units: FileUnits  # units of plain numbers
    # Every name that was read, with the place where it appears first; filled while reading.
    first_use: dict[str, Location] = field(default_factory=dict)
    unitless: frozenset[str] = frozenset()  # names that have no unit of their own

    def angle(self, path: KeyPath, default: Expression = ZERO) -> Expression:
        """An angle."""
        return self.to_radians(path, self.raw(path, default))

    def length(self, path: KeyPath, default: Expression = ZERO) -> Expression:
        """A length."""
        return length_in_metres(self.raw(path, default), self.units, self.unitless)

    def plain(self, path: KeyPath, default: Expression = ZERO) -> Expression:
        """A quantity that is always in SI units, such as a mass."""
        return plain_number(self.raw(path, default), self.units)

    def constant(self, path: KeyPath, value: Expression, found: str, allowed: str) -> Expression:
        """A cell that is a number, without any name."""
        if not is_constant(value):
            raise self.document.error(path, f"name '{next(names(value))}' in {found}", allowed, "write its number")
        return value

    def to_radians(self, path: KeyPath, expression: Expression) -> Expression:
        """The expression of an angle cell in radians."""
        try:
            return angle_in_radians(expression, self.units, self.unitless)
        except MixedUnitsError:
            raise self._mixed_units(path) from None

    def symbol(self, path: KeyPath, robot: Description, name: str) -> Expression:
        """The number of a symbol, see `symbol_number`."""
        try:
            return symbol_number(robot, name, self.raw(path))
        except RobotFileError as error:
            raise self.document.error(path, error.found, error.allowed, error.remedy) from None
        except MixedUnitsError:
            raise self._mixed_units(path) from None

    def _mixed_units(self, path: KeyPath) -> RobotFileError:
        found = "pi in an angle cell, but this file's angles are in degrees"
        allowed, remedy = "allowed: plain numbers in degrees, and names", "write 90 for pi/2, or remove angle: deg"
        return self.document.error(path, found, allowed, remedy)

    def raw(self, path: KeyPath, default: Expression = ZERO) -> Expression:
        """The expression as written, before units."""
        scalar = self.document.scalar(path)
        if scalar is None:
            return default
        try:
            expression = parse_expression(scalar.text, scalar.inner)
        except ExpressionError as error:
            found, remedy = f"{path_text(path)}: {error.found}", cell_hint(scalar.text) or error.remedy
            location = error.location if scalar.verbatim else scalar.location
            raise ExpressionError(found, allowed=error.allowed, remedy=remedy, location=location) from None
        for name in names(expression):
            self.first_use.setdefault(name, scalar.location)
        return expression


def inert_text(document: Document, path: KeyPath, breaks: str = "") -> str:
    """A free text of bounded length that no output takes for anything else; empty where there is none."""
    text = document.text(*path)
    if len(text) > FILE_LIMITS.title_length:
        allowed = f"allowed: at most {FILE_LIMITS.title_length}"
        raise document.error(path, f"{len(text)} characters", allowed, "shorten it")
    for character in text:
        if character not in breaks and unicodedata.category(character) in ("Cc", "Cs", "Zl", "Zp"):
            allowed = f"allowed: text{', line breaks and tabs' if breaks else ' on one line'}"
            raise document.error(path, f"control character U+{ord(character):04X}", allowed)
    return text


def check_symbol(document: Document, path: KeyPath, name: str) -> None:
    """Refuse a name that is not ``[A-Za-z][A-Za-z0-9_]*``, too long, or means something else."""
    if name in RESERVED_NAMES or name.casefold() in NOT_SYMBOLS:
        raise document.error(path, f"'{name}' cannot be a symbol", "it has a meaning of its own", "use another name")
    if _SYMBOL.fullmatch(name) is None:
        length = f"at most {FILE_LIMITS.name_length} characters"
        allowed = f"allowed: a letter A-Z or a-z, then letters, digits and _, {length}"
        raise document.error(path, f"{quoted(name)} is not a name", allowed)

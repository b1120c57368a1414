"""A robot file in the other convention, with comments that say how it was made and that lead back."""

import re
from dataclasses import dataclass, replace

from derive.errors import DeriveError, ExpressionError, Location, RobotFileError, near_miss, quoted
from derive.mechanics.convention import Conversion, Factor, convert
from derive.robot.description import Convention
from derive.robot.expression import ZERO, names
from derive.robot.load import is_robot_name
from derive.robot.names import robot_symbols
from derive.robot.parser import parse_expression
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.robot import Robot
from derive.robot.tree import require_chain
from derive.robot.writer import cell_text, robot_text

_MADE = "Converted by derive"
_BACK = re.compile(r"Back with a = (?P<a>.+) m, alpha = (?P<alpha>.+) rad in the (?P<row>first|last) row\.")


@dataclass(frozen=True, slots=True)
class Converted:
    """A robot in the other convention."""

    text: str  # its file
    robot: Robot  # what it says
    conversion: Conversion  # how it was made
    bodies: tuple[str, ...] = ()  # changes of the links where physically consistent bodies were asked for

    @property
    def notes(self) -> tuple[str, ...]:
        """What became of the links, and what the other convention says otherwise, as sentences."""
        return (*self.bodies, *self.conversion.notes)


def convention_named(text: str) -> Convention:
    """A convention by its name."""
    choices = [member.value for member in Convention]
    if text not in choices:
        allowed = "allowed: standard (distal), modified (Craig, Khalil)"
        raise DeriveError(f"unknown convention {quoted(text)}", allowed=allowed, remedy=near_miss(text, choices))
    return Convention(text)


def converted(robot: Robot, convention: Convention, name: str | None = None) -> Converted:
    """The same arm by the table of the other convention, under another name or the same."""
    require_chain(robot, "the table of the other convention")
    if robot.convention is convention:
        other = next(member for member in Convention if member is not convention)
        found = f"{robot.name} has a {convention.value} table already"
        raise DeriveError(found, remedy=f"write --convention {other.value}, or take the file as it is")
    if name is not None and not is_robot_name(name):
        allowed = f"allowed: a-z, 0-9 and -, not first, at most {FILE_LIMITS.name_length} characters"
        raise RobotFileError(f"{quoted(name)} is not a robot name", allowed=allowed)
    # The factor that a comment names, unless it is none of this robot's symbols: it leads back.
    end = "first" if robot.convention is Convention.STANDARD else "last"
    matches = (match for line in robot.comments if (match := _BACK.fullmatch(line)) and match["row"] == end)
    try:
        back = next(matches, None)
        cells = [parse_expression(back[key], Location("<comment>")) for key in ("a", "alpha")] if back else []
        is_own = set(robot_symbols(robot)).issuperset(symbol for cell in cells for symbol in names(cell))
        conversion = convert(robot, Factor(*cells) if cells and is_own else None)
    except (ExpressionError, ArithmeticError):  # the comment has been edited to what is no number
        conversion = convert(robot)
    result = conversion.result
    title = result.title if name is None or result.title != robot.name else name
    result = replace(result, name=name or result.name, title=title)
    leaving, row = conversion.leaving, "last" if robot.convention is Convention.STANDARD else "first"
    comments = [
        f"{_MADE} from the {robot.convention.value} table of {robot.name} (robot file {robot.digest[:16]}).",
        f"Back with a = {cell_text(leaving.a)} m, alpha = {cell_text(leaving.alpha)} rad in the {row} row.",
        *(f"{_MADE}: {note}" for note in conversion.notes),
        *(line for line in robot.comments if not line.startswith(_MADE) and _BACK.fullmatch(line) is None),
    ]
    text = robot_text(result, comments)
    made = Robot.from_text(text, f"{result.name}.yaml")
    return Converted(text, made, replace(conversion, result=made))


def moves(conversion: Conversion) -> list[str]:
    """Which factors have moved between the table and its ends, in words."""
    leaving, entering = conversion.leaving, conversion.entering
    ends = (("row 1", "base"), (f"row {conversion.source.n}", "tool"))
    (first, before), (last, behind) = ends if conversion.source.convention is Convention.STANDARD else ends[::-1]
    lines = [] if leaving.is_one else [f"{_factor_text(leaving)} of {last} is in the {behind} now"]
    return lines if entering.is_one else [*lines, f"{first} has {_factor_text(entering)} out of the {before}"]


def _factor_text(factor: Factor) -> str:
    cells = (("Trans(x, ", factor.a), ("Rot(x, ", factor.alpha))
    return " ".join(f"{name}{cell_text(cell)})" for name, cell in cells if cell != ZERO)

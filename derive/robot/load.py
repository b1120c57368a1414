"""From a path, a catalogue name or a text to a validated `Robot`."""

from __future__ import annotations

from pathlib import Path

from derive.errors import Location, RobotFileError, UnknownRobotError
from derive.robot.cells import Cells
from derive.robot.document import Document, Mapping
from derive.robot.expression import Expression, names
from derive.robot.frames import read_frame
from derive.robot.heading import read_name, read_title
from derive.robot.joints import read_joints
from derive.robot.limits import FILE_LIMITS
from derive.robot.links import read_gravity, read_links
from derive.robot.presentation import read_figure, read_handout
from derive.robot.robot import Convention, Robot
from derive.robot.source import read_document
from derive.robot.structure import check_structure
from derive.robot.style import Contraction, Style
from derive.robot.symbols import check_symbol
from derive.robot.units import Units
from derive.robot.validate import validate
from derive.robot.wording import near_miss, quoted


def load_robot(path_or_name: str | Path) -> Robot:
    """Load a robot file, or a robot of the catalogue.

    A text that is exactly a catalogue name means the catalogue; write ``./name`` for a file of that name.

    Args:
        path_or_name: Path of a YAML file, or a name that ``derive list`` shows.

    Raises:
        RobotFileError: The file cannot be read or does not describe a robot.
        ExpressionError: A cell is outside the grammar.
        UnknownRobotError: Neither a file nor a catalogue name.
    """
    from derive.robot.catalogue import catalogue_names, catalogue_text

    text = str(path_or_name)
    if text in catalogue_names():
        return robot_from_text(catalogue_text(text), text)
    path = Path(text)
    if "\0" in text or not _exists(path):
        raise UnknownRobotError(
            f"no file and no catalogue robot {quoted(text, 200)}",
            allowed="allowed: a path to a robot file, or a name from derive list",
            remedy=near_miss(path.stem, catalogue_names()),
        )
    return robot_from_bytes(file_bytes(path), text)


def robot_from_text(text: str, source: str = "<text>") -> Robot:
    """Load a robot from YAML text.

    Args:
        text: Contents of a robot file.
        source: Name for messages.

    Raises:
        RobotFileError: The text does not describe a robot.
        ExpressionError: A cell is outside the grammar.
    """
    return robot_from_bytes(text.encode("utf-8", "surrogatepass"), source)


def robot_from_bytes(data: bytes, source: str) -> Robot:
    """Load a robot from the bytes of a file.

    Raises:
        RobotFileError: The bytes do not describe a robot.
        ExpressionError: A cell is outside the grammar.
    """
    document = read_document(data, source if source.isprintable() else quoted(source, 200))
    check_structure(document)
    cells = Cells(document, _units(document))
    robot = _read(document, cells)
    validate(document, cells, robot)
    return robot


def _read(document: Document, cells: Cells) -> Robot:
    joints = read_joints(document, cells)
    base, tool = read_frame(document, cells, "base"), read_frame(document, cells, "tool")
    links = read_links(document, cells, len(joints))
    gravity = read_gravity(document, cells)
    name = read_name(document)
    parameters = _parameters(document)
    return Robot(
        name=name,
        title=read_title(document) or name,
        convention=Convention(_text(document, "convention")),
        joints=joints,
        base=base,
        tool=tool,
        gravity=gravity,
        links=links,
        parameters=parameters,
        runtime=_runtime(document),
        style=Style(_text(document, "style") or Style.COMPACT),
        contraction=Contraction(_text(document, "contraction") or Contraction.ALIGNED),
        handout=read_handout(document),
        figure=read_figure(document, cells, joints, parameters),
        digest=document.digest,
        source=document.source,
    )


def _text(document: Document, *path: str) -> str:
    scalar = document.scalar(path)
    return scalar.text if scalar else ""


def _units(document: Document) -> Units:
    return Units(
        degrees=_text(document, "units", "angle") == "deg",
        millimetres=_text(document, "units", "length") == "mm",
    )


def _parameters(document: Document) -> tuple[tuple[str, Expression], ...]:
    node = document.find(("parameters",))
    if not isinstance(node, Mapping):
        return ()
    si_cells = Cells(document, Units())
    return tuple((name, _constant(document, si_cells, name)) for name in node.entries)


def _constant(document: Document, cells: Cells, name: str) -> Expression:
    path = ("parameters", name)
    if document.find(path) is not None:
        check_symbol(document, path, name)
    value = cells.raw(path)
    if others := list(names(value)):
        raise document.error(
            path,
            f"name '{others[0]}' in the number of a parameter",
            "allowed: numbers and constant expressions such as sqrt(2)/2 or pi/6",
            "write its number",
        )
    return value


def _runtime(document: Document) -> tuple[str, ...]:
    count = document.length(("runtime",))
    found = tuple((document.scalar(("runtime", index)), index) for index in range(count))
    for scalar, index in found:
        check_symbol(document, ("runtime", index), scalar.text if scalar else "")
    return tuple(scalar.text for scalar, _ in found if scalar)


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def file_bytes(path: Path) -> bytes:
    """Contents of a regular file, at most one byte more than is allowed.

    Raises:
        RobotFileError: Not a file, or it cannot be read.
    """
    shown = str(path) if str(path).isprintable() else quoted(str(path), 200)
    place = Location(shown)
    if not path.is_file():
        raise RobotFileError("not a file", remedy="give the path of a YAML file", location=place)
    try:
        with path.open("rb") as file:
            return file.read(FILE_LIMITS.size + 1)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise RobotFileError(f"cannot be read: {reason}", remedy="check its permissions", location=place) from None
